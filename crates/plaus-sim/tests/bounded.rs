//! Runs that cannot go on: they end, within bounds, and say why.

use glam::DVec3;
use plaus_sim::rigid::{BodySpec, RigidWorld, RigidWorldDesc, Start, StaticShape};
use plaus_sim::scenery::Plane;
use plaus_sim::shape::{Cuboid, Shape};
use plaus_sim::{Accuracy, Law, Laws, Material, Outcome, Scratch};

const KIND: Material = Material(0);

fn world(shapes: Vec<Shape>, restitution: f64, accuracy: Accuracy) -> RigidWorld {
    let laws = Laws::uniform(Law::new(0.3, restitution)).unwrap();
    RigidWorld::new(RigidWorldDesc {
        bodies: shapes.into_iter().map(|shape| BodySpec::solid(shape, 1000.0, KIND)).collect(),
        parts: vec![StaticShape::Plane(Plane::new(DVec3::ZERO, DVec3::Z, KIND).unwrap())],
        laws,
        gravity: DVec3::new(0.0, 0.0, -9.81),
        accuracy,
        skin: 1.0,
        sink: f64::NEG_INFINITY,
        duration: 2.0,
    })
    .unwrap()
}

/// A heap gives all its bodies a new motion at each event: these are bounded too, so that time and memory are bounded
/// by the number of bodies.
#[test]
fn a_heap_is_bounded_by_the_motions_of_its_bodies() {
    let cubes: Vec<Shape> = (0..24).map(|_| Shape::Cuboid(Cuboid::new(DVec3::splat(0.1), 0.0).unwrap())).collect();
    let place = |k: usize| DVec3::new(0.06 * (k % 3) as f64, 0.05 * (k % 2) as f64, 0.06 + 0.11 * k as f64);
    let starts: Vec<Start> = (0..cubes.len()).map(|k| Start::at_rest(place(k))).collect();
    let (events, bodies) = (40, cubes.len() as u64);
    let world = world(cubes, 0.1, Accuracy { events, ..Accuracy::default() });
    let mut state = world.state(&starts).unwrap();
    let outcome = world.run(&mut state, &mut Scratch::default(), f64::INFINITY, &mut ()).unwrap();
    let counts = state.counts();
    assert_eq!(outcome, Outcome::OutOfEvents, "{counts:?}");
    // One event gives each body one motion at most, and an instant, at whose end the budget is looked at, each body one
    // event.
    assert!(counts.events < events * bodies + bodies && counts.motions <= 16 * events * bodies + bodies, "{counts:?}");
}

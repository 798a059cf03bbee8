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
    // One event gives each body one motion at most.
    assert!(counts.events <= events * bodies && counts.motions <= 16 * events * bodies + bodies, "{counts:?}");
}

/// A run has no more events than it may have, even where many are due at one instant: a ball bounces a few times, then
/// all others land at once.
#[test]
fn an_instant_does_not_exceed_the_budget() {
    for events in 1..=5 {
        let accuracy = Accuracy { events, ..Accuracy::default() };
        let world = world(vec![Shape::Ball(0.05); 24], 0.9, accuracy);
        let place = |k: usize| DVec3::new(0.2 * k as f64, 0.0, if k == 0 { 0.06 } else { 1.05 });
        let starts: Vec<Start> = (0..24).map(|k| Start::at_rest(place(k))).collect();
        let mut state = world.state(&starts).unwrap();
        let outcome = world.run(&mut state, &mut Scratch::default(), f64::INFINITY, &mut ()).unwrap();
        let counts = state.counts();
        assert!(counts.events <= events * 24, "{counts:?}");
        assert!(outcome != Outcome::OutOfEvents || counts.events == events * 24, "{counts:?}");
        assert!(outcome == Outcome::OutOfEvents || events > 1, "{counts:?}");
    }
}

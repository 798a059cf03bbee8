//! Runs that cannot go on: they end, within bounds, and say why.

use glam::DVec3;
use plaus_sim::mechanics::Other;
use plaus_sim::rigid::{BodySpec, Part, Rigid, RigidWorld, Start, Turning};
use plaus_sim::scenery::{Plane, Surface};
use plaus_sim::shape::{Cuboid, Shape};
use plaus_sim::trace::Trace;
use plaus_sim::{Accuracy, Law, Laws, Material, Outcome, Scratch};

const KIND: Material = Material(0);

fn world(shapes: Vec<Shape>, restitution: f64, accuracy: Accuracy) -> Rigid {
    let laws = Laws::uniform(Law::new(0.3, restitution)).unwrap();
    Rigid::new(RigidWorld {
        bodies: shapes.into_iter().map(|shape| BodySpec::solid(shape, 1000.0, KIND)).collect(),
        parts: vec![Part::Plane(Plane::new(DVec3::ZERO, DVec3::Z, KIND).unwrap())],
        laws,
        gravity: DVec3::new(0.0, 0.0, -9.81),
        accuracy: accuracy,
        skin: 1.0,
        sink: f64::NEG_INFINITY,
        duration: 2.0,
    })
    .unwrap()
}

fn run(world: &Rigid, starts: &[Start]) -> (Outcome, Trace<Turning>) {
    let (mut state, mut trace) = (world.state(starts).unwrap(), Trace::default());
    let outcome = world.run(&mut state, &mut Scratch::default(), f64::INFINITY, &mut trace).unwrap();
    (outcome, trace)
}

/// A body so fast that its energy is no number any more: the run ends there, names it and what it met, and no listener
/// has seen a motion that is not finite.
#[test]
fn a_motion_that_is_not_finite_is_named_with_what_it_met() {
    let cube = || Shape::Cuboid(Cuboid::new(DVec3::splat(0.1), 0.0).unwrap());
    for (shapes, velocity, met) in [
        (vec![cube(), cube()], DVec3::X, Some(Other::Body(1))),
        (vec![cube()], DVec3::NEG_Z, None),
        (vec![Shape::Ball(0.05), Shape::Ball(0.05)], DVec3::X, Some(Other::Body(1))),
    ] {
        let world = world(shapes, 0.5, Accuracy::default());
        let start = |k: usize| Start {
            velocity: if k == 0 { velocity * 1e200 } else { DVec3::ZERO },
            ..Start::at_rest(DVec3::new(0.4 * k as f64, 0.0, 1.0))
        };
        let (outcome, trace) = run(&world, &(0..world.count()).map(start).collect::<Vec<_>>());
        let Outcome::NotFinite { body, touched } = outcome else { panic!("{outcome:?}") };
        match met {
            Some(_) => assert!(matches!(touched, Some(Other::Body(other)) if other + body == 1), "{outcome:?}"),
            None => assert!(matches!(touched, Some(Other::Surface(Surface::Part { part: 0, .. }))), "{outcome:?}"),
        }
        let seen = trace.motions.iter().flatten();
        assert!(seen.clone().count() > 0);
        for motion in seen {
            assert!(motion.path.x.is_finite() && motion.path.v.is_finite() && motion.spin.is_finite());
        }
    }
}

/// A heap gives all its bodies a new motion at each event: the budget counts these too, so that time and memory are
/// bounded by the number of bodies. By its events alone the same run would have gone on.
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
    assert!((events * bodies..(events + 1) * bodies).contains(&counts.motions), "{counts:?}");
    assert!(2 * counts.events < events * bodies, "{counts:?}");
}

//! Saving and resuming, early exit, traces, and worlds that are refused.

use crate::common::*;
use glam::DVec3;
use plaus_sim::marbles::{Marble, MarbleSpec, MarbleWorld, Marbles, Phase, Start};
use plaus_sim::mechanics::Mechanics;
use plaus_sim::scenery::{Aabb, Dome, Mesh, Plane, Scenery};
use plaus_sim::trace::{Observer, Trace, While};
use plaus_sim::{Accuracy, Law, Laws, Material, Outcome, Preset, Scratch, State, WorldError, interruptible};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};

/// Eight marbles dropped one after another into a bowl, where they end up in a pile.
fn pile() -> (Marbles, Vec<Start>) {
    let radius = 0.006;
    let mut world =
        World::new(vec![MarbleSpec::solid(radius, 0.002, M); 8], Law::new(0.3, 0.5).with_resistance(0.02, 0.01));
    let clip = Aabb { min: DVec3::new(-0.03, -0.03, -0.01), max: DVec3::new(0.03, 0.03, 0.03) };
    world.domes.push(Dome::new(DVec3::new(0.0, 0.0, 0.04), 0.04, true, clip, M).unwrap());
    (world.accuracy, world.duration) = (Accuracy::default(), 3.0);
    // Each a little off the middle, in another direction.
    let place = |k: u32| DVec3::new(0.4 * f64::from(k % 3) - 0.4, 0.3 * f64::from(k % 4) - 0.5, 12.0) * radius;
    let start = |k: u32| Start { time: 0.1 * f64::from(k), ..Start::at_rest(place(k)) };
    (world.build(), (0..8).map(start).collect())
}

#[test]
fn a_paused_run_goes_on_to_the_same_bits() {
    let (world, starts) = pile();
    let whole = run(&world, &starts, 3.0).2;
    for pause in [0.0, 0.25, 0.3, 0.55, 0.8, 1.5] {
        let mut state = world.state(&starts).unwrap();
        world.run(&mut state, &mut Scratch::default(), pause, &mut ()).unwrap();
        let saved = serde_json::to_string(&state).unwrap();
        let mut resumed: State<Marble> = serde_json::from_str(&saved).unwrap_or_else(|e| panic!("{e}"));
        let mut copied = world.state(&starts).unwrap();
        copied.clone_from(&state);
        for state in [&mut resumed, &mut copied] {
            world.run(state, &mut Scratch::default(), 3.0, &mut ()).unwrap();
            assert_eq!(state.bodies(), whole.bodies(), "paused at {pause}");
            assert_eq!(state.counts(), whole.counts());
        }
    }
}

#[test]
fn a_later_start_can_be_exchanged_in_a_saved_beginning() {
    let (world, mut starts) = pile();
    let mut state = world.state(&starts).unwrap();
    world.run(&mut state, &mut Scratch::default(), 0.65, &mut ()).unwrap();
    starts[7].position.x += 0.001;
    world.restart(&mut state, 7, &starts[7]).unwrap();
    world.run(&mut state, &mut Scratch::default(), 3.0, &mut ()).unwrap();
    assert_eq!(state.bodies(), run(&world, &starts, 3.0).2.bodies());
    assert!(world.restart(&mut state, 7, &starts[7]).is_err(), "it has been released");
}

#[test]
fn an_observer_stops_a_run() {
    let (world, starts) = pile();
    let mut state = world.state(&starts).unwrap();
    let outcome = world
        .run(&mut state, &mut Scratch::default(), 3.0, &mut While(|s: &State<Marble>| s.counts().impacts < 10))
        .unwrap();
    assert_eq!(outcome, Outcome::Stopped);
    assert_eq!(state.counts().impacts, 10);
    world.run(&mut state, &mut Scratch::default(), 3.0, &mut ()).unwrap();
    assert_eq!(state.bodies(), run(&world, &starts, 3.0).2.bodies());
}

/// Asks for an end as another thread would, once this many events have been taken.
struct Asks<'a>(&'a AtomicBool, u64);

impl Observer<Marbles> for Asks<'_> {
    fn proceed(&mut self, state: &State<Marble>) -> bool {
        self.0.fetch_or(state.counts().events >= self.1, Relaxed);
        true
    }
}

#[test]
fn another_thread_stops_a_run() {
    let (world, starts) = pile();
    let whole = run(&world, &starts, 3.0).2;
    for events in [1, 20, 57] {
        let (flag, mut state) = (Arc::new(AtomicBool::new(false)), world.state(&starts).unwrap());
        let mut go = |observer: &mut Asks<'_>| world.run(&mut state, &mut Scratch::default(), 3.0, observer).unwrap();
        let made = interruptible(&flag, || assert_eq!(go(&mut Asks(&flag, events)), Outcome::Stopped));
        assert_eq!(made, None);
        // An event of a heap may be taken together with others.
        let most = events + 8;
        assert!((events..most).contains(&state.counts().events), "{events}, {:?}", state.counts());
        // Nobody else is stopped, and what was stopped can go on.
        world.run(&mut state, &mut Scratch::default(), 3.0, &mut ()).unwrap();
        assert_eq!(state.bodies(), whole.bodies());
    }
}

#[test]
fn a_trace_replays_the_run() {
    let (world, starts) = pile();
    let (mut state, mut trace) = (world.state(&starts).unwrap(), Trace::default());
    world.run(&mut state, &mut Scratch::default(), 3.0, &mut trace).unwrap();
    assert_eq!(state.bodies(), run(&world, &starts, 3.0).2.bodies(), "listening changes nothing");
    assert_eq!(trace.impacts.len() as u64, state.counts().impacts);
    for k in 0..8 {
        for pair in trace.motions[k].windows(2) {
            let time = world.clock(&pair[1]);
            assert!(world.clock(&pair[0]) <= time);
            let mut end = pair[0];
            world.advance(k, &mut end, time);
            // Centres never jump, except that rest may put a centre in its place: both are the same bits.
            assert_eq!(end.path.x, pair[1].path.x);
        }
        let halfway = trace.body_at(&world, k, 1.234_5).unwrap();
        assert_eq!(halfway.path.t, 1.234_5);
    }
    let impact = trace.impacts.iter().find(|i| i.approach > 0.1).unwrap();
    assert!((impact.normal.length() - 1.0).abs() < 1e-15 && impact.impulse.dot(impact.normal) > 0.0);
}

fn specs(radius: f64, mass: f64) -> Result<Marbles, WorldError> {
    Marbles::new(MarbleWorld {
        specs: vec![unit_ball(), MarbleSpec::solid(radius, mass, M)],
        laws: Laws::uniform(Law::new(0.1, 0.5)).unwrap(),
        scenery: Scenery::new(
            vec![Plane::new(DVec3::ZERO, DVec3::Z, M).unwrap()],
            Mesh::new(Vec::new(), &[], 0.0).unwrap(),
            Vec::new(),
            1.0,
        )
        .unwrap(),
        gravity: DVec3::new(0.0, 0.0, -G),
        accuracy: Accuracy::preset(Preset::Draft),
        duration: 1.0,
    })
}

#[test]
fn bad_input_is_named_before_any_stepping() {
    assert!(matches!(specs(0.25, -1.0), Err(WorldError::BadBody { body: 1, field: "mass", .. })));
    assert!(matches!(specs(f64::NAN, 1.0), Err(WorldError::BadBody { body: 1, field: "radius", .. })));
    assert!(matches!(specs(2.0, 1.0), Err(WorldError::BadBody { body: 1, field: "radius", .. })));
    assert!(matches!(Laws::uniform(Law::new(f64::NAN, 0.5)), Err(WorldError::BadLaw { field: "friction", .. })));
    assert!(matches!(Laws::uniform(Law::new(0.1, 1.5)), Err(WorldError::BadLaw { field: "restitution", .. })));
    assert!(matches!(Plane::new(DVec3::ZERO, DVec3::ZERO, M), Err(WorldError::BadSurface { .. })));
    let corners = vec![DVec3::ZERO, DVec3::X, 2.0 * DVec3::X, DVec3::Y];
    assert!(matches!(
        Mesh::new(corners.clone(), &[([0, 1, 3], M), ([0, 1, 2], M)], 0.0),
        Err(WorldError::DegenerateTriangle { triangle: 1, .. } | WorldError::BadEdge { triangle: 1, .. })
    ));
    assert!(matches!(
        Mesh::new(corners.clone(), &[([0, 2, 1], M)], 0.0),
        Err(WorldError::DegenerateTriangle { triangle: 0, .. })
    ));
    assert!(matches!(
        Mesh::new(corners, &[([0, 1, 9], Material(0))], 0.0),
        Err(WorldError::UnknownVertex { triangle: 0, vertex: 9, .. })
    ));
    let world = specs(0.25, 1.0).unwrap();
    let at = |x: f64, z: f64| Start::at_rest(DVec3::new(x, 0.0, z));
    assert!(matches!(world.state(&[at(0.0, 1.0)]), Err(WorldError::WrongState { state: 1, world: 2 })));
    assert!(matches!(world.state(&[at(0.0, 1.0), at(0.4, 1.0)]), Err(WorldError::BodiesOverlap { a: 0, b: 1, .. })));
    assert!(matches!(world.state(&[at(0.0, 1.0), at(1.0, 0.2)]), Err(WorldError::OverlapsScenery { body: 1, .. })));
    assert!(matches!(
        world.state(&[at(0.0, 1.0), at(f64::NAN, 1.0)]),
        Err(WorldError::BadBody { body: 1, field: "position", .. })
    ));
    assert_eq!(world.state(&[at(0.0, 1.0), at(1.0, 1.0)]).unwrap().bodies()[0].phase, Phase::Waiting);
}

#[test]
fn vertices_move_within_their_margins_only() {
    let corners =
        [(0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)].map(|(x, y, z)| DVec3::new(x, y, z));
    let sides = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]].map(|t| (t, M));
    let mesh = Mesh::with_margins(corners.to_vec(), &sides, vec![0.0, 0.0, 0.0, 0.1]).unwrap();
    let mut world = World { mesh, ..World::new(vec![unit_ball()], Law::new(0.1, 0.5)) }.build();
    assert!(world.move_vertices(&[(3, corners[3] + 0.05 * DVec3::X)]).is_ok());
    let far = corners[3] + 0.11 * DVec3::X;
    assert!(matches!(world.move_vertices(&[(3, far)]), Err(WorldError::MovedTooFar { vertex: 3, .. })));
    assert!(world.move_vertices(&[(1, corners[1] + 1e-9 * DVec3::X)]).is_err());
}

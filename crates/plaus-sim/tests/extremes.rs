//! Extreme numbers: energy never grows, nothing becomes NaN, every run ends in an outcome.

use crate::common::*;
use glam::DVec3;
use plaus_sim::marbles::{MarbleSpec, Start};
use plaus_sim::scenery::{Mesh, Plane};
use plaus_sim::trace::Observer;
use plaus_sim::{Accuracy, Law, Outcome, Scratch, State};

/// Checks finiteness after every event, and total energy if all clocks agree at the end.
struct Finite;

impl Observer<plaus_sim::marbles::Marbles> for Finite {
    fn motion(&mut self, k: usize, b: &plaus_sim::marbles::Marble) {
        assert!(
            b.path.x.is_finite() && b.path.v.is_finite() && b.path.a.is_finite() && b.spin.is_finite(),
            "ball {k}: {b:?}"
        );
    }
}

/// Runs a world and checks what must always hold; `grows` is the energy that steps of lasting contact may seem to add,
/// over the total.
fn check(world: World, starts: &[Start]) -> State<plaus_sim::marbles::Marble> {
    let world = world.build();
    let mut state = world.state(starts).unwrap();
    let kinetic = |s: &Start, k: usize| {
        let spec = &world.specs()[k];
        spec.mass
            * (0.5
                * (s.velocity.length_squared() + spec.gyration * spec.radius * spec.radius * s.spin.length_squared())
                - world.gravity().dot(s.position))
    };
    let before: f64 = starts.iter().enumerate().map(|(k, s)| kinetic(s, k)).sum();
    let scale: f64 = starts
        .iter()
        .enumerate()
        .map(|(k, s)| kinetic(s, k).abs() + world.specs()[k].mass * G * world.specs()[k].radius)
        .sum();
    let outcome = world.run(&mut state, &mut Scratch::default(), 4.0, &mut Finite).unwrap();
    assert!(matches!(outcome, Outcome::TimeReached | Outcome::AllAtRest), "{outcome:?} {:?}", state.counts());
    let after = total_energy(&world, &run(&world, starts, 4.0).0);
    // 1e-9: rounding over thousands of events, and centres put back by less than the preset's unseen height.
    assert!(after <= before + 1e-9 * scale, "{after} from {before}");
    state
}

fn standard(specs: Vec<MarbleSpec>, law: Law) -> World {
    let mut world = World::new(specs, law).floor();
    world.accuracy = Accuracy::default();
    world.duration = 4.0;
    world
}

fn three(r: f64) -> Vec<Start> {
    [(0.0, 1.5), (0.3, 4.0), (-0.2, 6.5)].map(|(x, z)| Start::at_rest(DVec3::new(x, 0.1 * z, z) * r)).to_vec()
}

#[test]
fn restitution_and_friction_of_every_size() {
    for e in [0.0, 1e-8, 0.5, 1.0] {
        for mu in [0.0, 1e-8, 0.3, 1e8] {
            check(standard(vec![MarbleSpec::solid(0.1, 1.0, M); 3], Law::new(mu, e)), &three(0.1));
        }
    }
}

#[test]
fn mass_ratio_of_a_million() {
    for masses in [[1e6, 1.0, 1.0], [1.0, 1e6, 1.0], [1.0, 1.0, 1e6]] {
        for e in [0.0, 0.5, 0.9] {
            let specs = masses.map(|m| MarbleSpec::solid(0.1, m, M)).to_vec();
            check(standard(specs, Law::new(0.3, e)), &three(0.1));
        }
    }
}

#[test]
fn radii_from_a_tenth_of_a_millimetre_to_a_hundred_metres() {
    for r in [1e-4, 1e-2, 1.0, 1e2] {
        check(standard(vec![MarbleSpec::solid(r, 1.0, M); 3], Law::new(0.3, 0.5)), &three(r));
    }
    let mixed = [1e-4, 1.0, 1e2].map(|r| MarbleSpec::solid(r, r * r * r, M)).to_vec();
    check(
        standard(mixed, Law::new(0.3, 0.5)),
        &[
            Start::at_rest(DVec3::new(-102.0, 0.0, 1.0)),
            Start::at_rest(DVec3::new(104.0, 0.0, 2.0)),
            Start::at_rest(DVec3::Z * 101.0),
        ],
    );
}

#[test]
fn speeds_up_to_a_kilometre_per_second() {
    for speed in [0.0, 1e-9, 1.0, 1e3] {
        let mut world = standard(vec![MarbleSpec::solid(0.1, 1.0, M); 3], Law::new(0.3, 0.5));
        for (p, n) in [(DVec3::X, -DVec3::X), (-DVec3::X, DVec3::X), (DVec3::Y, -DVec3::Y), (-DVec3::Y, DVec3::Y)] {
            world.planes.push(Plane::new(p, n, M).unwrap());
        }
        let starts: Vec<Start> = three(0.1)
            .iter()
            .enumerate()
            .map(|(k, s)| Start {
                velocity: DVec3::new(speed, 0.3 * speed, -0.1 * speed * k as f64),
                spin: DVec3::ONE * speed,
                ..*s
            })
            .collect();
        check(world, &starts);
    }
}

#[test]
fn exact_grazing_and_exactly_simultaneous_collisions() {
    // Two balls that pass each other at exactly the sum of their radii.
    let mut world = World::new(vec![unit_ball(); 2], Law::new(0.5, 0.5));
    world.gravity = DVec3::ZERO;
    let grazing = [moving(DVec3::new(-1.0, 0.5, 0.0), DVec3::X, DVec3::ZERO), Start::at_rest(DVec3::ZERO)];
    let state = check(world, &grazing);
    assert!((state.bodies()[0].path.v - DVec3::X).length() < 1e-9);
    // Four balls hit a fifth from four sides at once, and the floor in the same instant.
    let starts: Vec<Start> = [(1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0), (0.0, 0.0)]
        .map(|(x, y)| moving(DVec3::new(x, y, 0.25), DVec3::new(-x, -y, 0.0), DVec3::ZERO))
        .to_vec();
    for e in [0.0, 0.5, 1.0] {
        check(standard(vec![unit_ball(); 5], Law::new(0.0, e)), &starts);
    }
}

#[test]
fn a_ball_in_the_middle_of_a_row_is_hit_again_and_again() {
    // Touching balls between two walls that close in on them: none can move, all are hit.
    let mut world = standard(vec![unit_ball(); 5], Law::new(0.0, 0.5));
    world.planes.push(Plane::new(-DVec3::X, DVec3::X, M).unwrap());
    world.planes.push(Plane::new(3.0 * DVec3::X, -DVec3::X, M).unwrap());
    let starts: Vec<Start> = (0..5)
        .map(|k| {
            moving(DVec3::new(0.5 * f64::from(k), 0.0, 0.25), DVec3::X * if k == 0 { 5.0 } else { 0.0 }, DVec3::ZERO)
        })
        .collect();
    check(world, &starts);
}

/// A roof with its ridge along x at height 1, or a groove: sides at 45 degrees.
fn fold(up: f64) -> Mesh {
    let y = 2.0;
    let v = [
        (-4.0, 0.0, 1.0),
        (4.0, 0.0, 1.0),
        (4.0, y, 1.0 - up * y),
        (-4.0, y, 1.0 - up * y),
        (4.0, -y, 1.0 - up * y),
        (-4.0, -y, 1.0 - up * y),
    ];
    let t = [[0, 1, 2], [0, 2, 3], [1, 0, 5], [1, 5, 4]].map(|t| (t, M));
    Mesh::new(v.map(|(x, y, z)| DVec3::new(x, y, z)).to_vec(), &t, 0.0).unwrap()
}

#[test]
fn a_ball_on_an_edge_and_in_a_groove() {
    for (up, y) in [(1.0, 0.0), (1.0, 1e-9), (1.0, 1e-3), (-1.0, 0.0), (-1.0, 0.3)] {
        for e in [0.0, 0.5] {
            let mut world = standard(vec![unit_ball()], Law::new(0.5, e).with_resistance(0.01, 0.01));
            world.planes[0] = Plane::new(DVec3::Z * -10.0, DVec3::Z, M).unwrap();
            world.mesh = fold(up);
            check(world, &[Start::at_rest(DVec3::new(0.1, y, 1.8))]);
        }
    }
}

#[test]
fn a_ball_over_a_groove_narrower_than_itself_rests_on_both_edges() {
    // Two ledges with a gap of 0.3 between them: a ball of radius 0.25 hangs between the edges.
    let ledge = |s: f64| {
        [
            (-2.0, 0.15 * s, 1.0),
            (2.0, 0.15 * s, 1.0),
            (2.0, 2.0 * s, 1.0),
            (-2.0, 2.0 * s, 1.0),
            (-2.0, 0.15 * s, 0.0),
            (2.0, 0.15 * s, 0.0),
        ]
    };
    let v: Vec<DVec3> = ledge(1.0).into_iter().chain(ledge(-1.0)).map(|(x, y, z)| DVec3::new(x, y, z)).collect();
    let t = [[0, 1, 2], [0, 2, 3], [1, 0, 4], [1, 4, 5], [7, 6, 9], [7, 9, 8], [6, 7, 11], [6, 11, 10]].map(|t| (t, M));
    let mut world = standard(vec![unit_ball()], Law::new(0.5, 0.5).with_resistance(0.01, 0.01));
    world.mesh = Mesh::new(v, &t, 0.0).unwrap();
    let state = check(world, &[Start::at_rest(DVec3::new(0.1, 0.01, 1.25))]);
    let x = state.bodies()[0].path.x;
    // sqrt(0.25² − 0.15²) = 0.2 above the edges, up to the unseen height of the preset.
    assert!((x.z - 1.2).abs() < 1e-3 && x.y.abs() < 1e-3, "{:?}", state.bodies());
}

#[test]
fn worlds_of_no_body_and_of_five_hundred() {
    let state = check(standard(Vec::new(), Law::new(0.1, 0.5)), &[]);
    assert_eq!(state.counts().events, 0);
    let mut world = standard(vec![MarbleSpec::solid(0.1, 1.0, M); 500], Law::new(0.0, 1.0));
    world.duration = 1.0;
    let starts: Vec<Start> = (0..500)
        .map(|k| {
            moving(
                DVec3::new(f64::from(k % 25), f64::from(k / 25), 1.0) * 0.3,
                DVec3::new(f64::from(k % 7) - 3.0, f64::from(k % 5) - 2.0, 0.0),
                DVec3::ZERO,
            )
        })
        .collect();
    check(world, &starts);
}

//! Distances of all convex shapes, and when they first touch, compared with another library: parry3d. With
//! `PLAUS_POSES=100000` this many poses are tested for each pair, and a hundredth as many encounters.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

#[path = "../../../crates/plaus-sim/tests/common/dice.rs"]
mod dice;

use dice::Dice;
use glam::{DQuat, DVec3};
use parry3d_f64::math::Pose3;
use parry3d_f64::query::distance;
use parry3d_f64::shape::SharedShape;
use plaus_sim::mechanics::Impact;
use plaus_sim::rigid::{BodySpec, Phase, RigidBodyState, RigidWorld, RigidWorldDesc, Start};
use plaus_sim::shape::{ConvexHull, Cuboid, Frustum, Shape, Solid};
use plaus_sim::trace::Observer;
use plaus_sim::{Accuracy, Law, Laws, Material, Scratch, State};
use std::f64::consts::FRAC_PI_2;

const M: Material = Material(0);

/// Required accuracy of our distances, relative to the size.
const RIGHT: f64 = 1e-9;

/// Accuracy of parry's distances of cylinders, cones and capsules, relative to the size: its search for nearest points
/// ends there. The largest error seen is 8.4e-6, in 3,000 poses apart. Our distances may be smaller than parry's by
/// this much, but never larger, because both have two points that are as far apart as they say. A separating plane
/// proves that ours are not too small (`convex_pair/tests.rs`).
const ORACLE: f64 = 1e-4;

/// Shapes for which parry is not exact.
const CURVED: [&str; 4] = ["cylinder", "coin", "cone", "capsule"];

fn shapes() -> Vec<Kind> {
    let upright = |height: f64| Pose3::from_parts(DVec3::Z * height, DQuat::from_rotation_x(FRAC_PI_2));
    let plain = Pose3::from_parts(DVec3::ZERO, DQuat::IDENTITY);
    let ours = |f: Frustum| Shape::from(f);
    let corners = Solid::Dodecahedron.corners(0.4);
    let hull = ConvexHull::new(&corners, 0.0).unwrap();
    let (half, edges) = (DVec3::new(0.5, 0.3, 0.2), DVec3::new(1.0, 0.6, 0.4));
    let dodecahedron = SharedShape::convex_hull(hull.corners()).unwrap();
    vec![
        ("ball", Shape::Ball(0.4), SharedShape::ball(0.4), plain),
        ("box", Shape::Cuboid(Cuboid::new(edges, 0.0).unwrap()), SharedShape::cuboid(half.x, half.y, half.z), plain),
        ("cylinder", ours(Frustum::cylinder(0.3, 0.8).unwrap()), SharedShape::cylinder(0.4, 0.3), upright(0.0)),
        ("coin", ours(Frustum::cylinder(0.5, 0.05).unwrap()), SharedShape::cylinder(0.025, 0.5), upright(0.0)),
        // Its centre of gravity is at a quarter of the height.
        ("cone", ours(Frustum::cone(0.4, 0.8).unwrap()), SharedShape::cone(0.4, 0.4), upright(0.2)),
        ("capsule", ours(Frustum::capsule(0.2, 0.8).unwrap()), SharedShape::capsule_z(0.4, 0.2), plain),
        ("hull", Shape::Hull(hull.into()), dodecahedron, plain),
    ]
}

/// A shape as ours, as theirs, and the pose of theirs in the axes of ours.
type Kind = (&'static str, Shape, SharedShape, Pose3);

fn poses() -> u64 {
    std::env::var("PLAUS_POSES").ok().and_then(|n| n.parse().ok()).unwrap_or(300)
}

/// Two bodies in space.
fn world(shapes: [&Shape; 2]) -> RigidWorld {
    RigidWorld::new(RigidWorldDesc {
        bodies: shapes.map(|s| BodySpec::solid(s.clone(), 1000.0, M)).to_vec(),
        parts: Vec::new(),
        laws: Laws::uniform(Law::new(0.3, 0.5)).unwrap(),
        gravity: DVec3::ZERO,
        accuracy: Accuracy::default(),
        skin: 1.0,
        sink: f64::NEG_INFINITY,
        duration: 10.0,
    })
    .unwrap()
}

/// Parry's distance between two of our bodies.
fn theirs([a, b]: [&Kind; 2], [x, y]: [&RigidBodyState; 2]) -> f64 {
    let at = |k: &Kind, t: &RigidBodyState| Pose3::from_parts(t.path.x, t.turn) * k.3;
    distance(&at(a, x), &*a.2, &at(b, y), &*b.2).unwrap().distance
}

#[test]
fn distances_agree_with_another_library() {
    let (poses, shapes) = (poses(), shapes());
    let (mut apart, mut worst, mut curved, mut beaten) = (0, 0.0_f64, 0.0_f64, 0.0_f64);
    let mut faults = Vec::new();
    for (i, a) in shapes.iter().enumerate() {
        for (j, b) in shapes.iter().enumerate() {
            let world = world([&a.1, &b.1]);
            let size = a.1.reach() + b.1.reach();
            let mut dice = Dice::new(3, (i * shapes.len() + j) as u64);
            for pose in 0..poses {
                let mut start = |time: f64| Start {
                    position: dice.in_cube() * 0.9,
                    orientation: dice.turn(),
                    time,
                    ..Start::at_rest(DVec3::ZERO)
                };
                // Released one after the other, because they may be in each other.
                let state = world.state(&[start(0.0), start(0.5)]).unwrap();
                let both = [&state.bodies()[0], &state.bodies()[1]];
                if (both[0].path.x - both[1].path.x).length() > size {
                    // In this case the gap is that of the spheres around them.
                    continue;
                }
                let (gap, theirs) = (world.gap([0, 1], both), theirs([a, b], both));
                let case = || format!("{} and {}, pose {pose}: {gap} for {theirs}", a.0, b.0);
                if gap > 0.0 {
                    apart += 1;
                    let is_curved = [a, b].iter().any(|s| CURVED.contains(&s.0));
                    let (off, allowed) = if is_curved { (&mut curved, ORACLE) } else { (&mut worst, RIGHT) };
                    *off = off.max((gap - theirs).abs() / size);
                    beaten = beaten.max((gap - theirs) / size);
                    if (gap - theirs).abs() >= allowed * size || gap >= theirs + RIGHT * size {
                        faults.push(case());
                    }
                } else if theirs >= ORACLE * size {
                    faults.push(case());
                }
            }
        }
    }
    println!(
        "{apart} poses apart: off by {worst:.1e} of the size at most, {curved:.1e} where parry searches; ours farther by \
         {beaten:.1e}"
    );
    assert!(faults.is_empty(), "{} faults:\n{}", faults.len(), faults.join("\n"));
    assert!(apart > 5 * poses, "{apart}");
}

/// Number of times at which an encounter that should not have touched yet is examined.
const LOOKS: u32 = 200;

/// Notes the motions before the first impact, and its time.
#[derive(Default)]
struct First {
    motions: [Option<RigidBodyState>; 2],
    impact: Option<f64>,
}

impl Observer<RigidWorld> for First {
    fn impact(&mut self, impact: &Impact) {
        self.impact.get_or_insert(impact.time);
    }

    fn motion(&mut self, index: usize, body: &RigidBodyState) {
        if self.impact.is_none() && body.phase == Phase::Flight {
            self.motions[index] = Some(body.clone());
        }
    }

    fn proceed(&mut self, _: &State<RigidBodyState>) -> bool {
        self.impact.is_none()
    }
}

/// Two bodies are flung past each other while they turn. They are apart until the reported time of first touch, and
/// then they touch, to within the gap at which bodies count as touching.
#[test]
fn first_contacts_come_when_bodies_touch() {
    let encounters = poses().div_ceil(100);
    let shapes = shapes();
    let (mut touched, mut passed, mut faults) = (0, 0, Vec::new());
    for (i, a) in shapes.iter().enumerate() {
        for (j, b) in shapes.iter().enumerate() {
            let world = world([&a.1, &b.1]);
            let reach = a.1.reach() + b.1.reach();
            let gap = Accuracy::default().gap * a.1.size().min(b.1.size());
            let mut dice = Dice::new(17, (i * shapes.len() + j) as u64);
            for k in 0..encounters {
                let mut start = |side: f64| Start {
                    position: (DVec3::X * side + dice.in_cube().with_x(0.0) * 0.8) * (1.01 * reach),
                    orientation: dice.turn(),
                    velocity: DVec3::X * -side + dice.in_cube() * 0.1,
                    spin: dice.in_cube() * 8.0,
                    time: 0.0,
                };
                let starts = [start(-0.5), start(0.5)];
                let mut state = world.state(&starts).unwrap();
                let mut first = First::default();
                world.run(&mut state, &mut Scratch::default(), 3.0 * reach, &mut first).unwrap();
                let [Some(x), Some(y)] = &first.motions else { panic!("{} and {}: no flight", a.0, b.0) };
                let end = first.impact.unwrap_or(3.0 * reach);
                let case = || format!("{} and {}, encounter {k}, {:?}", a.0, b.0, first.impact);
                let apart = |time: f64| theirs([a, b], [&world.at(0, x, time), &world.at(1, y, time)]);
                let mut times = (0..LOOKS).map(|look| end * f64::from(look) / f64::from(LOOKS));
                if let Some(time) = times.find(|&time| apart(time) <= 0.0) {
                    faults.push(format!("{}: in each other at {time}", case()));
                }
                if first.impact.is_some() {
                    touched += 1;
                    let at = apart(end);
                    if at > gap + ORACLE * reach {
                        faults.push(format!("{}: {at} apart, but {gap} is to touch", case()));
                    }
                } else {
                    passed += 1;
                }
            }
        }
    }
    println!("{touched} pairs touched, {passed} passed each other");
    assert!(faults.is_empty(), "{} faults:\n{}", faults.len(), faults.join("\n"));
    assert!(touched > passed && passed > 0, "{touched} {passed}");
}

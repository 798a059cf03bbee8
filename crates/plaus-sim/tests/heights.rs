//! Height fields: as scenery they are what their heights say, and nothing falls through them.

use crate::common::zoo::{Body, Dice, HALF};
use crate::common::{G, M, World};
use glam::{DQuat, DVec3};
use plaus_sim::marbles::{MarbleSpec, Start as MarbleStart};
use plaus_sim::rigid::{RigidBodyState, RigidWorld, RigidWorldDesc, Start, StaticShape};
use plaus_sim::scenery::{Heights, Plane};
use plaus_sim::trace::Observer;
use plaus_sim::{Accuracy, Law, Laws, Outcome, Preset, Scratch, WorldError};
use std::sync::Arc;

/// A field of `columns × rows` points with heights from a function, about the origin.
fn field([columns, rows]: [usize; 2], spacing: [f64; 2], height: impl Fn(f64, f64) -> f64) -> Heights {
    let at = |k: usize, points: usize, spacing: f64| (k as f64 - 0.5 * (points - 1) as f64) * spacing;
    let row = |j: usize| -> Vec<f64> {
        (0..columns).map(|i| height(at(i, columns, spacing[0]), at(j, rows, spacing[1]))).collect()
    };
    Heights::new(spacing, &(0..rows).map(row).collect::<Vec<_>>()).unwrap()
}

fn world(bodies: &[Body], parts: Vec<StaticShape>, law: Law) -> RigidWorld {
    RigidWorld::new(RigidWorldDesc {
        bodies: bodies.iter().map(|b| b.spec()).collect(),
        parts,
        laws: Laws::uniform(law).unwrap(),
        gravity: DVec3::NEG_Z * G,
        accuracy: Accuracy::preset(Preset::Standard),
        skin: 0.5,
        sink: f64::NEG_INFINITY,
        duration: 100.0,
    })
    .unwrap()
}

fn ground(heights: &Heights) -> StaticShape {
    StaticShape::Mesh(Arc::new(heights.mesh(DVec3::ZERO, DQuat::IDENTITY, M).unwrap()))
}

/// Where a body is that starts there, at a time.
fn after(world: &RigidWorld, start: Start, time: f64) -> RigidBodyState {
    let mut state = world.state(&[start]).unwrap();
    world.run(&mut state, &mut Scratch::default(), time, &mut ()).unwrap();
    world.at(0, &state.bodies()[0], time.min(state.time()))
}

/// Bodies of every kind on a tilted field and on the plane through its points: one way, impacts and sliding included.
/// A field that is a little steeper is told apart.
#[test]
fn a_planar_field_is_the_plane() {
    let slope = [0.2, -0.1];
    let normal = DVec3::new(-slope[0], -slope[1], 1.0).normalize();
    let plane = vec![StaticShape::Plane(Plane::new(DVec3::ZERO, normal, M).unwrap())];
    let tilted = |by: f64| vec![ground(&field([21, 17], [0.05, 0.07], |x, y| by * (slope[0] * x + slope[1] * y)))];
    for (k, body) in [Body::Ball, Body::Cuboid, Body::Hull, Body::Coin, Body::Hammer].into_iter().enumerate() {
        let mut dice = Dice::new(41, k as u64);
        let law = Law::new(0.3, 0.4);
        for _ in 0..2 {
            let start = Start {
                velocity: dice.in_cube() * 0.5,
                spin: dice.in_cube() * 5.0,
                orientation: dice.turn(),
                ..Start::at_rest(DVec3::new(dice.between(-0.1, 0.1), dice.between(-0.1, 0.1), 0.15))
            };
            let [on_field, on_plane, on_steeper] = [tilted(1.0), plane.clone(), tilted(1.001)]
                .map(|parts| after(&world(&[body], parts, law), start, 0.25).path.x);
            // A time of contact is within half the gap at which bodies touch, whatever finds it: the first impact comes
            // at about 1.5 m/s, and the next ones multiply the difference.
            let far = (on_field - on_plane).length();
            let size = body.shape().size();
            assert!(far < 0.02 * size, "{body:?}: {far:e} of {size}");
            if far < 1e-6 * size {
                assert!((on_steeper - on_plane).length() > 10.0 * far, "{body:?}");
            }
        }
    }
}

/// The same for marbles, which roll over triangles in closed form.
#[test]
fn a_marble_rolls_over_a_planar_field_as_on_the_plane() {
    let (slope, radius) = (0.1, 0.01);
    let heights = field([41, 9], [0.03, 0.05], |x, _| -slope * x);
    let normal = DVec3::new(slope, 0.0, 1.0).normalize();
    let make = |on_field: bool| {
        let mut world = World::new(vec![MarbleSpec::solid(radius, 0.01, M)], Law::new(0.4, 0.3));
        if on_field {
            world.mesh = heights.mesh(DVec3::ZERO, DQuat::IDENTITY, M).unwrap();
        } else {
            world.planes = vec![Plane::new(DVec3::ZERO, normal, M).unwrap()];
        }
        world.build()
    };
    let at = DVec3::new(-0.5, 0.03, slope * 0.5) + normal * (radius + 0.01);
    let start = MarbleStart { velocity: DVec3::Y * 0.05, ..MarbleStart::at_rest(at) };
    let [on_field, on_plane] = [true, false].map(|on| crate::common::run(&make(on), &[start], 1.0).0[0].path.x);
    assert!(on_plane.x > -0.2, "it has rolled over many triangles: {on_plane}");
    assert!((on_field - on_plane).length() < 1e-9, "{on_field} {on_plane}");
}

struct Lowest<'h> {
    heights: &'h Heights,
    depth: f64,
}

impl Observer<RigidWorld> for Lowest<'_> {
    fn motion(&mut self, _: usize, body: &RigidBodyState) {
        let at = body.path.x;
        if let Some(height) = self.heights.height(at.x, at.y) {
            self.depth = self.depth.max(height - at.z);
        }
    }
}

/// Every shape, shot at hills at up to 100 m/s: no centre of gravity gets below the surface.
#[test]
fn nothing_falls_through_at_any_speed() {
    let hills = |x: f64, y: f64| {
        let wave = |u: f64| plaus_dist::math::sin_cos(u / 0.07).0;
        0.03 * wave(x) * wave(1.3 * y + 0.2)
    };
    let heights = field([41, 41], [2.0 * HALF / 40.0; 2], hills);
    for (k, body) in Body::ALL.into_iter().enumerate() {
        let world = world(&[body], vec![ground(&heights)], Law::new(0.3, 0.5).with_resistance(0.01, 0.01));
        let mut dice = Dice::new(43, k as u64);
        for speed in [1.0, 10.0, 100.0] {
            let start = Start {
                velocity: DVec3::new(0.2, -0.1, -1.0) * speed,
                spin: dice.in_cube() * (0.2 * speed / body.shape().reach()),
                orientation: dice.turn(),
                ..Start::at_rest(DVec3::new(dice.between(-0.1, 0.1), dice.between(-0.1, 0.1), 0.12))
            };
            let mut lowest = Lowest { heights: &heights, depth: f64::NEG_INFINITY };
            let mut state = world.state(&[start]).unwrap();
            let outcome = world.run(&mut state, &mut Scratch::default(), 0.4, &mut lowest).unwrap();
            assert!(matches!(outcome, Outcome::TimeReached | Outcome::AllAtRest), "{body:?} {speed}: {outcome:?}");
            assert!(state.counts().impacts > 0, "{body:?} {speed}: it hits the hills");
            assert!(lowest.depth < 0.0, "{body:?} {speed}: {} below", lowest.depth);
        }
    }
}

#[test]
fn what_is_no_height_field_is_refused() {
    let bad = |spacing: [f64; 2], rows: &[Vec<f64>]| Heights::new(spacing, rows).unwrap_err().to_string();
    let flat = vec![vec![0.0; 3]; 2];
    assert!(bad([0.0, 1.0], &flat).contains("spacing of a height field is 0, expected a positive length"));
    assert!(bad([1.0, f64::NAN], &flat).contains("spacing"));
    assert!(bad([1.0; 2], &flat[..1]).contains("rows of a height field is 1, expected at least 2"));
    assert!(bad([1.0; 2], &[]).contains("rows of a height field is 0"));
    assert!(bad([1.0; 2], &[vec![0.0], vec![0.0]]).contains("heights in a row is 1"));
    assert!(bad([1.0; 2], &[vec![0.0; 2], vec![0.0; 3]]).contains("heights in a row is 3, expected as many as in the"));
    let nan = Heights::new([1.0; 2], &[vec![0.0; 3], vec![0.0, f64::NAN, 0.0]]).unwrap_err();
    assert!(matches!(nan, WorldError::BadControlPoint { i: 1, j: 1, .. }), "{nan}");
    let steep =
        Heights::new([1e-9; 2], &[vec![0.0, 1e9], vec![0.0, 0.0]]).unwrap().mesh(DVec3::ZERO, DQuat::IDENTITY, M);
    assert!(matches!(steep, Err(WorldError::DegenerateTriangle { .. })));
}

/// A ball dropped through the edge of the field falls beside it; one over the field does not.
#[test]
fn beyond_the_field_there_is_nothing() {
    let heights = field([3, 3], [0.1, 0.1], |_, _| 0.0);
    let world = world(&[Body::Ball], vec![ground(&heights)], Law::new(0.3, 0.2));
    let [over, beside] = [0.05, 0.15].map(|x| after(&world, Start::at_rest(DVec3::new(x, 0.02, 0.1)), 0.5).path.x.z);
    assert!(over > 0.019 && beside < -0.5, "{over} {beside}");
}

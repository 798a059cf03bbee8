//! Symmetric worlds stay symmetric: points that are struck at one instant are resolved without any order.

use crate::laws::record::{Moment, Record, record};
use crate::laws::worlds::{M, in_space, on_floor};
use glam::{DMat3, DQuat, DVec3};
use plaus_sim::resolve::{ContactMatrix, stronge_impulse};
use plaus_sim::rigid::{BodySpec, Start};
use plaus_sim::shape::{Cuboid, Shape};
use plaus_sim::{Accuracy, Law, Outcome, Preset};

const EDGE: f64 = 0.1;

fn cuboid(edges: DVec3) -> BodySpec {
    BodySpec::solid(Shape::Cuboid(Cuboid::new(edges, 0.0).unwrap()), 1000.0, M)
}

/// How far positions may be off: a preset resolves no more than the gap at which bodies touch, over a few impacts.
fn enough(preset: Preset) -> f64 {
    10.0 * Accuracy::preset(preset).gap
}

/// How far, over its edge, a body has left the vertical line on which it was dropped, or turned about that line.
fn off_its_spot(r: &Record) -> f64 {
    let first = &r.moments[0][0];
    let off = |m: &Moment| {
        let turned = m.turn * first.turn.conjugate();
        let aside = (m.x - first.x).with_z(0.0).length() / EDGE;
        aside.max(2.0 * DVec3::new(turned.x, turned.y, turned.z).length())
    };
    r.moments[0].iter().map(off).fold(0.0, f64::max)
}

fn dropped_flat(preset: Preset, edges: DVec3, law: Law, yaw: f64) -> Record {
    let start =
        Start { orientation: DQuat::from_rotation_z(yaw), ..Start::at_rest(DVec3::new(0.03, 0.07, 2.0 * EDGE)) };
    record(on_floor(vec![cuboid(edges)], law, preset), &[start], 10.0, 20_000)
}

#[test]
fn a_cuboid_dropped_flat_stays_on_its_spot() {
    for preset in Preset::ALL {
        for edges in [DVec3::splat(EDGE), DVec3::new(0.6, 0.9, 1.3) * EDGE] {
            for (e, mu) in [(0.0, 0.3), (0.5, 0.3), (0.5, 0.0), (0.9, 1.0)] {
                for yaw in [0.0, 0.3] {
                    let r = dropped_flat(preset, edges, Law::new(mu, e), yaw);
                    let off = off_its_spot(&r);
                    let what = format!("{} e {e} mu {mu} yaw {yaw} edges {edges}", preset.name());
                    assert!(off <= enough(preset), "{what}: off by {off:.1e}");
                    assert_eq!(r.outcome, Outcome::AllAtRest, "{what}");
                }
            }
        }
    }
}

/// The wrong twin: four corners that come down at once are struck one after the other, in the order of their indices.
fn struck_in_order(r: &Record, law: Law) -> Record {
    let mut twin = r.clone();
    let facts = r.facts[0];
    let at = twin.moments[0].iter().position(|m| m.impacts > 0).unwrap();
    let before = twin.moments[0][at - 1];
    let fall = before.v.z - 9.81 * (twin.moments[0][at].time - before.time);
    let (mut v, mut w) = (DVec3::Z * fall, DVec3::ZERO);
    let frame = DMat3::from_quat(before.turn);
    for corner in 0..4 {
        let sign = |bit: usize| if corner >> bit & 1 == 1 { 0.5 } else { -0.5 };
        let arm = frame * DVec3::new(sign(0), sign(1), -0.5) * EDGE;
        let u = v + w.cross(arm);
        if u.z < 0.0 {
            let cross = DMat3::from_cols(
                DVec3::new(0.0, arm.z, -arm.y),
                DVec3::new(-arm.z, 0.0, arm.x),
                DVec3::new(arm.y, -arm.x, 0.0),
            );
            let k = DMat3::IDENTITY * (1.0 / facts.mass) - cross * cross * (1.0 / facts.inertia.x);
            let push = stronge_impulse(&ContactMatrix(k), u, law.restitution, law.friction, 0.01);
            v += push / facts.mass;
            w += arm.cross(push) / facts.inertia.x;
        }
    }
    // It flies on for 20 ms.
    let mut flown = twin.moments[0][at];
    (flown.v, flown.w) = (v, w);
    (flown.time, flown.x) = (flown.time + 0.02, flown.x + v * 0.02);
    flown.turn = DQuat::from_scaled_axis(w * 0.02) * flown.turn;
    twin.moments[0].truncate(at);
    twin.moments[0].push(flown);
    twin
}

#[test]
fn an_order_by_index_would_be_seen() {
    for preset in Preset::ALL {
        for e in [0.0, 0.5] {
            let law = Law::new(0.3, e);
            let r = dropped_flat(preset, DVec3::splat(EDGE), law, 0.0);
            let off = off_its_spot(&struck_in_order(&r, law));
            assert!(off > 100.0 * enough(preset), "{}: only {off:.1e}", preset.name());
        }
    }
}

/// How far a body has left the plane y = 0 in which it was dropped, or turned out of it, over its edge.
fn out_of_plane(r: &Record) -> f64 {
    let off = |m: &Moment| (m.x.y.abs() / EDGE).max((m.turn * DVec3::Y - DVec3::Y).length());
    r.moments[0].iter().map(off).fold(0.0, f64::max)
}

/// A cube that is tilted about one edge only comes down on that edge, on both corners at once, and never leaves its
/// plane. It is followed for 0.35 s, which holds a few impacts: in tumbling, each impact multiplies errors by several.
#[test]
fn a_drop_with_a_mirror_plane_keeps_it() {
    for preset in Preset::ALL {
        for tilt in [0.1, 0.5, 0.7] {
            for (e, mu) in [(0.0, 0.3), (0.5, 0.3), (0.5, 0.0)] {
                let start = Start {
                    orientation: DQuat::from_rotation_y(tilt),
                    velocity: DVec3::X * 0.5,
                    ..Start::at_rest(DVec3::Z * 1.5 * EDGE)
                };
                let world = on_floor(vec![cuboid(DVec3::splat(EDGE))], Law::new(mu, e), preset);
                let r = record(world, &[start], 0.35, 20_000);
                assert!(!r.impacts.is_empty());
                let off = out_of_plane(&r);
                assert!(off <= enough(preset), "{} tilt {tilt} e {e} mu {mu}: {off:.1e}", preset.name());
                // The twin: the same cube, struck a little earlier at one end.
                let mut twin = r.clone();
                let at = twin.moments[0].iter().position(|m| m.impacts > 0).unwrap();
                let lever = DVec3::Y * (0.5 * EDGE);
                let push = r.impacts[0].impulse.z * 0.1;
                let w = lever.cross(DVec3::Z * push) / r.facts[0].inertia.x;
                let from = twin.moments[0][at].time;
                for m in &mut twin.moments[0][at..] {
                    m.turn = DQuat::from_scaled_axis(w * (m.time - from)) * m.turn;
                }
                assert!(out_of_plane(&twin) > 10.0 * enough(preset), "{}: the twin passes", preset.name());
            }
        }
    }
}

fn ball() -> BodySpec {
    BodySpec::solid(Shape::Ball(0.5 * EDGE), 1000.0, M)
}

/// Speeds of balls in a row after some of them have come in, while the others touched each other; in units of the first
/// ball's speed.
fn row(balls: usize, coming: usize, preset: Preset) -> Vec<f64> {
    let starts: Vec<Start> = (0..balls)
        .map(|k| {
            let (back, v) = if k < coming { (-0.1 * EDGE, 1.0) } else { (0.0, 0.0) };
            Start { velocity: DVec3::X * v, ..Start::at_rest(DVec3::X * (EDGE * k as f64 + back)) }
        })
        .collect();
    let r = record(in_space(vec![ball(); balls], Law::new(0.0, 1.0), preset), &starts, 1.0, 20_000);
    r.moments.iter().map(|m| m.last().unwrap().v.x).collect()
}

#[test]
fn as_many_balls_leave_a_cradle_as_came_in() {
    for preset in Preset::ALL {
        for coming in 1..4 {
            let v = row(5, coming, preset);
            for (k, v) in v.iter().enumerate() {
                let expected = f64::from(u8::from(k + coming >= 5));
                assert!((v - expected).abs() <= enough(preset), "{}, {coming} of 5: ball {k} has {v}", preset.name());
            }
        }
    }
}

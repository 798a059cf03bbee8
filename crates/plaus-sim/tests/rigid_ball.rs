//! Balls on slopes and on triangles, against closed forms: rolling and sliding down, over an edge, into a hollow one;
//! and on random ground, where their energy must not grow.

use crate::common::zoo::Dice;
use crate::common::{G, M};
use glam::{DQuat, DVec3};
use plaus_sim::rigid::{BodySpec, Phase, RigidBodyState, RigidWorld, RigidWorldDesc, Start, StaticShape};
use plaus_sim::scenery::{Heights, Mesh, Plane};
use plaus_sim::shape::Shape;
use plaus_sim::trace::Observer;
use plaus_sim::{Accuracy, Law, Laws, Outcome, Preset, Scratch};
use std::sync::Arc;

const R: f64 = 0.01;

fn world(part: StaticShape, law: Law, preset: Preset) -> RigidWorld {
    RigidWorld::new(RigidWorldDesc {
        bodies: vec![BodySpec::solid(Shape::Ball(R), 2500.0, M)],
        parts: vec![part],
        laws: Laws::uniform(law).unwrap(),
        accuracy: Accuracy::preset(preset),
        ..RigidWorldDesc::default()
    })
    .unwrap()
}

/// Strips along y between these places along x, 2 m wide, each of many triangles.
fn strips(profile: &[(f64, f64)]) -> StaticShape {
    let across = 40;
    let y = |k: usize| (k as f64 / across as f64 - 0.5) * 2.0;
    let corners = profile.iter().flat_map(|&(x, z)| (0..=across).map(move |k| DVec3::new(x, y(k), z)));
    let row = across as u32 + 1;
    let cells = (0..profile.len() as u32 - 1).flat_map(|i| (0..across as u32).map(move |k| i * row + k));
    let triangles: Vec<_> =
        cells.flat_map(|c| [[c, c + row, c + 1], [c + 1, c + row, c + row + 1]]).map(|t| (t, M)).collect();
    StaticShape::Mesh(Arc::new(Mesh::new(corners.collect(), &triangles, 0.0).unwrap()))
}

/// A plane through the origin that falls along x at this angle; many triangles in it.
fn slope(angle: f64) -> StaticShape {
    let (s, c) = plaus_dist::math::sin_cos(angle);
    strips(&[-0.5, -0.2, 0.1, 0.3, 0.7, 1.2, 2.0, 3.0].map(|d| (d * c, -d * s)))
}

fn after(world: &RigidWorld, start: Start, time: f64) -> (RigidBodyState, u64) {
    let mut state = world.state(&[start]).unwrap();
    world.run(&mut state, &mut Scratch::default(), time, &mut ()).unwrap();
    (world.at(0, &state.bodies()[0], time), state.counts().events)
}

/// PHYSICS: from rest, a = (5/7) g sin α if µ ≥ (2/7) tan α, otherwise g (sin α − µ cos α), on a plane and on triangles
/// in it. The ball starts on the ground, and what it loses until the contact lasts is below a tenth of the gap at which
/// bodies touch: 1e-7 of the way. A ball that does not turn (a = g sin α) is told apart.
#[test]
fn down_a_slope_it_rolls_or_slides() {
    let t = 0.6;
    for (angle, friction) in [(0.1, 0.3), (0.4, 0.3), (0.4, 0.05), (0.9, 0.2), (0.02, 0.01)] {
        let (s, c) = plaus_dist::math::sin_cos(angle);
        let rolls = friction >= 2.0 / 7.0 * s / c;
        let a = if rolls { 5.0 / 7.0 * G * s } else { G * (s - friction * c) };
        let normal = DVec3::new(s, 0.0, c);
        for part in [StaticShape::Plane(Plane::new(DVec3::ZERO, normal, M).unwrap()), slope(angle)] {
            let (ball, events) = after(
                &world(part, Law::new(friction, 0.0), Preset::Standard),
                Start::at_rest(normal * R + DVec3::Y * 0.013),
                t,
            );
            let way = ball.path.x.dot(DVec3::new(c, 0.0, -s));
            assert!((way / (0.5 * a * t * t) - 1.0).abs() < 1e-7, "{angle}, {friction}: {way}");
            assert!((0.5 * G * s * t * t / way - 1.0).abs() > 1e-2);
            assert!((ball.path.x.dot(normal) - R).abs() < 1e-5 * R);
            // A handful of sides are crossed; steps would be hundreds.
            assert!(ball.phase == Phase::Glide && events < 40, "{events} events");
        }
    }
}

/// Energy over the mass, from the ground at z = 0, with an inertia of k m r².
fn energy(ball: &RigidBodyState, k: f64) -> f64 {
    0.5 * ball.path.v.length_squared() + 0.5 * k * (R * ball.spin).length_squared() + G * ball.path.x.z
}

/// A slow ball turns over an edge and loses nothing; a fast one flies over it and lands. A ball of which only the
/// motion counts, not the rotation, would seem to gain.
#[test]
fn over_an_edge_it_turns_without_loss() {
    for preset in [Preset::Standard, Preset::Fine] {
        for fold in [0.003, 0.03, 0.2, 0.7] {
            let (s, c) = plaus_dist::math::sin_cos(fold);
            // So much friction that it does not slip where the edge carries little.
            let world = world(strips(&[(-1.0, 0.0), (0.0, 0.0), (c, -s)]), Law::new(50.0, 0.0), preset);
            for (speed, flies) in [(0.05, false), (0.2, false), (0.4, true)] {
                let v = DVec3::new(speed, 0.3 * speed, 0.0);
                let at = DVec3::new(-0.02, 0.01, R);
                let start = Start { velocity: v, spin: DVec3::Z.cross(v) / R, ..Start::at_rest(at) };
                let (ball, events) = after(&world, start, 0.02 / speed + 0.3);
                let first = 0.7 * v.length_squared() + G * R;
                let lost = 1.0 - energy(&ball, 0.4) / first;
                assert!(ball.path.x.x > 0.005 && events < 60, "{fold}, {speed}: {events} events");
                if flies {
                    assert!(lost > 0.0 && lost < 1.0, "{fold}, {speed}: {lost}");
                } else {
                    assert!(lost.abs() < 1e-6, "{fold}, {speed}: {lost}");
                    assert!((1.0 - energy(&ball, 0.0) / (0.5 * v.length_squared() + G * R)).abs() > 1e-4);
                }
            }
        }
    }
}

/// At the end of a sheet a fast ball flies off as it comes, to the speed with which it parts: 1e-8 of its own, over
/// less than a metre, and what the search for its start on the ground leaves. A slow one rolls over the edge until the
/// edge carries nothing, at cos φ = (10 + 7 v²/(g R))/17, and leaves with √(g R cos φ). It may leave later by the angle
/// of one step about the edge, 0.025 rad at the fine preset; nothing changes faster with the angle than √(g R).
#[test]
fn off_the_end_of_a_sheet_it_flies_or_rolls_over() {
    let off = |speed: f64, preset: Preset, time: f64| {
        let world = world(strips(&[(-1.0, 0.0), (0.0, 0.0)]), Law::new(50.0, 0.0), preset);
        let v = DVec3::X * speed;
        let start = Start { velocity: v, spin: DVec3::Z.cross(v) / R, ..Start::at_rest(DVec3::new(-0.02, 0.01, R)) };
        after(&world, start, 0.02 / speed + time).0
    };
    for preset in [Preset::Draft, Preset::Standard, Preset::Fine] {
        for speed in [0.35, 1.0, 4.0] {
            let (ball, t) = (off(speed, preset, 0.2), 0.2);
            let expected = DVec3::new(speed * t, 0.01, R - 0.5 * G * t * t);
            assert!((ball.path.x - expected).length() < 1e-7, "{preset:?}, {speed}: {}", ball.path.x - expected);
        }
    }
    for speed in [0.02, 0.1, 0.15] {
        let c = (10.0 + 7.0 * speed * speed / (G * R)) / 17.0;
        let (ball, along) = (off(speed, Preset::Fine, 0.6), (G * R * c).sqrt() * c);
        assert!(
            ball.path.x.z < -R && (ball.path.v.x - along).abs() < 0.025 * (G * R).sqrt(),
            "{speed}: {}",
            ball.path.v
        );
        assert!((speed - along).abs() > 0.05 * (G * R).sqrt(), "a twin that leaves at once");
    }
}

/// A ball that rolls into a hollow edge without rebound keeps its angular momentum about the new point of contact:
/// v′ = v (2 + 5 cos δ)/7. To 1e-6, as the solver of impacts is. A ball that loses only the speed along the new normal,
/// v′ = v cos δ, is told apart.
#[test]
fn into_a_hollow_edge_it_keeps_its_angular_momentum() {
    for fold in [0.05, 0.15, 0.3] {
        let (s, c) = plaus_dist::math::sin_cos(fold);
        let world = world(strips(&[(-1.0, 0.0), (0.0, 0.0), (c, s)]), Law::new(3.0, 0.0), Preset::Standard);
        let v = DVec3::X * 0.7;
        let start = Start { velocity: v, spin: DVec3::Z.cross(v) / R, ..Start::at_rest(DVec3::new(-0.02, 0.01, R)) };
        let (mut state, mut speed) = (world.state(&[start]).unwrap(), Speed::default());
        world.run(&mut state, &mut Scratch::default(), 0.04, &mut speed).unwrap();
        let after = speed.0 / v.length();
        assert!((after - (2.0 + 5.0 * c) / 7.0).abs() < 1e-6, "{fold}: {after}");
        assert!((after - c).abs() > 1e-4);
    }
}

/// The speed after the last impact.
#[derive(Default)]
struct Speed(f64, bool);

impl Observer<RigidWorld> for Speed {
    fn impact(&mut self, _: &plaus_sim::mechanics::Impact) {
        self.1 = true;
    }

    fn motion(&mut self, _: usize, body: &RigidBodyState) {
        if std::mem::take(&mut self.1) {
            self.0 = body.path.v.length();
        }
    }
}

/// How much the energy has grown since it was lowest, over the weight times the radius, if weights are this part of
/// what they are.
struct Watch<'w> {
    world: &'w RigidWorld,
    weight: f64,
    part: f64,
    lowest: f64,
    grown: f64,
}

impl Observer<RigidWorld> for Watch<'_> {
    fn motion(&mut self, _: usize, body: &RigidBodyState) {
        let now = self.world.energy(0, body) / (self.weight * R) - (1.0 - self.part) * body.path.x.z / R;
        self.grown = self.grown.max(now - self.lowest);
        self.lowest = self.lowest.min(now);
    }
}

/// A ball let go over random hills in a bowl, from smooth to rough.
fn hills(dice: &mut Dice, k: u64) -> (RigidWorld, Start) {
    let rough = 0.01 * dice.between(0.0, 0.5) * dice.between(0.0, 1.0);
    let at = |k: u32| (f64::from(k) - 10.0) * 0.01;
    let mut row = |j: u32| -> Vec<f64> {
        (0..21).map(|i| 2.0 * (at(i) * at(i) + at(j) * at(j)) + rough * dice.between(-1.0, 1.0)).collect()
    };
    let rows: Vec<_> = (0..21).map(&mut row).collect();
    let mesh = Heights::new([0.01, 0.01], &rows).unwrap().mesh(DVec3::ZERO, DQuat::IDENTITY, M).unwrap();
    let resistance = if k.is_multiple_of(2) { 0.0 } else { 0.05 };
    let friction = if k.is_multiple_of(5) { 0.0 } else { dice.between(0.0, 1.0) };
    let law = Law::new(friction, dice.between(0.0, 0.9)).with_resistance(resistance, resistance);
    let start = Start {
        velocity: dice.in_cube() * 0.3,
        spin: dice.in_cube() * 30.0,
        ..Start::at_rest(dice.in_cube() * DVec3::new(0.05, 0.05, 0.0) + DVec3::Z * 0.05)
    };
    (world(StaticShape::Mesh(Arc::new(mesh)), law, Preset::Standard), start)
}

/// On hills a ball comes to its end: it rests, or its time is over. It never runs out of events or falls through. Its
/// energy grows by no more than steps may add, 1e-3 of its weight times its radius; in one of twenty worlds at most by
/// more, up to 1e-2, where it is jammed between faces and steps push it out. A ball of a fifth of the weight with which
/// it falls would be seen to gain.
#[test]
fn on_random_hills_it_never_stalls_sinks_or_gains() {
    let (mut gains, mut seen) = (0, 0);
    for k in 0..120 {
        let mut dice = Dice::new(83, k);
        let (world, start) = hills(&mut dice, k);
        let grown = [1.0, 0.2].map(|part| {
            let mut state = world.state(&[start]).unwrap();
            let weight = G * 2500.0 * Shape::Ball(R).mass_properties(1.0).mass;
            let mut watch = Watch { world: &world, weight, part, lowest: f64::INFINITY, grown: 0.0 };
            let outcome = world.run(&mut state, &mut Scratch::default(), 2.0, &mut watch).unwrap();
            assert!(matches!(outcome, Outcome::AllAtRest | Outcome::TimeReached), "{k}: {outcome:?}");
            let x = world.at(0, &state.bodies()[0], state.time()).path.x;
            assert!(x.z > 0.0 || x.x.abs() > 0.1 || x.y.abs() > 0.1, "{k}: fell through, {x}");
            watch.grown
        });
        assert!(grown[0] <= 1e-2, "{k}: gained {:e}", grown[0]);
        gains += u32::from(grown[0] > 1e-3);
        seen += u32::from(grown[1] > 1e-2);
    }
    assert!(gains <= 6 && seen > 30, "{gains} gained, {seen} of the lighter ones");
}

//! Bodies on curved tracks: closed forms of balls that slide and roll in them, loops, and what holds a box.

use crate::common::zoo::Dice;
use crate::common::{G, M};
use crate::rigid_joints::elliptic;
use glam::{DQuat, DVec3};
use plaus_dist::math;
use plaus_sim::mechanics::Impact;
use plaus_sim::rigid::{BodySpec, Phase, RigidBodyState, RigidWorld, RigidWorldDesc, Start, StaticShape};
use plaus_sim::scenery::{Aabb, ArcForm, ArcTrack, Mesh, Plane};
use plaus_sim::shape::{Cuboid, Frustum, Shape};
use plaus_sim::trace::Observer;
use plaus_sim::{Accuracy, Law, Laws, Outcome, Preset, Scratch};
use std::f64::consts::{FRAC_PI_2, PI};
use std::sync::Arc;

/// A ball and the cylinder that it is in.
const BALL: f64 = 0.01;
pub(crate) const RADIUS: f64 = 0.2;
/// From the axis to the ball's centre.
const ARM: f64 = RADIUS - BALL;

pub(crate) const FORM: ArcForm =
    ArcForm { radius: RADIUS, angles: [-PI, 0.0], width: 0.1, pitch: 0.0, thickness: 0.01, walls: 0.0 };

/// A track whose lowest line is the y axis.
pub(crate) fn arc(form: ArcForm) -> StaticShape {
    StaticShape::Arc(Arc::new(ArcTrack::new(form, DVec3::Z * form.radius, DQuat::IDENTITY, M).unwrap()))
}

/// The same from this many flat faces for each turn.
fn faceted(form: ArcForm, faces: u32) -> StaticShape {
    let steps = (f64::from(faces) * (form.angles[1] - form.angles[0]) / (2.0 * PI)).round() as u32;
    let corner = |k: u32, side: f64| {
        let (s, c) =
            math::sin_cos(form.angles[0] + (form.angles[1] - form.angles[0]) * f64::from(k) / f64::from(steps));
        DVec3::new(form.radius * c, side * form.width, form.radius * (1.0 + s))
    };
    let corners = (0..=steps).flat_map(|k| [corner(k, -0.5), corner(k, 0.5)]).collect();
    let halves = (0..steps).flat_map(|k| [[2 * k, 2 * k + 2, 2 * k + 3], [2 * k, 2 * k + 3, 2 * k + 1]]);
    let triangles: Vec<_> = halves.map(|t| (t, M)).collect();
    StaticShape::Mesh(Arc::new(Mesh::new(corners, &triangles, 0.0).unwrap()))
}

pub(crate) fn world(shape: Shape, parts: Vec<StaticShape>, law: Law, preset: Preset) -> RigidWorld {
    RigidWorld::new(RigidWorldDesc {
        bodies: vec![BodySpec::solid(shape, 2500.0, M)],
        parts,
        laws: Laws::uniform(law).unwrap(),
        gravity: DVec3::NEG_Z * G,
        accuracy: Accuracy::preset(preset),
        duration: 1000.0,
        ..RigidWorldDesc::default()
    })
    .unwrap()
}

fn after(world: &RigidWorld, start: Start, time: f64) -> RigidBodyState {
    let mut state = world.state(&[start]).unwrap();
    world.run(&mut state, &mut Scratch::default(), time, &mut ()).unwrap();
    world.at(0, &state.bodies()[0], time)
}

/// What a listener hears: impacts, and when the body first flies.
#[derive(Default)]
struct Told {
    impacts: Vec<f64>,
    flies: Option<RigidBodyState>,
}

impl Observer<RigidWorld> for Told {
    fn impact(&mut self, impact: &Impact) {
        self.impacts.push(impact.time);
    }

    fn motion(&mut self, _: usize, body: &RigidBodyState) {
        if body.phase == Phase::Flight && self.flies.is_none() {
            self.flies = Some(body.clone());
        }
    }
}

/// Angle from the lowest line.
fn angle(x: DVec3) -> f64 {
    math::atan2(x.x, RADIUS - x.z)
}

/// Period of a swing up to an angle on an arm, of a body with k m r² that rolls, or that slides with k = 0.
fn period(amplitude: f64, arm: f64, k: f64) -> f64 {
    4.0 * elliptic(math::sin(0.5 * amplitude)) * ((1.0 + k) * arm / G).sqrt()
}

/// At rest at an angle, on the track.
fn raised(angle: f64) -> Start {
    let (s, c) = math::sin_cos(angle);
    Start::at_rest(DVec3::new(ARM * s, 0.0, RADIUS - ARM * c))
}

/// PHYSICS: a ball in a half pipe passes its lowest line after n + 1/4 periods `4 K √((1 + k) a/g)`, with
/// `v² = 2 g h/(1 + k)`. In the middle of a step, its chord is off by an
/// eighth of the square of its angle; nothing adds up. A radius that is
/// larger by 1 % is told apart.
#[test]
fn a_ball_swings_in_a_half_pipe() {
    for (preset, swings, error) in [
        (Preset::Draft, 30.0, 8e-3),
        (Preset::Standard, 30.0, 3e-3),
        (Preset::Fine, 8.0, 2e-4),
        (Preset::Reference, 2.0, 1e-5),
    ] {
        for seed in 0..4 {
            let mut dice = Dice::new(101, seed);
            let (rolls, amplitude) = (seed % 2 == 0, dice.between(0.2, 1.3));
            let k = if rolls { 0.4 } else { 0.0 };
            let law = Law::new(if rolls { 1.0 } else { 0.0 }, 0.5);
            let time = (swings + 0.25) * period(amplitude, ARM, k);
            let off = |radius: f64| {
                let form = ArcForm { radius, ..FORM };
                let body = after(&world(Shape::Ball(BALL), vec![arc(form)], law, preset), raised(amplitude), time);
                let speed = (2.0 * G * ARM * (1.0 - math::cos(amplitude)) / (1.0 + k)).sqrt();
                (angle(body.path.x) / amplitude).abs().max((body.path.v.length() / speed - 1.0).abs())
            };
            let found = off(RADIUS);
            assert!(found < error, "{preset:?} {rolls} {amplitude}: {found}");
            // It starts above such a track and falls onto it.
            assert!(off(1.01 * RADIUS) > 3.0 * error, "{preset:?} {rolls}");
        }
    }
}

/// PHYSICS: without friction, a ball with `v₀² = f g a` at the bottom leaves a loop where `cos θ = −(f − 2)/3` if f is
/// between 2 and 5. If it rolls, `v² = v₀² − (10/7) g a (1 − cos θ)`, so that is where `cos θ = −(7 f − 10)/17`,
/// between 10/7 and 27/7. On 100 faces it is elsewhere.
#[test]
fn a_slow_ball_leaves_a_loop_where_it_is_pushed_no_more() {
    let form = ArcForm { angles: [-0.6 * PI, 0.9 * PI], ..FORM };
    for (preset, error) in
        [(Preset::Draft, 1e-5), (Preset::Standard, 1e-6), (Preset::Fine, 1e-7), (Preset::Reference, 1e-8)]
    {
        for seed in 0..4 {
            let mut dice = Dice::new(102, seed);
            let rolls = seed % 2 == 0;
            let f = if rolls { dice.between(1.8, 3.6) } else { dice.between(2.3, 4.8) };
            let expected = if rolls { -(7.0 * f - 10.0) / 17.0 } else { -(f - 2.0) / 3.0 };
            let speed = (f * G * ARM).sqrt();
            let spin = if rolls { DVec3::Y * (speed / BALL) } else { DVec3::ZERO };
            let start = Start { velocity: DVec3::X * speed, spin, ..raised(0.0) };
            // Friction that holds until the push is gone.
            let law = Law::new(if rolls { 1e6 } else { 0.0 }, 0.5);
            let leaves = |part: StaticShape, rise: f64| {
                let start = Start { position: start.position + DVec3::Z * rise, ..start };
                let world = world(Shape::Ball(BALL), vec![part], law, preset);
                let (mut state, mut told) = (world.state(&[start]).unwrap(), Told::default());
                world.run(&mut state, &mut Scratch::default(), 0.6, &mut told).unwrap();
                told.flies.map_or(1.0, |body| math::cos(angle(body.path.x)))
            };
            let found = leaves(arc(form), 0.0);
            assert!((found - expected).abs() < error, "{preset:?} {rolls} {f}: {found} for {expected}");
            // The middles of faces are 1e-4 m above the cylinder.
            assert!((leaves(faceted(form, 100), 1.2e-4) - expected).abs() > 100.0 * error, "{preset:?}");
        }
    }
}

fn block(min: DVec3, max: DVec3) -> StaticShape {
    StaticShape::Block { bounds: Aabb { min, max }, material: M, sections: Vec::new() }
}

/// A loop, and the floors that lead to it and away from it: one plane, or two boxes.
fn looped(pitch: f64, is_plane: bool) -> Vec<StaticShape> {
    let form = ArcForm { angles: [-FRAC_PI_2, 1.5 * PI], width: 0.5, pitch, ..FORM };
    if is_plane {
        return vec![arc(form), StaticShape::Plane(Plane::new(DVec3::ZERO, DVec3::Z, M).unwrap())];
    }
    let near = block(DVec3::new(-3.0, -2.0, -0.1), DVec3::new(0.0, 0.5 * pitch, 0.0));
    vec![arc(form), near, block(DVec3::new(0.0, 0.5 * pitch, -0.1), DVec3::new(9.0, 3.0, 0.0))]
}

/// PHYSICS: a ball that slides without friction from a floor into a loop and out of it keeps its velocity. Nothing is
/// told, at the seams neither, and no energy is lost. It passes with more than 5 g a, as all do here; it goes on along
/// the axis at its own speed, so it is where a quadrature has it.
#[test]
fn a_ball_passes_a_loop_without_loss() {
    for preset in Preset::ALL {
        for seed in 0..if preset == Preset::Reference { 2 } else { 8 } {
            let mut dice = Dice::new(103, seed);
            let speed = (dice.between(5.05, 9.0) * G * ARM).sqrt();
            // The time in the loop, by the midpoint rule for a smooth function of period 2π.
            let n = 2000;
            let slow = |k: u32| {
                let turn = 2.0 * PI * (f64::from(k) + 0.5) / f64::from(n);
                ARM / (speed * speed - 2.0 * G * ARM * (1.0 - math::cos(turn))).sqrt()
            };
            let inside = (0..n).map(slow).sum::<f64>() * (2.0 * PI / f64::from(n));
            let pitch = 0.6;
            let aside = pitch / inside * dice.between(0.8, 1.2);
            let from = -dice.between(0.1, 0.5);
            let velocity = DVec3::new(speed, aside, 0.0);
            let start = Start { velocity, ..Start::at_rest(DVec3::new(from, aside * from / speed, BALL)) };
            for is_plane in [true, false] {
                let world = world(Shape::Ball(BALL), looped(pitch, is_plane), Law::new(0.0, 0.7), preset);
                let (mut state, mut told) = (world.state(&[start]).unwrap(), Told::default());
                let time = -from / speed + inside + 0.1;
                world.run(&mut state, &mut Scratch::default(), time, &mut told).unwrap();
                let body = world.at(0, &state.bodies()[0], time);
                let expected = DVec3::new(0.1 * speed, aside * (inside + 0.1), BALL);
                let (off, lost) = (body.path.x - expected, body.path.v - velocity);
                assert!(
                    told.impacts.is_empty(),
                    "{preset:?} {seed} {is_plane}: {:?} {} {inside}",
                    told.impacts,
                    -from / speed
                );
                assert!(lost.length() < 1e-4 * speed, "{preset:?} {seed} {is_plane}: {lost}");
                let energy = 0.5 * body.path.v.length_squared() + G * (body.path.x.z - BALL);
                let kept = 0.5 * velocity.length_squared();
                assert!((energy / kept - 1.0).abs() < 1e-9, "{preset:?} {seed} {is_plane}: {}", energy / kept - 1.0);
                assert!(off.length() < 2e-3 * BALL, "{preset:?} {seed} {is_plane}: {off}");
            }
        }
    }
}

/// A ball that rolls straight into a loop with walls is led to its exit by them, and comes out beside where it went in,
/// with most of its energy: the walls rub. On a loop without walls it leaves the track.
#[test]
fn walls_lead_a_rolling_ball_through_a_loop() {
    for preset in [Preset::Draft, Preset::Standard, Preset::Fine] {
        for seed in 0..3 {
            let mut dice = Dice::new(110, seed);
            let speed = (dice.between(5.5, 9.0) * G * ARM).sqrt();
            let velocity = DVec3::X * speed;
            let at = DVec3::new(-0.2, 0.0, BALL);
            let start = Start { velocity, spin: DVec3::Y * (speed / BALL), ..Start::at_rest(at) };
            let passes = |walls: f64| {
                let form = ArcForm { angles: [-FRAC_PI_2, 1.5 * PI], width: 0.03, pitch: 0.06, walls, ..FORM };
                let floor = StaticShape::Plane(Plane::new(DVec3::ZERO, DVec3::Z, M).unwrap());
                let world = world(Shape::Ball(BALL), vec![arc(form), floor], Law::new(0.1, 0.3), preset);
                let body = after(&world, start, 1.5);
                let (x, v) = (body.path.x, body.path.v);
                x.x > 0.3 && (x.y - 0.06).abs() < 0.3 && x.z < 1.1 * BALL && v.x > 0.5 * speed
            };
            assert!(passes(0.01), "{preset:?} {seed}");
            assert!(!passes(0.0), "{preset:?} {seed}");
        }
    }
}

/// The motion of a ball that rolls in a cylinder about y, by the Runge–Kutta method for its angle, its place along the
/// axis, their rates and its spin about the normal. With the normal's rate φ′, rolling without slipping leaves
/// `φ″ = −g sin φ/((1 + k) a)`, `(1 + k) y″ = −k r φ′ w`, `r w′ = φ′ y′`.
fn rolled(rates: [f64; 2], time: f64) -> [f64; 2] {
    let k = 0.4;
    let slope = |s: [f64; 5]| {
        let [angle, _, turns, along, spin] = s;
        let falls = -G * math::sin(angle) / ((1.0 + k) * ARM);
        [turns, along, falls, -k * BALL * turns * spin / (1.0 + k), turns * along / BALL]
    };
    let steps = 20_000;
    let h = time / f64::from(steps);
    let mut s = [0.0, 0.0, rates[0], rates[1], 0.0];
    for _ in 0..steps {
        let add = |s: [f64; 5], k: [f64; 5], h: f64| std::array::from_fn(|i| s[i] + h * k[i]);
        let a = slope(s);
        let b = slope(add(s, a, 0.5 * h));
        let c = slope(add(s, b, 0.5 * h));
        let d = slope(add(s, c, h));
        s = std::array::from_fn(|i| s[i] + h / 6.0 * (a[i] + 2.0 * (b[i] + c[i]) + d[i]));
    }
    [s[0], s[1]]
}

/// PHYSICS: a ball that rolls through a loop aslant is turned back along the axis by its spin. Compared with another
/// integrator of other equations; without the coupling to the spin, it is elsewhere.
#[test]
fn a_rolling_ball_goes_aslant_as_another_integrator_has_it() {
    let form = ArcForm { angles: [-FRAC_PI_2, 1.5 * PI], width: 0.5, pitch: 0.1, ..FORM };
    for (preset, error) in
        [(Preset::Draft, 5e-4), (Preset::Standard, 1e-4), (Preset::Fine, 1e-5), (Preset::Reference, 1e-6)]
    {
        for seed in 0..3 {
            let mut dice = Dice::new(104, seed);
            let speed = (dice.between(4.0, 7.0) * G * ARM).sqrt();
            let (aside, time) = (dice.between(0.1, 0.4), dice.between(0.1, 0.3));
            let velocity = DVec3::new(speed, aside, 0.0);
            let start = Start { velocity, spin: DVec3::Z.cross(velocity) / BALL, ..raised(0.0) };
            let world = world(Shape::Ball(BALL), vec![arc(form)], Law::new(1e6, 0.5), preset);
            let body = after(&world, start, time);
            let [turned, along] = rolled([speed / ARM, aside], time);
            let (s, c) = math::sin_cos(turned);
            let expected = DVec3::new(ARM * s, along, RADIUS - ARM * c);
            let off = (body.path.x - expected).length() / ARM;
            assert!(off < error, "{preset:?} {seed}: {off} at {turned}");
            assert!((aside * time - along).abs() > 10.0 * error * ARM, "{preset:?} {seed}: no coupling");
        }
    }
}

/// PHYSICS: a cylinder that lies along a half pipe rolls like a ball with ½ m r². Steps are of second order. As a ball,
/// with 2/5 m r², it would be elsewhere.
#[test]
fn a_lying_cylinder_rolls_in_a_half_pipe() {
    let shape = Shape::from(Frustum::cylinder(BALL, 0.05).unwrap());
    for (preset, error) in
        [(Preset::Draft, 2e-2), (Preset::Standard, 1e-2), (Preset::Fine, 1.5e-3), (Preset::Reference, 1e-4)]
    {
        for seed in 0..2 {
            let amplitude = Dice::new(105, seed).between(0.2, 1.0);
            let start = Start { orientation: DQuat::from_rotation_x(FRAC_PI_2), ..raised(amplitude) };
            let world = world(shape.clone(), vec![arc(FORM)], Law::new(5.0, 0.5), preset);
            let off = |k: f64| {
                let body = after(&world, start, 1.25 * period(amplitude, ARM, k));
                (angle(body.path.x) / amplitude).abs()
            };
            assert!(off(0.5) < error, "{preset:?} {amplitude}: {}", off(0.5));
            assert!(off(0.4) > 3.0 * error, "{preset:?} {amplitude}: {}", off(0.4));
        }
    }
}

/// PHYSICS: a box of length 2 l on two edges at ±β from its middle, `R sin β = l`, whose centre is at d from the axis,
/// is held by friction up to `tan θ = µ R/(d cos β (1 + µ²) − µ² R)`: forces and torque on both edges at their limits.
/// As β goes to 0 that is µ. At the bottom it stays.
#[test]
fn friction_holds_a_box_up_to_its_cone() {
    let mut rests = 0;
    for preset in Preset::ALL {
        for seed in 0..if preset == Preset::Reference { 3 } else { 10 } {
            let mut dice = Dice::new(106, seed);
            let (friction, half) = (dice.between(0.1, 0.5), DVec3::new(0.02, 0.015, 0.01) * dice.between(0.5, 1.2));
            let flank = (RADIUS * RADIUS - half.x * half.x).sqrt();
            let (arm, cosine) = (flank - half.z, flank / RADIUS);
            let square = friction * friction;
            let steepest = math::atan(friction * RADIUS / (arm * cosine * (1.0 + square) - square * RADIUS));
            let shape = Shape::Cuboid(Cuboid::new(half * 2.0, 0.0).unwrap());
            let world = world(shape, vec![arc(FORM)], Law::new(friction, 0.3), preset);
            for (part, stays) in [(0.0, true), (0.97, true), (1.03, false)] {
                let (s, c) = math::sin_cos(part * steepest);
                let start = Start {
                    orientation: DQuat::from_rotation_y(-part * steepest),
                    ..Start::at_rest(DVec3::new(arm * s, 0.0, RADIUS - arm * c))
                };
                let mut state = world.state(&[start]).unwrap();
                let outcome = world.run(&mut state, &mut Scratch::default(), 0.3, &mut ()).unwrap();
                let moved = (state.bodies()[0].path.x - start.position).length();
                assert_eq!(outcome == Outcome::AllAtRest && moved < 1e-3 * half.z, stays, "{preset:?} {seed} {part}");
                rests += usize::from(stays);
            }
        }
    }
    assert!(rests > 0);
}

/// A world that is turned and moved, gravity and all, has the same motion.
#[test]
fn a_turned_world_has_the_same_motion() {
    for preset in [Preset::Draft, Preset::Standard, Preset::Fine] {
        for seed in 0..6 {
            let mut dice = Dice::new(109, seed);
            let (turn, shift) = (dice.turn(), dice.in_cube());
            let speed = (dice.between(5.5, 7.0) * G * ARM).sqrt();
            let k = if seed % 2 == 0 { 1.0 } else { 0.0 };
            let velocity = DVec3::new(speed, dice.between(-0.2, 0.2), 0.0);
            let start = Start { velocity, spin: DVec3::Z.cross(velocity) * (k / BALL), ..raised(0.0) };
            let form = ArcForm { angles: [-FRAC_PI_2, 1.5 * PI], width: 0.5, pitch: 0.1, ..FORM };
            let ends = |turn: DQuat, shift: DVec3| {
                let track = ArcTrack::new(form, shift + turn * (DVec3::Z * RADIUS), turn, M).unwrap();
                let world = RigidWorld::new(RigidWorldDesc {
                    bodies: vec![BodySpec::solid(Shape::Ball(BALL), 2500.0, M)],
                    parts: vec![StaticShape::Arc(Arc::new(track))],
                    laws: Laws::uniform(Law::new(3.0 * k, 0.5)).unwrap(),
                    gravity: turn * (DVec3::NEG_Z * G),
                    accuracy: Accuracy::preset(preset),
                    ..RigidWorldDesc::default()
                })
                .unwrap();
                let start = Start {
                    position: shift + turn * start.position,
                    orientation: turn,
                    velocity: turn * start.velocity,
                    spin: turn * start.spin,
                    ..start
                };
                turn.conjugate() * (after(&world, start, 0.35).path.x - shift)
            };
            let off = (ends(turn, shift) - ends(DQuat::IDENTITY, DVec3::ZERO)).length();
            // Rounding of places a metre away, and of the times of steps.
            assert!(off < 1e-9, "{preset:?} {seed}: {off}");
        }
    }
}

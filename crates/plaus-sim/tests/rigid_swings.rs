//! Newton's cradle and the seesaw: joints and contacts together, compared with what mechanics says of them.

use crate::common::{G, M};
use crate::rigid_joints::{cuboid, elliptic};
use glam::{DQuat, DVec3};
use plaus_dist::math;
use plaus_sim::rigid::{BodySpec, Joint, RigidBodyState, RigidWorld, RigidWorldDesc, Start};
use plaus_sim::shape::Shape;
use plaus_sim::{Accuracy, Law, Laws, Preset, Scratch, State};

const BALLS: usize = 5;
const RADIUS: f64 = 0.015;
const STRING: f64 = 0.15;
/// Between two balls that hang.
const GAP: f64 = 1e-5;

/// A ball of the cradle, raised by an angle towards −x.
fn raised(ball: usize, angle: f64) -> Start {
    let hinge = DVec3::X * (ball as f64 * (2.0 * RADIUS + GAP));
    let turn = DQuat::from_rotation_y(angle);
    Start { orientation: turn, ..Start::at_rest(hinge + turn * (DVec3::NEG_Z * STRING)) }
}

fn angle(body: &RigidBodyState) -> f64 {
    let down = body.turn * DVec3::NEG_Z;
    math::atan2(-down.x, -down.z)
}

/// A cradle of which the first `lifted` balls begin raised.
fn cradle(lifted: usize, from: f64, restitution: f64, preset: Preset) -> (RigidWorld, State<RigidBodyState>) {
    let spec = BodySpec::solid(Shape::Ball(RADIUS), 7800.0, M);
    let mut world = RigidWorld::new(RigidWorldDesc {
        bodies: vec![spec; BALLS],
        parts: Vec::new(),
        laws: Laws::uniform(Law::new(0.0, restitution)).unwrap(),
        gravity: DVec3::NEG_Z * G,
        accuracy: Accuracy::preset(preset),
        skin: 1.0,
        sink: f64::NEG_INFINITY,
        duration: 100.0,
    })
    .unwrap();
    for k in 0..BALLS {
        let start = raised(k, 0.0);
        world.join(Joint::hinge(start.position + DVec3::Z * STRING, DVec3::Y, k, &start)).unwrap();
    }
    let starts: Vec<Start> = (0..BALLS).map(|k| raised(k, if k < lifted { from } else { 0.0 })).collect();
    let state = world.state(&starts).unwrap();
    (world, state)
}

/// The angles of a cradle's balls after a time.
fn swung(lifted: usize, from: f64, restitution: f64, preset: Preset, time: f64) -> [f64; BALLS] {
    let (world, mut state) = cradle(lifted, from, restitution, preset);
    world.run(&mut state, &mut Scratch::default(), time, &mut ()).unwrap();
    std::array::from_fn(|k| angle(&world.at(k, &state.bodies()[k], time)))
}

/// Half a period after they are let go, as many balls as were raised are as high on the other side, and the others hang
/// still; so they are again, on their own side, after a whole period. The period is that of a ball about its hinge, by
/// the elliptic integral. With a restitution of 0.9 it is not so.
#[test]
fn as_many_balls_leave_a_cradle_as_come() {
    let inertia = 0.4 * RADIUS * RADIUS + STRING * STRING;
    for (lifted, from) in [(1, 0.6), (2, 0.4), (3, 0.3)] {
        let period = 4.0 * elliptic(math::sin(0.5 * from)) * (inertia / (G * STRING)).sqrt();
        let mut errors = Vec::new();
        for preset in [Preset::Standard, Preset::Fine] {
            let mut worst = 0.0_f64;
            for half in [1, 2] {
                let found = swung(lifted, from, 1.0, preset, 0.5 * f64::from(half) * period);
                for (k, angle) in found.into_iter().enumerate() {
                    let moves = if half == 1 { k >= BALLS - lifted } else { k < lifted };
                    let expected = if moves { from * if half == 1 { -1.0 } else { 1.0 } } else { 0.0 };
                    worst = worst.max((angle - expected).abs());
                }
            }
            errors.push(worst);
        }
        // Balls hang `GAP` apart, so each is struck that much before its lowest point; a step's error of the period is
        // forgiven at the turning point, where an angle is square in time.
        assert!(errors[0] < 0.02 && errors[1] < 0.005, "{lifted} raised: {errors:?}");
        let dull = swung(lifted, from, 0.9, Preset::Standard, 0.5 * period);
        assert!(dull[BALLS - 1] > -from + 0.02, "{dull:?}");
    }
}

/// Without friction or loss, a cradle has the same energy after ten seconds, 25 clicks, to a millionth of what it began
/// with; at every preset, because steps end at the clicks. A twin that loses a ten-thousandth of a speed is caught.
#[test]
fn a_cradle_keeps_its_energy() {
    let from = 0.5;
    let lost = |lifted: usize, restitution: f64, preset: Preset, until: f64| {
        let (world, mut state) = cradle(lifted, from, restitution, preset);
        let energy = |state: &State<RigidBodyState>| -> f64 {
            state.bodies().iter().enumerate().map(|(k, b)| world.energy(k, b)).sum()
        };
        let first = energy(&state);
        let raised = lifted as f64 * Shape::Ball(RADIUS).mass_properties(7800.0).mass * G * STRING;
        world.run(&mut state, &mut Scratch::default(), until, &mut ()).unwrap();
        (first - energy(&state)) / (raised * (1.0 - math::cos(from)))
    };
    for (lifted, preset, until) in [(1, Preset::Draft, 10.0), (2, Preset::Standard, 10.0), (1, Preset::Fine, 2.0)] {
        let part = lost(lifted, 1.0, preset, until);
        assert!(part.abs() < 1e-6, "{lifted} raised, {preset:?}: {part}");
    }
    let twin = lost(1, 0.9999, Preset::Standard, 10.0);
    assert!(twin > 1e-5, "{twin}");
}

/// A level plank on a hinge with a weight on either side, which friction holds: it turns as one body about the hinge,
/// `I φ″ = g Σ m x`. The truth is that equation in 10,000 steps of fourth order. A twin whose weights are in the
/// plank's own plane is told apart.
#[test]
fn a_seesaw_tips_as_one_body() {
    let (plank, near, far) = (cuboid(0.4, 0.06, 0.01), cuboid(0.03, 0.03, 0.02), cuboid(0.03, 0.03, 0.03));
    let lies = |x: f64, height: f64| DVec3::new(x, 0.0, 0.005 + 0.5 * height);
    let at = [DVec3::ZERO, lies(-0.12, 0.02), lies(0.15, 0.03)];
    let shapes = [plank, near, far];
    let masses = shapes.each_ref().map(|s| s.mass_properties(1000.0));
    // A rotation by φ about y takes x to x cos φ + z sin φ: weights to the right turn it by positive φ.
    let truth = |at: [DVec3; 3], time: f64| {
        let inertia: f64 = (0..3).map(|k| masses[k].inertia.y + masses[k].mass * at[k].length_squared()).sum();
        let pull = |phi: f64| -> f64 {
            let (s, c) = math::sin_cos(phi);
            (0..3).map(|k| masses[k].mass * G * (at[k].x * c + at[k].z * s)).sum::<f64>() / inertia
        };
        let (mut phi, mut rate, n) = (0.0, 0.0, 10_000);
        let h = time / f64::from(n);
        for _ in 0..n {
            let [a, b, c] =
                [pull(phi), pull(phi + 0.5 * h * rate), pull(phi + 0.5 * h * rate + 0.25 * h * h * pull(phi))];
            let d = pull(phi + h * rate + 0.5 * h * h * b);
            phi += h * rate + h * h / 6.0 * (a + b + c);
            rate += h / 6.0 * (a + 2.0 * b + 2.0 * c + d);
        }
        phi
    };
    let time = 0.3;
    let (exact, twin) = (truth(at, time), truth(at.map(|at| at.with_z(0.0)), time));
    assert!(exact > 0.1 && (exact - twin).abs() > 2e-3, "{exact} {twin}");
    let mut errors = Vec::new();
    for preset in [Preset::Draft, Preset::Standard, Preset::Fine] {
        let mut world = RigidWorld::new(RigidWorldDesc {
            bodies: shapes.iter().map(|s| BodySpec::solid(s.clone(), 1000.0, M)).collect(),
            parts: Vec::new(),
            laws: Laws::uniform(Law::new(2.0, 0.0)).unwrap(),
            gravity: DVec3::NEG_Z * G,
            accuracy: Accuracy::preset(preset),
            skin: 1.0,
            sink: f64::NEG_INFINITY,
            duration: 10.0,
        })
        .unwrap();
        let starts = at.map(Start::at_rest);
        world.join(Joint::hinge(DVec3::ZERO, DVec3::Y, 0, &starts[0])).unwrap();
        let mut state = world.state(&starts).unwrap();
        world.run(&mut state, &mut Scratch::default(), time, &mut ()).unwrap();
        let turned = world.at(0, &state.bodies()[0], time).turn * DVec3::X;
        errors.push((math::atan2(-turned.z, turned.x) - exact).abs());
    }
    assert!(errors[1] < 1e-3 && errors[2] < 1e-4, "{exact}: {errors:?}");
}

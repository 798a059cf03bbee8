//! Motors of hinges and sliders, and joints that break.

use crate::common::G;
use crate::rigid_axes::{Numbers, after};
use crate::rigid_joints::{cuboid, step, world};
use glam::{DQuat, DVec3};
use plaus_dist::math;
use plaus_sim::rigid::{Interpolation, Joint, Key, Motor, MotorGoal, Start, Track};
use plaus_sim::shape::Shape;
use plaus_sim::{Preset, Scratch};
use std::f64::consts::TAU;

/// A block on a random slider, or on a hinge through its middle, that nothing else acts along, with a motor.
fn driven(numbers: &mut Numbers, slides: bool, motor: impl Fn(f64) -> Motor, preset: Preset, time: f64) -> (f64, f64) {
    let shape = cuboid(0.1, 0.12, 0.14);
    let mass = shape.mass_properties(1000.0);
    let axis = (numbers.vector() * DVec3::new(1.0, 1.0, 0.0)).normalize();
    let orientation = DQuat::from_rotation_arc(DVec3::Z, axis);
    let start = Start { orientation, ..Start::at_rest(DVec3::Y) };
    let (joint, inert) = if slides {
        (Joint::slider(numbers.vector() * 0.2, axis, 0, &start), mass.mass)
    } else {
        (Joint::hinge(DVec3::Y + axis * 0.3, axis, 0, &start), mass.inertia.z)
    };
    let mut world = world(&[shape], G, preset);
    let joint = world.join(joint).unwrap();
    world.power(joint, &motor(inert)).unwrap();
    let found = &after(&world, &[start], time).1[0];
    let turned = found.turn * start.orientation.conjugate();
    if slides {
        ((found.path.x - start.position).dot(axis), found.path.v.dot(axis))
    } else {
        let angle = 2.0 * math::atan2(DVec3::new(turned.x, turned.y, turned.z).dot(axis), turned.w);
        (angle, found.spin.dot(axis))
    }
}

/// The difference of two angles, within half a turn.
fn between(a: f64, b: f64) -> f64 {
    (a - b) - TAU * ((a - b) / TAU).round()
}

/// A motor brings what it moves to its speed by its greatest force, and then holds it: the speed is `F t/m` and then as
/// said, to what the solver leaves; the step in which it is reached is straight. A twin with a tenth more force is told
/// apart while it gathers speed.
#[test]
fn a_motor_holds_its_speed() {
    for seed in 0..16 {
        let slides = seed % 2 == 0;
        let numbers = &mut Numbers(seed + 500);
        let speed = numbers.between(-4.0, 4.0);
        let (a, time) = (numbers.between(3.0, 20.0), 0.6);
        let run = |a: f64| {
            let motor = |inert: f64| Motor { goal: MotorGoal::Speed(speed), most: inert * a };
            driven(&mut Numbers(seed + 900), slides, motor, Preset::Standard, time)
        };
        let reached = (speed.abs() / a).min(time);
        let (exact, end) =
            (speed.signum() * 0.5 * a * reached * reached + speed * (time - reached), speed.signum() * a * reached);
        let h = step(0.05, Preset::Standard);
        let (q, rate) = run(a);
        assert!((rate - end).abs() < 1e-7, "{seed}: {rate} for {end}");
        assert!(between(q, exact).abs() < a * h * h, "{seed}: {q} for {exact}");
        let twin = run(1.1 * a).0;
        assert!(reached < 0.1 || between(twin, exact).abs() > 2.0 * a * h * h, "{seed}: {twin} {exact}");
    }
}

/// A motor that follows keys is where they say, between them too, as long as its force allows it, here for cubics; one
/// that begins behind catches up exponentially. One that is too weak is behind, and never overtakes.
#[test]
fn a_motor_follows_keys() {
    for seed in 0..16 {
        let slides = seed % 2 == 0;
        let numbers = &mut Numbers(seed + 640);
        let (high, catch_up, first) = (numbers.between(0.2, 0.6), 0.05, if seed % 4 < 2 { 0.0 } else { 0.02 });
        let key = |time: f64, value: f64| Key { time, value, slopes: [0.0; 2] };
        let keys = vec![key(0.0, first), key(0.3, first + high), key(0.8, first - high)];
        let track = Track { between: Interpolation::Cubic, keys };
        let at = |t: f64| {
            let (from, rise, part) =
                if t < 0.3 { (first, high, t / 0.3) } else { (first + high, -2.0 * high, ((t - 0.3) / 0.5).min(1.0)) };
            from + rise * part * part * (3.0 - 2.0 * part)
        };
        for time in [0.1, 0.3, 0.55, 0.8, 1.0] {
            let run = |a: f64| {
                let goal = MotorGoal::Keys { track: track.clone(), catch_up };
                let motor = |inert: f64| Motor { goal: goal.clone(), most: inert * a };
                driven(&mut Numbers(seed + 900), slides, motor, Preset::Standard, time).0
            };
            let exact = at(time) - first * math::exp(-time / catch_up);
            // Within a step, places are on chords of a curve that bends by 6 high/0.3² at most.
            let h = step(0.05, Preset::Standard);
            let bound = 6.0 * high / 0.09 * h * h + first / (catch_up * catch_up) * h * h;
            let strong = run(1e4);
            assert!((strong - exact).abs() < bound, "{seed} {time}: {strong} for {exact}, {bound}");
            let weak = run(1.0);
            assert!(time > 0.3 || weak <= 0.5 * time * time + 1e-6, "{seed} {time}: {weak}");
            assert!(time != 0.3 || (weak - exact).abs() > 10.0 * bound, "{seed} {time}: {weak}");
        }
    }
}

/// A ball strikes what a hinge, a slider or a ball joint holds to the world: the joint takes an impulse that follows
/// from conservation, and breaks if it bears less. What was held then moves freely.
#[test]
fn hinges_sliders_and_ball_joints_break() {
    let (r, speed) = (0.05, 2.0);
    let ball = Shape::Ball(r);
    let mass = ball.mass_properties(1000.0).mass;
    // Both balls are alike. On a slider across the shot, or a joint at the centre, the struck one is a wall: 2 m v. On
    // a hinge in the plane of its centre, it turns about a point a diameter above, with 1.1 m of inertia at that arm.
    let inertia = 0.4 * mass * r * r + mass * 4.0 * r * r;
    let effective = inertia / (4.0 * r * r);
    let passed = 2.0 * mass * effective / (mass + effective) * speed;
    let of_hinge = passed * (mass / effective - 1.0).abs();
    for (kind, impulse) in [(0, 2.0 * mass * speed), (1, 2.0 * mass * speed), (2, of_hinge), (3, of_hinge)] {
        for (part, breaks) in [(1.0 + 1e-6, false), (1.0 - 1e-6, true)] {
            let mut world = world(&[ball.clone(), ball.clone()], 0.0, Preset::Standard);
            let held = Start::at_rest(DVec3::ZERO);
            let shot = Start { velocity: DVec3::X * speed, ..Start::at_rest(DVec3::X * -0.5) };
            let joint = match kind {
                0 => Joint::slider(DVec3::Y * 0.3, DVec3::Z, 0, &held),
                1 => Joint::ball(DVec3::ZERO, 0, &held),
                2 => Joint::hinge(DVec3::Z * (2.0 * r), DVec3::Y, 0, &held),
                _ => Joint::ball(DVec3::Z * (2.0 * r), 0, &held),
            };
            let joint = world.join(joint.that_breaks_at(part * impulse)).unwrap();
            let mut state = world.state(&[held, shot]).unwrap();
            world.run(&mut state, &mut Scratch::default(), 0.25, &mut ()).unwrap();
            assert_eq!(world.is_held(joint, &state), !breaks, "{kind} {part}");
        }
    }
}

/// A slider that runs into its limit breaks there if it bears less than what stops it, `(1 + e) m v`.
#[test]
fn a_slider_breaks_at_its_limit() {
    let (shape, speed) = (cuboid(0.1, 0.1, 0.1), 1.5);
    let mass = shape.mass_properties(1000.0).mass;
    for (part, breaks) in [(1.001, false), (0.999, true)] {
        let mut world = world(std::slice::from_ref(&shape), 0.0, Preset::Standard);
        let start = Start { velocity: DVec3::X * speed, ..Start::at_rest(DVec3::ZERO) };
        let joint = Joint::slider(DVec3::ZERO, DVec3::X, 0, &start).with_limits([-1.0, 0.2], 0.5);
        world.join(joint.that_breaks_at(1.5 * part * mass * speed)).unwrap();
        let mut state = world.state(&[start]).unwrap();
        world.run(&mut state, &mut Scratch::default(), 0.4, &mut ()).unwrap();
        assert_eq!(world.is_held(0, &state), !breaks, "{part}");
    }
}

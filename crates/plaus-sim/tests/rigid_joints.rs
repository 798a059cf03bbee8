//! Joints compared with closed forms and an independent integrator.

use crate::common::{G, M};
use glam::{DQuat, DVec3};
use plaus_dist::math;
use plaus_sim::rigid::{BodySpec, Joint, RigidBodyState, RigidWorld, RigidWorldDesc, Start};
use plaus_sim::shape::{Cuboid, Shape};
use plaus_sim::trace::Trace;
use plaus_sim::{Accuracy, Law, Laws, Outcome, Preset, Scratch, State};
use std::f64::consts::PI;

pub(crate) fn cuboid(x: f64, y: f64, z: f64) -> Shape {
    Shape::Cuboid(Cuboid::new(DVec3::new(x, y, z), 0.0).unwrap())
}

/// Bodies with no surroundings, which rebound without loss or friction if they meet.
pub(crate) fn world(shapes: &[Shape], gravity: f64, preset: Preset) -> RigidWorld {
    RigidWorld::new(RigidWorldDesc {
        bodies: shapes.iter().map(|s| BodySpec::solid(s.clone(), 1000.0, M)).collect(),
        parts: Vec::new(),
        laws: Laws::uniform(Law::new(0.0, 1.0)).unwrap(),
        gravity: DVec3::NEG_Z * gravity,
        accuracy: Accuracy { events: 10_000_000, ..Accuracy::preset(preset) },
        skin: 1.0,
        sink: f64::NEG_INFINITY,
        duration: 1e3,
    })
    .unwrap()
}

/// The motions of all bodies until a time.
fn trace(world: &RigidWorld, starts: &[Start], until: f64) -> Trace<RigidBodyState> {
    let (mut state, mut trace) = (world.state(starts).unwrap(), Trace::default());
    world.run(&mut state, &mut Scratch::default(), until, &mut trace).unwrap();
    trace
}

/// A point of a body, given in its own axes, in the axes of the world.
pub(crate) fn point(body: &RigidBodyState, own: DVec3) -> DVec3 {
    body.path.x + body.turn * own
}

/// A rod on a hinge, held at an angle from hanging down: the world, its start, and `√(m g l / I)` about the hinge.
fn rod(angle: f64, preset: Preset) -> (RigidWorld, Start, f64) {
    let shape = cuboid(0.06, 0.1, 0.5);
    let turn = DQuat::from_rotation_y(-angle);
    let arm = 0.2;
    let start = Start { orientation: turn, ..Start::at_rest(turn * (DVec3::NEG_Z * arm)) };
    let mass = shape.mass_properties(1000.0);
    let rate = (mass.mass * G * arm / (mass.inertia.y + mass.mass * arm * arm)).sqrt();
    let mut world = world(&[shape], G, preset);
    world.join(Joint::hinge(DVec3::ZERO, DVec3::Y, 0, &start)).unwrap();
    (world, start, rate)
}

/// Complete elliptic integral of the first kind, by the arithmetic-geometric mean.
pub(crate) fn elliptic(k: f64) -> f64 {
    let (mut a, mut b) = (1.0, (1.0 - k * k).sqrt());
    for _ in 0..60 {
        (a, b) = (0.5 * (a + b), (a * b).sqrt());
    }
    PI / (a + b)
}

/// Times at which the rod hangs straight down, by cubics between the ends of steps.
fn crossings(motions: &[RigidBodyState]) -> Vec<f64> {
    let mut times = Vec::new();
    for pair in motions.windows(2) {
        let [a, b] = [&pair[0], &pair[1]];
        let (x, y, h) = (a.path.x.x, b.path.x.x, b.path.t - a.path.t);
        if x * y >= 0.0 {
            continue;
        }
        let [v, w] = [a, b].map(|m| (m.spin.cross(m.path.x)).x * h);
        let at = |s: f64| {
            let (s2, s3) = (s * s, s * s * s);
            (2.0 * s3 - 3.0 * s2 + 1.0) * x + (s3 - 2.0 * s2 + s) * v + (3.0 * s2 - 2.0 * s3) * y + (s3 - s2) * w
        };
        let (mut low, mut high) = (0.0, 1.0);
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if at(middle) * x > 0.0 { low = middle } else { high = middle }
        }
        times.push(a.path.t + low * h);
    }
    times
}

/// Length of a step with joints for a body of this size, from `accuracy.step` and the simulator's `JOINT_STEP_LENGTH`.
pub(crate) fn step(size: f64, preset: Preset) -> f64 {
    0.25 * Accuracy::preset(preset).step * (size / G).sqrt()
}

/// The period is off by no more than what steps on joints may err in a second (`JOINT_STEP_ERROR` of the simulator,
/// over the half thickness and the fourth power of the preset's step) puts the rod ahead or behind at its speed. Times
/// are read by cubics, which are off by no more than the searches' path (`ARTICULATED_PATH_ERROR`), once at either end;
/// rounding is 1e-9.
#[test]
fn a_pendulum_has_the_elliptic_period() {
    for angle in [0.2, 1.0, 2.0, 3.0] {
        for preset in Preset::ALL {
            let (world, start, rate) = rod(angle, preset);
            let period = 4.0 * elliptic(math::sin(0.5 * angle)) / rate;
            let until = if preset == Preset::Reference { 1.3 } else { 5.3 } * period;
            let times = crossings(&trace(&world, &[start], until).motions[0]);
            let n = times.len() - 1;
            let measured = 2.0 * (times[n] - times[0]) / n as f64;
            let (s, speed) = (Accuracy::preset(preset).step, 0.2 * angle.min(1.0) * rate);
            let allowed = 0.03 * (0.04 * s * s * s * s + 2.0 * 9e-3 * s * s * s / (times[n] - times[0])) / speed;
            let off = (measured / period - 1.0).abs();
            assert!(n >= 2 && off < allowed + 1e-9, "{angle} {}: {off:e} of {allowed:e}", preset.name());
            // Twins: a swing of no height, and a mass in one point.
            let small = (measured * rate / (2.0 * PI) - 1.0).abs();
            let thin = (measured / (period * rate / (G / 0.2).sqrt()) - 1.0).abs();
            assert!(small > 1.5e-3 && thin > 0.1, "{small} {thin}");
        }
    }
}

/// Two rods on hinges in a plane, by their angles from hanging down: each is `[angle, rate]`, as in Lagrange's
/// equations. `l` is the distance from hinge to hinge, `c` from each hinge to the centre of gravity.
struct Double {
    mass: [f64; 2],
    inertia: [f64; 2],
    l: f64,
    c: [f64; 2],
}

impl Double {
    fn slope(&self, [p, q, u, w]: [f64; 4]) -> [f64; 4] {
        let Self { mass: [m, n], inertia: [i, j], l, c: [c, d] } = *self;
        let (s, k) = math::sin_cos(p - q);
        let (a, b, e) = (i + m * c * c + n * l * l, n * l * d * k, j + n * d * d);
        let f = -(m * c + n * l) * G * math::sin(p) - n * l * d * s * w * w;
        let g = -n * d * G * math::sin(q) + n * l * d * s * u * u;
        let det = a * e - b * b;
        [u, w, (f * e - g * b) / det, (g * a - f * b) / det]
    }

    /// The state after a time, by the Runge–Kutta method of fourth order in this many steps.
    fn after(&self, mut y: [f64; 4], time: f64, steps: u32) -> [f64; 4] {
        let h = time / f64::from(steps);
        let plus = |y: [f64; 4], k: [f64; 4], h: f64| std::array::from_fn(|i| y[i] + k[i] * h);
        for _ in 0..steps {
            let a = self.slope(y);
            let b = self.slope(plus(y, a, 0.5 * h));
            let c = self.slope(plus(y, b, 0.5 * h));
            let d = self.slope(plus(y, c, h));
            y = std::array::from_fn(|i| y[i] + (a[i] + 2.0 * (b[i] + c[i]) + d[i]) * (h / 6.0));
        }
        y
    }
}

/// The two rods, hanging from the origin, turned by these angles.
fn double(angles: [f64; 2], preset: Preset) -> (RigidWorld, [Start; 2], Double) {
    let shapes = [cuboid(0.06, 0.1, 0.5), cuboid(0.05, 0.06, 0.4)];
    let (l, c) = (0.42, [0.2, 0.17]);
    let turns = angles.map(|a| DQuat::from_rotation_y(-a));
    let elbow = turns[0] * (DVec3::NEG_Z * l);
    let at = [turns[0] * (DVec3::NEG_Z * c[0]), elbow + turns[1] * (DVec3::NEG_Z * c[1])];
    let starts = [0, 1].map(|k| Start { orientation: turns[k], ..Start::at_rest(at[k]) });
    let mut world = world(&shapes, G, preset);
    world.join(Joint::hinge(DVec3::ZERO, DVec3::Y, 0, &starts[0])).unwrap();
    world.join(Joint::hinge(elbow, DVec3::Y, 0, &starts[0]).to(1, &starts[1])).unwrap();
    let masses = shapes.map(|s| s.mass_properties(1000.0));
    let truth = Double { mass: masses.map(|m| m.mass), inertia: masses.map(|m| m.inertia.y), l, c };
    (world, starts, truth)
}

/// Angles from hanging down, of bodies at the end of their last step.
fn angles(motions: &Trace<RigidBodyState>) -> [f64; 2] {
    [0, 1].map(|k| {
        let down = motions.motions[k][motions.motions[k].len() - 1].turn * DVec3::NEG_Z;
        math::atan2(down.x, -down.z)
    })
}

/// A double pendulum compared with Lagrange's equations, solved to 1e-11 (checked by halving their steps): at the ends
/// of steps, the error falls as the fourth power of the step.
#[test]
fn a_double_pendulum_agrees_with_lagrange() {
    for start in [[0.4, -0.3], [1.2, 0.5], [1.5, 2.0]] {
        let mut errors = Vec::new();
        let time = 1.2;
        for preset in Preset::ALL {
            let (world, starts, truth) = double(start, preset);
            let y = [start[0], start[1], 0.0, 0.0];
            let motions = trace(&world, &starts, time);
            let time = motions.motions[0][motions.motions[0].len() - 1].path.t;
            let [exact, coarse] = [8000, 4000].map(|n| truth.after(y, time, n));
            assert!((0..2).all(|k| (exact[k] - coarse[k]).abs() < 1e-11));
            let found = angles(&motions);
            // Angles are compared modulo a full turn.
            let off = |k: usize, exact: &[f64; 4]| 2.0 * math::sin(0.5 * (found[k] - exact[k])).abs();
            errors.push(off(0, &exact).max(off(1, &exact)));
            // A twin without the second rod's moment of inertia is far away.
            let twin = Double { inertia: [truth.inertia[0], 0.0], ..truth }.after(y, time, 4000);
            assert!(off(0, &twin).max(off(1, &twin)) > 0.02, "{start:?}");
        }
        assert!(errors[1] < 1e-4, "{errors:?}");
        assert!(errors[0] > 4.0 * errors[1] && errors[1] > 60.0 * errors[2], "{errors:?}");
    }
}

/// A wheel on an axle with dry friction τ stops after I ω/τ, having turned by I ω²/(2 τ), and is then at rest. Twins
/// with a tenth more or less friction are told apart. A rod is held if the friction is larger than its weight's torque;
/// otherwise it falls.
#[test]
fn friction_stops_a_hinge() {
    let shape = cuboid(0.2, 0.2, 0.05);
    let inertia = shape.mass_properties(1000.0).inertia.z;
    let (spin, time) = (8.0, 0.9);
    for preset in Preset::ALL {
        let turned = |friction: f64| {
            let start = Start { spin: DVec3::Z * spin, ..Start::at_rest(DVec3::ZERO) };
            let mut world = world(std::slice::from_ref(&shape), G, preset);
            world.join(Joint::hinge(DVec3::ZERO, DVec3::Z, 0, &start).with_friction(friction)).unwrap();
            let mut state = world.state(&[start]).unwrap();
            let outcome = world.run(&mut state, &mut Scratch::default(), 5.0, &mut ()).unwrap();
            let side = state.bodies()[0].turn * DVec3::X;
            (outcome, state.bodies()[0].path.t, math::atan2(side.y, side.x))
        };
        let (outcome, stopped, angle) = turned(inertia * spin / time);
        let expected = 0.5 * spin * time;
        let off = |angle: f64| math::sin(0.5 * (angle - expected)).abs() * 2.0;
        // The last step is straight, however little of it was left: half of it is at the step's speed.
        let last = 0.25 * Accuracy::preset(preset).step * (0.025 / G).sqrt();
        let bound = 0.5 * spin / time * last * last + 1e-9;
        assert_eq!(outcome, Outcome::AllAtRest);
        assert!(stopped >= time - last && stopped < time + 3.0 * last, "{stopped} {last}");
        assert!(off(angle) < bound, "{}: {angle} for {expected} by {bound}", preset.name());
        assert!([0.9, 1.1].iter().all(|part| off(turned(part * inertia * spin / time).2) > 0.1));
    }
    let (_, start, _) = rod(1.0, Preset::Standard);
    let torque = 3.0 * G * 0.2 * math::sin(1.0);
    for (part, falls) in [(1.5, false), (1.1, false), (1.001, false), (0.999, true)] {
        let (mut world, ..) = rod(1.0, Preset::Standard);
        world.join(Joint::hinge(DVec3::ZERO, DVec3::Y, 0, &start).with_friction(part * torque)).unwrap();
        let mut state = world.state(&[start]).unwrap();
        let outcome = world.run(&mut state, &mut Scratch::default(), 3.0, &mut ()).unwrap();
        assert_eq!(outcome == Outcome::AllAtRest && state.bodies()[0].path.t < 0.1, !falls, "{part}: {outcome:?}");
    }
}

/// A door that swings without friction reaches its stop when it has turned that far, goes back at e times its speed,
/// and reaches the other stop when that speed says; it stays between the two angles. A door without restitution stays
/// at the stop.
#[test]
fn a_door_rebounds_from_its_stop() {
    let shape = cuboid(0.8, 0.04, 2.0);
    for (preset, e) in Preset::ALL.into_iter().flat_map(|p| [(p, 0.4), (p, 1.0), (p, 0.0)]) {
        let rate = 1.5;
        let start =
            Start { spin: DVec3::Z * rate, velocity: DVec3::Y * (0.4 * rate), ..Start::at_rest(DVec3::X * 0.4) };
        let mut world = world(std::slice::from_ref(&shape), G, preset);
        world.join(Joint::hinge(DVec3::ZERO, DVec3::Z, 0, &start).with_limits([-0.3, 1.1], e)).unwrap();
        let motions = trace(&world, &[start], 3.0);
        let angle = |time: f64| {
            let side = motions.body_at(&world, 0, time).unwrap().turn * DVec3::X;
            math::atan2(side.y, side.x)
        };
        let [first, second] = [1.1 / rate, 1.1 / rate + 1.4 / (e * rate)];
        let expected = |t: f64| match t {
            t if t < first => rate * t,
            t if t < second => 1.1 - e * rate * (t - first),
            t => -0.3 + e * e * rate * (t - second),
        };
        // A stop counts as touched 2 of the body's gaps before it, at its reach.
        let (gap, h) = (Accuracy::preset(preset).gap * 0.02, step(0.02, preset));
        let mut worst = 0.0_f64;
        for time in (0..60).map(|k| 0.05 * f64::from(k)).filter(|t| *t < second + 1.4 / (e * e * rate)) {
            worst = worst.max((angle(time) - expected(time)).abs());
        }
        // Chords are shorter than arcs by (ω h)²/6; a step that is cut very short before a stop costs some digits.
        let bound = 8.0 * (gap + rate * rate * h * h);
        assert!(worst < bound, "{} {e}: {worst:e} of {bound:e}", preset.name());
        let angles = || motions.motions[0].iter().map(|m| m.turn * DVec3::X).map(|x| math::atan2(x.y, x.x));
        assert!(angles().all(|a| (-0.3..=1.1).contains(&a)), "{} {e}: beyond a stop", preset.name());
        let spin = motions.body_at(&world, 0, 0.5 * (first + second.min(3.0))).unwrap().spin.z;
        // A door that stays is pushed to the gap that contacts keep.
        let push = if e == 0.0 { gap / h } else { 0.0 };
        assert!((spin + e * rate).abs() < 1e-6 + push, "{spin} {e}");
    }
}

/// Two welded cubes are one cuboid: when thrown, they move as it does, to the square of the step.
#[test]
fn a_weld_makes_one_body_of_two() {
    let mut errors = Vec::new();
    for preset in Preset::ALL {
        let orientation = DQuat::from_xyzw(0.3, 0.1, -0.2, 0.8).normalize();
        let whole = Start {
            orientation,
            velocity: DVec3::new(1.0, -2.0, 3.0),
            spin: DVec3::new(3.0, -4.0, 2.0),
            ..Start::at_rest(DVec3::Z)
        };
        let halves = [-0.05, 0.05].map(|x| {
            let arm = orientation * (DVec3::X * x);
            Start { position: whole.position + arm, velocity: whole.velocity + whole.spin.cross(arm), ..whole }
        });
        let one = world(&[cuboid(0.2, 0.1, 0.1)], G, preset);
        let mut two = world(&[cuboid(0.1, 0.1, 0.1), cuboid(0.1, 0.1, 0.1)], G, preset);
        two.join(Joint::weld(whole.position, 0, &halves[0]).to(1, &halves[1])).unwrap();
        let (time, t) = (0.8, [trace(&one, &[whole], 0.8), trace(&two, &halves, 0.8)]);
        let (body, pair) = (t[0].body_at(&one, 0, time).unwrap(), [0, 1].map(|k| t[1].body_at(&two, k, time).unwrap()));
        let off = [0, 1].map(|k| {
            let arm = DVec3::X * [-0.05, 0.05][k];
            // The position of the middle, and of two of the corners.
            [DVec3::ZERO, DVec3::Y * 0.05, DVec3::Z * 0.05]
                .map(|own| (point(&body, arm + own) - point(&pair[k], own)).length())
                .into_iter()
                .fold(0.0, f64::max)
        });
        let middle = (pair[0].path.x + pair[1].path.x) * 0.5;
        // Within a step, the middle is on a chord of its parabola.
        let h = step(0.05, preset);
        assert!((middle - body.path.x).length() < G * h * h / 8.0 + 1e-10, "{}", preset.name());
        errors.push(off[0].max(off[1]));
    }
    let [_, standard, fine, reference] = errors[..] else { unreachable!() };
    assert!(standard < 5e-3 && standard > 8.0 * fine && fine > 12.0 * reference, "{errors:?}");
}

/// A ball hits two welded balls in line. The weld passes on half of the impulse, and breaks if that is more than it can
/// bear. Once it is broken, a kicked body moves alone.
#[test]
fn a_weld_breaks_at_its_impulse() {
    let (r, speed) = (0.05, 2.0);
    let mass = Shape::Ball(r).mass_properties(1000.0).mass;
    // Elastic, one mass on two: 4/3 m v, of which half goes on.
    let passed = 2.0 / 3.0 * mass * speed;
    for (part, breaks) in [(1.0 + 1e-6, false), (1.0 - 1e-6, true)] {
        let mut world = world(&[Shape::Ball(r), Shape::Ball(r), Shape::Ball(r)], 0.0, Preset::Standard);
        let [a, b] = [0.0, 0.1].map(|x| Start::at_rest(DVec3::X * x));
        let shot = Start { velocity: DVec3::X * speed, ..Start::at_rest(DVec3::X * -0.5) };
        let weld = Joint::weld(DVec3::X * 0.05, 0, &a).to(1, &b).that_breaks_at(part * passed);
        let weld = world.join(weld).unwrap();
        let mut state = world.state(&[a, b, shot]).unwrap();
        let mut scratch = Scratch::default();
        world.run(&mut state, &mut scratch, 0.5, &mut ()).unwrap();
        assert_eq!(world.is_held(weld, &state), !breaks, "{part}");
        let at = |state: &State<RigidBodyState>, k: usize, t: f64| world.at(k, &state.bodies()[k], t).path.v;
        for k in [0, 1] {
            assert!((at(&state, k, 0.5) - DVec3::X * (speed * 2.0 / 3.0)).length() < 1e-7, "{}", at(&state, k, 0.5));
        }
        assert!((at(&state, 2, 0.5) + DVec3::X * (speed / 3.0)).length() < 1e-7);
        world.kick(&mut state, 1, DVec3::X * mass, DVec3::ZERO).unwrap();
        world.run(&mut state, &mut scratch, 1.0, &mut ()).unwrap();
        let gained = at(&state, 1, 1.0).x - speed * 2.0 / 3.0;
        assert!((gained - if breaks { 1.0 } else { 0.5 }).abs() < 1e-6, "{gained}");
    }
}

/// Over a minute, the joints of a double pendulum stay as close as at the start: at the ends of steps within a
/// thousandth of the gap at which bodies touch, between them within the sag of a step's curve. Its energy stays within
/// the square of the step, and a run that is paused has the same bits.
#[test]
fn joints_do_not_drift_apart() {
    for (preset, until) in [(Preset::Draft, 60.0), (Preset::Standard, 60.0), (Preset::Fine, 4.0)] {
        let (world, starts, truth) = double([1.2, 0.5], preset);
        let motions = trace(&world, &starts, until);
        let apart = |bodies: [&RigidBodyState; 2]| {
            let elbow = point(bodies[0], DVec3::Z * (truth.c[0] - truth.l)) - point(bodies[1], DVec3::Z * truth.c[1]);
            point(bodies[0], DVec3::Z * truth.c[0]).length().max(elbow.length())
        };
        let energy = |k: usize| -> f64 { (0..2).map(|b| world.energy(b, &motions.motions[b][k])).sum() };
        // Twice the reach of the bodies at the hinges, each a thousandth of half the preset's gap times a half width.
        let (mut worst, bound) = (0.0_f64, 2.0 * 0.5e-3 * Accuracy::preset(preset).gap * 0.03);
        let mut swing = 0.0_f64;
        for k in 1..motions.motions[0].len() {
            let bodies = [0, 1].map(|b| &motions.motions[b][k]);
            worst = worst.max(apart(bodies));
            swing = swing.max((energy(k) - energy(1)).abs());
        }
        let weight: f64 = truth.mass.iter().sum::<f64>() * G * truth.l;
        assert!(worst < bound, "{}: {worst:e} of {bound:e}", preset.name());
        let turn = 4.0 * step(0.025, preset) * (G / truth.l).sqrt();
        assert!(swing / weight < turn * turn, "{}: {} of {turn}", preset.name(), swing / weight);
    }
    let (world, starts, _) = double([1.2, 0.5], Preset::Draft);
    let [mut whole, mut paused] = [(); 2].map(|()| world.state(&starts).unwrap());
    world.run(&mut whole, &mut Scratch::default(), 2.0, &mut ()).unwrap();
    for k in 1..=20 {
        world.run(&mut paused, &mut Scratch::default(), 0.1 * f64::from(k), &mut ()).unwrap();
        paused = serde_json::from_str(&serde_json::to_string(&paused).unwrap()).unwrap();
    }
    for (a, b) in whole.bodies().iter().zip(paused.bodies()) {
        assert_eq!((a.path, a.turn, a.spin), (b.path, b.turn, b.spin));
    }
}

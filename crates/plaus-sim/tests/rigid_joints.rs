//! Joints beside closed forms and an integrator of another make.

use crate::common::{G, M};
use glam::{DQuat, DVec3};
use plaus_dist::math;
use plaus_sim::rigid::{BodySpec, Joint, Rigid, RigidWorld, Start, Turning};
use plaus_sim::shape::{Cuboid, Shape};
use plaus_sim::trace::Trace;
use plaus_sim::{Accuracy, Law, Laws, Preset, Scratch};
use std::f64::consts::PI;

fn cuboid(x: f64, y: f64, z: f64) -> Shape {
    Shape::Cuboid(Cuboid::new(DVec3::new(x, y, z), 0.0).unwrap())
}

fn world(shapes: &[Shape], gravity: f64, preset: Preset) -> Rigid {
    Rigid::new(RigidWorld {
        bodies: shapes.iter().map(|s| BodySpec::solid(s.clone(), 1000.0, M)).collect(),
        parts: Vec::new(),
        laws: Laws::uniform(Law::new(0.3, 0.5)).unwrap(),
        gravity: DVec3::NEG_Z * gravity,
        accuracy: Accuracy { events: 10_000_000, ..Accuracy::preset(preset) },
        skin: 1.0,
        sink: f64::NEG_INFINITY,
        duration: 1e3,
    })
    .unwrap()
}

/// The motions of all bodies until a time.
fn trace(world: &Rigid, starts: &[Start], until: f64) -> Trace<Turning> {
    let (mut state, mut trace) = (world.state(starts).unwrap(), Trace::default());
    world.run(&mut state, &mut Scratch::default(), until, &mut trace).unwrap();
    trace
}

/// A body's place in the axes of the world.
fn point(body: &Turning, own: DVec3) -> DVec3 {
    body.path.x + body.turn * own
}

/// A rod on a hinge, held at an angle from hanging down: the world, its start, and `√(m g l / I)` about the hinge.
fn rod(angle: f64, preset: Preset) -> (Rigid, Start, f64) {
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
fn elliptic(k: f64) -> f64 {
    let (mut a, mut b) = (1.0, (1.0 - k * k).sqrt());
    for _ in 0..60 {
        (a, b) = (0.5 * (a + b), (a * b).sqrt());
    }
    PI / (a + b)
}

/// Times at which the rod hangs straight down, by cubics between the ends of steps.
fn crossings(motions: &[Turning]) -> Vec<f64> {
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

/// Length of a step with joints of a body of this size: what `accuracy.step` and `SWING` of the simulator say.
fn step(size: f64, preset: Preset) -> f64 {
    0.25 * Accuracy::preset(preset).step * (size / G).sqrt()
}

/// The leapfrog's period is off by `(ω h)²/24` of itself where the swing is small; where it is wide, the quickest part
/// of it counts, at most four times as fast. An even lower order would not fall by the square of the step.
#[test]
fn a_pendulum_has_the_elliptic_period() {
    for angle in [0.1, 1.0, 2.0, 3.0] {
        let mut errors = Vec::new();
        for preset in Preset::ALL {
            let (world, start, rate) = rod(angle, preset);
            let period = 4.0 * elliptic(math::sin(0.5 * angle)) / rate;
            let until = if preset == Preset::Reference { 1.3 } else { 5.3 } * period;
            let times = crossings(&trace(&world, &[start], until).motions[0]);
            let n = times.len() - 1;
            let measured = 2.0 * (times[n] - times[0]) / n as f64;
            let turn = rate * step(0.03, preset);
            let off = (measured / period - 1.0).abs();
            assert!(n >= 2 && off < 4.0 * turn * turn / 24.0, "{angle} {}: {off:e} of {turn}", preset.name());
            errors.push(off);
            // Twins: a swing of no height, and a mass in one point.
            let small = (measured * rate / (2.0 * PI) - 1.0).abs();
            let thin = (measured / (period * rate / (G / 0.2).sqrt()) - 1.0).abs();
            assert!(small > 5e-4 && thin > 0.1, "{small} {thin}");
        }
        let [_, standard, fine, reference] = errors[..] else { unreachable!() };
        // Steps are to each other as 4 and 5: 16 and 25 at the second order, at the first 4 and 5.
        assert!(standard > 8.0 * fine && fine > 12.0 * reference, "{angle}: {errors:?}");
    }
}

/// Two rods on hinges in a plane, by their angles from hanging down: each `[angle, rate]`, as Lagrange's equations have
/// them. `l` is the way from hinge to hinge, `c` from each hinge to the centre of gravity.
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

    /// The state after a time, by Runge and Kutta's rule of fourth order in so many steps.
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
fn double(angles: [f64; 2], preset: Preset) -> (Rigid, [Start; 2], Double) {
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

/// Angles from hanging down, of bodies at a time.
fn angles(world: &Rigid, motions: &Trace<Turning>, time: f64) -> [f64; 2] {
    [0, 1].map(|k| {
        let body = motions.body_at(world, k, time).unwrap();
        let down = body.turn * DVec3::NEG_Z;
        math::atan2(down.x, -down.z)
    })
}

/// A double pendulum against Lagrange's equations, solved to 1e-11 (by halving their steps): the error falls as the
/// square of the step.
#[test]
fn a_double_pendulum_agrees_with_lagrange() {
    for start in [[0.4, -0.3], [1.2, 0.5], [1.5, 2.0]] {
        let mut errors = Vec::new();
        let time = 1.2;
        for preset in Preset::ALL {
            let (world, starts, truth) = double(start, preset);
            let y = [start[0], start[1], 0.0, 0.0];
            let [exact, coarse] = [8000, 4000].map(|n| truth.after(y, time, n));
            assert!((0..2).all(|k| (exact[k] - coarse[k]).abs() < 1e-11));
            let motions = trace(&world, &starts, time);
            let found = angles(&world, &motions, time);
            // Angles count round.
            let off = |k: usize, exact: &[f64; 4]| 2.0 * math::sin(0.5 * (found[k] - exact[k])).abs();
            errors.push(off(0, &exact).max(off(1, &exact)));
            // A twin without the second rod's moment of inertia is far away.
            let twin = Double { inertia: [truth.inertia[0], 0.0], ..truth }.after(y, time, 4000);
            assert!(off(0, &twin).max(off(1, &twin)) > 0.02, "{start:?}");
        }
        println!("{start:?}: {errors:?}");
        assert!(errors[1] < 2e-2, "{errors:?}");
        assert!(errors[1] > 8.0 * errors[2] && errors[2] > 12.0 * errors[3], "{errors:?}");
    }
}

/// Numbers evenly in [0, 1) from a seed.
struct Numbers(u64);

impl Numbers {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn vector(&mut self) -> DVec3 {
        DVec3::new(self.next(), self.next(), self.next()) * 2.0 - 1.0
    }

    fn turn(&mut self) -> DQuat {
        let v = self.vector();
        DQuat::from_xyzw(v.x, v.y, v.z, self.next() + 0.1).normalize()
    }
}

/// A chain of random bodies, each joined to the one before it by a random joint, that moves as one; its first body is
/// where it is said.
fn chain(numbers: &mut Numbers, count: usize, at: DVec3, friction: f64) -> (Vec<Shape>, Vec<Start>, Vec<Joint>) {
    let (mut shapes, mut starts, mut joints): (Vec<Shape>, Vec<Start>, Vec<Joint>) = Default::default();
    let (v, w) = (numbers.vector() * 2.0, numbers.vector() * 6.0);
    for k in 0..count {
        let half = DVec3::new(0.03, 0.03, 0.03) + DVec3::new(numbers.next(), numbers.next(), numbers.next()) * 0.05;
        let shape = if numbers.next() < 0.3 { Shape::Ball(half.x) } else { cuboid(half.x, half.y, half.z) };
        let orientation = numbers.turn();
        // Next to the one before, with the joint between them.
        let way = numbers.vector().normalize() * (0.1 + 0.1 * numbers.next());
        let x = starts.last().map_or(at, |s| s.position + way);
        let start = Start { position: x, orientation, velocity: v + w.cross(x - at), spin: w, time: 0.0 };
        if let Some(last) = starts.last() {
            let middle = x - way * 0.5;
            let joint = match numbers.next() {
                n if n < 0.4 => Joint::ball(middle, k - 1, last),
                n if n < 0.8 => Joint::hinge(middle, numbers.vector(), k - 1, last).with_friction(friction),
                _ => Joint::weld(middle, k - 1, last),
            };
            joints.push(joint.to(k, &start));
        }
        starts.push(start);
        shapes.push(shape);
    }
    (shapes, starts, joints)
}

/// What joints hold is together: how far their anchors are apart at most.
fn apart(joints: &[Joint], bodies: &[Turning]) -> f64 {
    let anchor = |k: usize, j: &Joint| {
        let body = if k == 0 { Some(j.body) } else { j.other };
        body.map_or(j.frames[k].at, |b| point(&bodies[b], j.frames[k].at))
    };
    joints.iter().map(|j| (anchor(0, j) - anchor(1, j)).length()).fold(0.0, f64::max)
}

/// Momentum, angular momentum about the origin, and kinetic energy.
fn totals(shapes: &[Shape], bodies: &[Turning]) -> (DVec3, DVec3, f64) {
    let mut all = (DVec3::ZERO, DVec3::ZERO, 0.0);
    for (shape, b) in shapes.iter().zip(bodies) {
        let mass = shape.mass_properties(1000.0);
        let own = b.turn * (mass.inertia * (b.turn.conjugate() * b.spin));
        all.0 += b.path.v * mass.mass;
        all.1 += own + b.path.x.cross(b.path.v) * mass.mass;
        all.2 += 0.5 * (mass.mass * b.path.v.length_squared() + b.spin.dot(own));
    }
    all
}

/// Random chains in space, of two to five bodies that are struck apart by a kick at their start: linear and angular
/// momentum stay to the rounding of their steps, at any time, also half way through one; kinetic energy to the square of
/// the step; joints hold. Each has a twin that is caught: a chain of which one joint is missing, and one with friction.
#[test]
fn free_chains_keep_momentum_and_energy() {
    let mut caught = [0, 0];
    for seed in 0..100 {
        let mut go = |friction: f64, missing: bool| {
            let mut numbers = Numbers(seed);
            let count = 2 + (seed % 4) as usize;
            let (shapes, starts, joints) = chain(&mut numbers, count, DVec3::ZERO, friction);
            let mut world = world(&shapes, 0.0, Preset::Fine);
            for joint in &joints[usize::from(missing)..] {
                world.join(*joint).unwrap();
            }
            let mut state = world.state(&starts).unwrap();
            let mut scratch = Scratch::default();
            let at = |state: &plaus_sim::State<Turning>, time: f64| -> Vec<Turning> {
                state.bodies().iter().enumerate().map(|(k, b)| world.at(k, b, time)).collect()
            };
            world.run(&mut state, &mut scratch, 0.01, &mut ()).unwrap();
            let (impulse, twist) = (numbers.vector() * 0.3, numbers.vector() * 0.02);
            world.kick(&mut state, count - 1, impulse, twist).unwrap();
            world.run(&mut state, &mut scratch, 0.1, &mut ()).unwrap();
            let before = totals(&shapes, &at(&state, 0.1));
            world.run(&mut state, &mut scratch, 2.0, &mut ()).unwrap();
            let bodies = at(&state, 2.0);
            let after = totals(&shapes, &bodies);
            let mass: f64 = shapes.iter().map(|s| s.mass_properties(1000.0).mass).sum();
            let scale = (2.0 * before.2 * mass).sqrt();
            let kept = [(after.0 - before.0).length() / scale, (after.1 - before.1).length() / (scale * 0.1)];
            (kept, after.2 / before.2 - 1.0, apart(&joints, &bodies))
        };
        let (kept, energy, off) = go(0.0, false);
        if seed % 10 == 0 { println!("{seed} {kept:?} {energy:e} {off:e}"); }
        assert!(kept.iter().all(|k| *k < 1e-10), "{seed}: {kept:?}");
        assert!(energy.abs() < 1e-3, "{seed}: {energy}");
        assert!(off < 1e-3, "{seed}: {off}");
        caught[0] += u32::from(go(0.0, true).2 > 1e-2);
        caught[1] += u32::from(go(2e-3, false).1 < -1e-3);
    }
    println!("{caught:?}");
    assert!(caught[0] > 80 && caught[1] > 40, "{caught:?}");
}

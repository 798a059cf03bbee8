//! What acts along hinges and sliders, compared with closed forms and with Lagrange's equations in small steps.

use crate::common::G;
use crate::rigid_joints::{cuboid, point, world};
use glam::{DQuat, DVec3};
use plaus_dist::math;
use plaus_sim::rigid::{Joint, RigidBodyState, RigidWorld, Spring, Start};
use plaus_sim::{Accuracy, Outcome, Preset, Scratch};

/// Numbers spread evenly over [0, 1), from a seed.
pub(crate) struct Numbers(pub(crate) u64);

impl Numbers {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    pub(crate) fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.next()
    }

    pub(crate) fn vector(&mut self) -> DVec3 {
        DVec3::new(self.next(), self.next(), self.next()) * 2.0 - 1.0
    }

    fn turn(&mut self) -> DQuat {
        let v = self.vector();
        DQuat::from_xyzw(v.x, v.y, v.z, self.next() + 0.1).normalize()
    }
}

/// The bodies of a world after a time.
pub(crate) fn after(world: &RigidWorld, starts: &[Start], time: f64) -> (Outcome, Vec<RigidBodyState>) {
    let mut state = world.state(starts).unwrap();
    let outcome = world.run(&mut state, &mut Scratch::default(), time, &mut ()).unwrap();
    let at = state.bodies().iter().enumerate().map(|(k, body)| world.at(k, body, time));
    (outcome, at.collect())
}

/// The state after a time, by the Runge–Kutta method of fourth order in this many steps.
fn integrate<const N: usize>(
    mut y: [f64; N],
    time: f64,
    steps: u32,
    slope: impl Fn(f64, &[f64; N]) -> [f64; N],
) -> [f64; N] {
    let h = time / f64::from(steps);
    let plus = |y: &[f64; N], k: [f64; N], h: f64| std::array::from_fn(|i| y[i] + k[i] * h);
    for step in 0..steps {
        let t = h * f64::from(step);
        let a = slope(t, &y);
        let b = slope(t + 0.5 * h, &plus(&y, a, 0.5 * h));
        let c = slope(t + 0.5 * h, &plus(&y, b, 0.5 * h));
        let d = slope(t + h, &plus(&y, c, h));
        y = std::array::from_fn(|i| y[i] + (a[i] + 2.0 * (b[i] + c[i]) + d[i]) * (h / 6.0));
    }
    y
}

/// A block on a random slider of the fixed world: its world, start, axis, and mass.
fn block(numbers: &mut Numbers, speed: f64, preset: Preset) -> (RigidWorld, Start, Joint, DVec3, f64) {
    let shape = cuboid(numbers.between(0.05, 0.2), numbers.between(0.05, 0.2), numbers.between(0.05, 0.2));
    let mass = shape.mass_properties(1000.0).mass;
    let axis = (numbers.vector() + DVec3::Z * 0.1).normalize();
    let start = Start { orientation: numbers.turn(), velocity: axis * speed, ..Start::at_rest(numbers.vector()) };
    let joint = Joint::slider(start.position + numbers.vector() * 0.3, axis, 0, &start);
    (world(&[shape], G, preset), start, joint, axis, mass)
}

/// A block on a random slider falls along it by its weight's part along it, does not leave its line or turn, and with
/// dry friction slides as on a slope, or stays if its weight pulls less. Steps with friction are exact for steady
/// forces but for the last before rest. A twin with a tenth more friction is told apart.
#[test]
fn a_block_slides_along_its_axis() {
    let (mut rubbed, mut caught) = (0, 0);
    for (seed, preset) in (0..24).flat_map(|seed| [(seed, Preset::Draft), (seed, Preset::Standard)]) {
        let numbers = &mut Numbers(seed * 7 + 1);
        let speed = numbers.between(-1.0, 1.0);
        let part = if seed % 3 == 0 { 0.0 } else { numbers.between(0.2, 1.6) };
        let (mut world, start, joint, axis, mass) = block(numbers, speed, preset);
        let pull = -G * axis.z;
        let friction = part * pull.abs();
        world.join(joint.with_friction(mass * friction)).unwrap();
        let time = 0.8_f64;
        let expected = |friction: f64| {
            // The block slows down until it stops, and then goes the way of its weight if that is more than friction.
            let a = pull - friction * speed.signum();
            let stop = if a * speed < 0.0 { -speed / a } else { f64::INFINITY };
            let first = time.min(stop);
            let second = if pull.abs() > friction { pull - friction * pull.signum() } else { 0.0 };
            first * (speed + 0.5 * a * first) + 0.5 * second * (time - first) * (time - first)
        };
        let (outcome, bodies) = after(&world, &[start], time);
        let moved = bodies[0].path.x - start.position;
        let (along, off) = (moved.dot(axis), (moved - axis * moved.dot(axis)).length());
        let turned = bodies[0].turn.angle_between(start.orientation);
        // A step in which the block stops is straight, and it goes on when the next begins.
        let h = Accuracy::preset(preset).step * 0.25 * (0.2 / G).sqrt();
        let late = (pull.abs() + friction) * h + (pull.abs() - friction).max(0.0) * time;
        let bound = if part == 0.0 { 1e-12 } else { 1e-6 + late * h };
        assert!((along - expected(friction)).abs() < bound, "{seed}: {along} for {}, {bound}", expected(friction));
        // Rows hold to a thousandth of the gap at which bodies touch.
        assert!(off < 1e-3 * Accuracy::preset(preset).gap * 0.2 && turned < 1e-7, "{seed}: {off:e} {turned:e}");
        let stops = speed.abs() / (friction - pull * speed.signum());
        let is_at_rest = outcome == Outcome::AllAtRest;
        assert!(is_at_rest == (part > 1.0 && stops < time) || (stops - time).abs() < 0.1, "{seed}: {outcome:?}");
        rubbed += usize::from(part > 0.0);
        caught += usize::from(part > 0.0 && (along - expected(1.1 * friction)).abs() > bound);
    }
    assert!(caught * 10 > rubbed * 6, "{caught} of {rubbed}");
}

/// A block that nothing pulls goes to and fro between the limits of its slider, at e times its speed after each; the
/// slider is carried by nothing, so the frame that it is held to takes as much momentum. Limits count as touched 2 of
/// the body's gaps before them. A twin whose limit is 1 mm farther is told apart.
#[test]
fn a_block_rebounds_from_its_limits() {
    for (seed, e) in (0..12).flat_map(|seed| [(seed, 1.0), (seed, 0.6)]) {
        let numbers = &mut Numbers(seed + 40);
        let speed = numbers.between(0.5, 2.0);
        let (_, start, joint, axis, _) = block(numbers, speed, Preset::Standard);
        let shape = cuboid(0.1, 0.12, 0.14);
        let mut world = world(&[shape], 0.0, Preset::Standard);
        let limits = [-numbers.between(0.05, 0.2), numbers.between(0.05, 0.2)];
        world.join(joint.with_limits(limits, e)).unwrap();
        let expected = |limits: [f64; 2], time: f64| {
            let (mut at, mut speed, mut left, mut hits) = (0.0, speed, time, 0);
            loop {
                let way = if speed > 0.0 { limits[1] - at } else { limits[0] - at };
                if way / speed > left {
                    return (at + speed * left, hits);
                }
                (left, at, speed, hits) = (left - way / speed, at + way, -e * speed, hits + 1);
            }
        };
        let time = 0.6;
        let (found, (exact, hits)) =
            (after(&world, &[start], time).1[0].path.x - start.position, expected(limits, time));
        let gap = Accuracy::preset(Preset::Standard).gap * 0.05;
        let bound = 2.0 * gap * f64::from(hits + 1) / math::powi(e, hits + 1);
        assert!((found.dot(axis) - exact).abs() < bound, "{seed} {e}: {} for {exact}, {bound}", found.dot(axis));
        let twin = expected([limits[0], limits[1] + 1e-3], time).0;
        assert!(hits == 0 || (found.dot(axis) - twin).abs() > bound, "{seed} {e} {bound}");
    }
}

/// A cart on a slider in a random direction with a rod that hangs from it on a level hinge across: the state is the
/// cart's place and the rod's angle from hanging down, with their rates.
struct Cart {
    masses: [f64; 2],
    /// Of the rod about its middle.
    inertia: f64,
    /// From the hinge to the rod's middle.
    arm: f64,
    /// Of the slider above the level.
    rise: f64,
}

impl Cart {
    fn slope(&self, [_, angle, v, w]: &[f64; 4], forces: [f64; 2]) -> [f64; 4] {
        let (m, n, l) = (self.masses[0], self.masses[1], self.arm);
        let [(s, c), (ds, dc)] = [*angle, self.rise].map(math::sin_cos);
        // The rod's middle is at q d + l (sin, −cos); d = (cos rise, sin rise).
        let along = dc * c + ds * s;
        let curve = -dc * s + ds * c;
        let a = [[m + n, n * l * along], [n * l * along, self.inertia + n * l * l]];
        let b = [-(m + n) * G * ds - n * l * curve * w * w + forces[0], -n * G * l * s + forces[1]];
        let det = a[0][0] * a[1][1] - a[0][1] * a[1][0];
        [*v, *w, (b[0] * a[1][1] - b[1] * a[0][1]) / det, (b[1] * a[0][0] - b[0] * a[1][0]) / det]
    }

    fn random(numbers: &mut Numbers, preset: Preset) -> (Self, RigidWorld, [Start; 2], [Joint; 2], [f64; 4]) {
        let shapes = [cuboid(0.12, 0.1, 0.08), cuboid(0.03, 0.04, 0.3)];
        let masses = shapes.each_ref().map(|s| s.mass_properties(1000.0));
        let (rise, angle, arm) = (numbers.between(-0.4, 0.4), numbers.between(-1.5, 1.5), 0.13);
        let [v, w] = [numbers.between(-0.5, 0.5), numbers.between(-3.0, 3.0)];
        let direction = DVec3::new(math::cos(rise), 0.0, math::sin(rise));
        let turn = DQuat::from_rotation_y(-angle);
        let carry = direction * v;
        let spin = DVec3::NEG_Y * w;
        let down = turn * (DVec3::NEG_Z * arm);
        let starts = [
            Start { velocity: carry, ..Start::at_rest(DVec3::ZERO) },
            Start { orientation: turn, velocity: carry + spin.cross(down), spin, ..Start::at_rest(down) },
        ];
        let joints = [
            Joint::slider(DVec3::new(0.02, 0.01, 0.03), direction, 0, &starts[0]),
            Joint::hinge(DVec3::ZERO, DVec3::NEG_Y, 1, &starts[1]).to(0, &starts[0]),
        ];
        let cart = Self { masses: masses.map(|m| m.mass), inertia: masses[1].inertia.y, arm, rise };
        (cart, world(&shapes, G, preset), starts, joints, [0.0, angle, v, w])
    }

    /// How far the rod's lower end is from where a state says.
    fn off(&self, bodies: &[RigidBodyState], y: &[f64; 4]) -> f64 {
        let (s, c) = math::sin_cos(y[1]);
        let (ds, dc) = math::sin_cos(self.rise);
        let end = DVec3::new(dc, 0.0, ds) * y[0] + DVec3::new(s, 0.0, -c) * (2.0 * self.arm);
        (point(&bodies[1], DVec3::NEG_Z * self.arm) - end).length()
    }
}

/// Carts with hanging rods, compared with Lagrange's equations, solved to 1e-11 (checked by halving their steps). Steps
/// in joint coordinates are of fifth order, and their error is what the preset allows, 0.04 of the size (30 mm) times
/// the fourth power of its step; those with rows, here for a friction of nearly nothing, of second order. A twin whose
/// slider rises by 1 % more is told apart.
#[test]
fn a_cart_with_a_rod_agrees_with_lagrange() {
    let mut worst = [0.0_f64; 3];
    for seed in 0..16 {
        let time = 0.7;
        for (k, (preset, friction)) in
            [(Preset::Draft, 0.0), (Preset::Standard, 0.0), (Preset::Standard, 1e-14)].into_iter().enumerate()
        {
            let (cart, mut world, starts, joints, y) = Cart::random(&mut Numbers(seed + 90), preset);
            world.join(joints[0].with_friction(friction)).unwrap();
            world.join(joints[1]).unwrap();
            let bodies = after(&world, &starts, time).1;
            let [exact, coarse] = [4000, 2000].map(|n| integrate(y, time, n, |_, y| cart.slope(y, [0.0; 2])));
            assert!((0..4).all(|k| (exact[k] - coarse[k]).abs() < 1e-10));
            worst[k] = worst[k].max(cart.off(&bodies, &exact));
            let twin = Cart { rise: cart.rise + 0.01, ..cart };
            let exact = integrate(y, time, 2000, |_, y| twin.slope(y, [0.0; 2]));
            assert!(twin.off(&bodies, &exact) > 5e-3, "{seed}");
        }
    }
    assert!(worst[0] < 1e-4 && worst[1] < 1e-5 && worst[2] < 1e-3, "{worst:?}");
}

/// The place after a time of what is at `x`, with speed `v`, from where a spring leaves it, on a damped spring: `x″ =
/// −ω² x − 2 δ x′`.
fn oscillated(x: f64, v: f64, omega: f64, delta: f64, time: f64) -> f64 {
    let square = omega * omega - delta * delta;
    let decay = math::exp(-delta * time);
    let rate = square.abs().sqrt();
    let (sin, cos) = if square > 0.0 {
        let (sin, cos) = math::sin_cos(rate * time);
        (sin / rate, cos)
    } else {
        let (up, down) = (math::exp(rate * time), math::exp(-rate * time));
        (0.5 * (up - down) / rate, 0.5 * (up + down))
    };
    decay * (x * cos + (v + delta * x) * sin)
}

/// A block on a sprung slider, which its weight pulls at too, and a block that turns on a sprung hinge through its
/// middle: a damped oscillator in closed form, under any damping. In joint coordinates, errors are what presets allow,
/// 0.04 of the size (50 mm) in a second times the fourth power of their step; in steps with rows, here for a friction
/// of nearly nothing, they fall as the square of the step. A twin with a tenth more damping, or stiffness, is told
/// apart.
#[test]
fn a_spring_makes_a_damped_oscillator() {
    let (mut worst, mut caught, mut count) = ([0.0_f64; 5], 0, 0);
    for seed in 0..40 {
        for (k, (preset, friction)) in
            [(Preset::Draft, 0.0), (Preset::Standard, 0.0), (Preset::Draft, 1e-14), (Preset::Standard, 1e-14)]
                .into_iter()
                .enumerate()
        {
            let numbers = &mut Numbers(seed + 7000);
            let (slides, time) = (seed % 2 == 0, 0.9);
            let omega = numbers.between(2.0, 30.0);
            let delta = omega * [0.0, 0.05, 0.5, 0.999, 3.0][(seed / 2 % 5) as usize];
            let (rest, speed) = (numbers.between(-0.1, 0.1), numbers.between(-1.0, 1.0));
            let shape = cuboid(0.1, 0.12, 0.14);
            let mass = shape.mass_properties(1000.0);
            let (mut bodies, mut of) = (Vec::new(), (0.0, 0.0));
            for part in [1.0, 1.1] {
                let axis = (numbers.vector() + DVec3::Z * 0.1).normalize();
                let orientation = DQuat::from_rotation_arc(DVec3::Z, axis);
                let inert = if slides { mass.mass } else { mass.inertia.z };
                let spring =
                    Spring { stiffness: inert * omega * omega * part, rest, damping: 2.0 * delta * inert * part };
                let start = if slides {
                    Start { velocity: axis * speed, ..Start::at_rest(DVec3::Y) }
                } else {
                    Start { orientation, spin: axis * speed, ..Start::at_rest(DVec3::Y) }
                };
                let joint = if slides {
                    Joint::slider(numbers.vector() * 0.2, axis, 0, &start)
                } else {
                    Joint::hinge(DVec3::Y + axis * 0.3, axis, 0, &start)
                };
                let mut world = world(std::slice::from_ref(&shape), G, preset);
                world.join(joint.with_spring(spring).with_friction(friction)).unwrap();
                let found = &after(&world, &[start], time).1[0];
                let turned = found.turn * start.orientation.conjugate();
                let q = if slides {
                    (found.path.x - start.position).dot(axis)
                } else {
                    2.0 * math::atan2(DVec3::new(turned.x, turned.y, turned.z).dot(axis), turned.w)
                };
                let middle = rest - if slides { G * axis.z / (omega * omega) } else { 0.0 };
                let exact = middle + oscillated(-middle, speed, omega, delta, time);
                // A hinge's angle counts at the block's corner.
                bodies.push((q - exact).abs() * if slides { 1.0 } else { 0.08 });
                of = (exact, q);
            }
            worst[k] = worst[k].max(bodies[0]);
            count += 1;
            caught += u32::from(bodies[1] > 1e-4);
            assert!(of.0.is_finite() && of.1.is_finite());
        }
    }
    println!("{worst:?} {caught} of {count}");
    assert!(caught * 10 >= count * 6, "{caught} of {count}");
    assert!(worst[0] < 1e-4 && worst[1] < 1e-5 && worst[2] < 3e-3 && worst[3] < 1e-3, "{worst:?}");
}

/// Springs that swing up to ten thousand times a second, and dampers that stop all within as short a time, on a cart
/// with a rod and in steps with rows: nothing explodes, the energy never exceeds that of the start, and a stiff damper
/// holds the cart back as Lagrange's equations say. A tenth of its damping is told apart.
#[test]
fn stiff_springs_do_not_explode() {
    for seed in 0..12 {
        let numbers = &mut Numbers(seed + 300);
        let friction = if seed % 2 == 0 { 0.0 } else { 1e-14 };
        let (cart, mut world, starts, joints, y) = Cart::random(numbers, Preset::Standard);
        let rate = math::exp(numbers.between(math::ln(30.0), math::ln(3000.0)));
        let mass: f64 = cart.masses.iter().sum();
        let [stiffness, damping] = if seed % 4 < 2 { [mass * rate * rate, 0.0] } else { [mass, mass * rate] };
        let spring = Spring { stiffness, rest: 0.001, damping };
        world.join(joints[0].with_spring(spring).with_friction(friction)).unwrap();
        world.join(joints[1]).unwrap();
        let time = 0.05;
        let energy = |bodies: &[RigidBodyState]| {
            let left = spring.rest - bodies[0].path.x.dot(joints[0].frames[1].turn * DVec3::Z);
            let all: f64 = bodies.iter().enumerate().map(|(k, b)| world.energy(k, b)).sum();
            all + 0.5 * stiffness * left * left
        };
        let mut state = world.state(&starts).unwrap();
        let first = energy(state.bodies());
        let (mut scratch, mut most) = (Scratch::default(), f64::NEG_INFINITY);
        for k in 1..=50 {
            world.run(&mut state, &mut scratch, time * f64::from(k) / 50.0, &mut ()).unwrap();
            let now: Vec<_> = state.bodies().iter().enumerate().map(|(k, b)| world.at(k, b, b.path.t)).collect();
            most = most.max(energy(&now));
        }
        let moving = 0.5 * mass * (y[2] * y[2] + 0.25 * y[3] * y[3]);
        // Steps with rows keep energy to the square of their part of a radian, 1/80 at the standard preset.
        let bound = if friction > 0.0 { 1e-3 * (moving + 0.5 * stiffness * 1e-6) } else { 1e-9 };
        assert!(most - first < bound, "{seed}: {most} after {first}");
        let bodies: Vec<_> = (0..2).map(|k| world.at(k, &state.bodies()[k], time)).collect();
        let truth = |damping: f64| {
            integrate(y, time, 40_000, |_, y| cart.slope(y, [stiffness * (spring.rest - y[0]) - damping * y[2], 0.0]))
        };
        let off = cart.off(&bodies, &truth(damping));
        assert!(off < 1e-3, "{seed}, rate {rate}, friction {friction}: {off}");
        let twin = cart.off(&bodies, &truth(0.1 * damping));
        assert!(damping == 0.0 || rate > 300.0 || twin > 5.0 * off, "{seed}: {twin} {off}");
    }
}

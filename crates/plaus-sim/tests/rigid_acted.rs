//! Damping and torque compared with closed forms and another integrator; changes to a state between runs.

use glam::{DMat3, DQuat, DVec3};
use plaus_dist::math;
use plaus_sim::rigid::{BodySpec, Forces, Phase, RigidBodyState, RigidWorld, RigidWorldDesc, Start, StaticShape};
use plaus_sim::scenery::Plane;
use plaus_sim::shape::{Cuboid, Frustum, Shape};
use plaus_sim::{Accuracy, Law, Laws, Material, Outcome, Preset, Scratch, State, WorldError};

const G: f64 = 9.81;

fn shapes() -> Vec<Shape> {
    let cuboid = |half: DVec3| Shape::Cuboid(Cuboid::new(half * 2.0, 0.0).unwrap());
    vec![Shape::Ball(0.1), cuboid(DVec3::new(0.1, 0.15, 0.05)), Frustum::cylinder(0.1, 0.05).unwrap().into()]
}

/// These bodies over a floor with this friction.
fn world(shapes: &[Shape], friction: f64, preset: Preset) -> RigidWorld {
    let stone = Material(0);
    RigidWorld::new(RigidWorldDesc {
        bodies: shapes.iter().map(|s| BodySpec::solid(s.clone(), 1000.0, stone)).collect(),
        parts: vec![StaticShape::Plane(Plane::new(DVec3::ZERO, DVec3::Z, stone).unwrap())],
        laws: Laws::uniform(Law::new(friction, 0.4)).unwrap(),
        gravity: DVec3::new(0.0, 0.0, -G),
        accuracy: Accuracy::preset(preset),
        skin: 0.5,
        sink: f64::NEG_INFINITY,
        duration: 20.0,
    })
    .unwrap()
}

fn start(height: f64) -> Start {
    Start {
        position: DVec3::Z * height,
        orientation: DQuat::from_xyzw(0.3, 0.1, -0.2, 0.8).normalize(),
        velocity: DVec3::new(3.0, -1.0, 4.0),
        spin: DVec3::new(3.0, -7.0, 11.0),
        time: 0.0,
    }
}

fn go(world: &RigidWorld, state: &mut State<RigidBodyState>, until: f64) -> (Outcome, Vec<RigidBodyState>) {
    let outcome = world.run(state, &mut Scratch::default(), until, &mut ()).unwrap();
    let time = state.time();
    (outcome, state.bodies().iter().enumerate().map(|(k, b)| world.at(k, b, time)).collect())
}

/// The angular momentum of a body of this shape.
fn momentum(shape: &Shape, body: &RigidBodyState) -> DVec3 {
    let inertia = shape.mass_properties(1000.0).inertia;
    body.turn * (inertia * (body.turn.conjugate() * body.spin))
}

fn angle(a: DQuat, b: DQuat) -> f64 {
    2.0 * (a.conjugate() * b).xyz().length()
}

/// Velocities and angular momenta agree to the rounding of a thousand legs, positions and orientations to within the
/// half gap by which a leg may stray. An undamped body is as far away as expected.
#[test]
fn damped_flight_is_its_closed_form() {
    let (c, d, t) = (0.7, 1.3, 1.2);
    for (shape, preset) in shapes().into_iter().flat_map(|s| [(s.clone(), Preset::Draft), (s, Preset::Fine)]) {
        let mut damped = world(std::slice::from_ref(&shape), 0.3, preset);
        let free = damped.clone();
        damped.act_on(0, Forces { damping: c, angular_damping: d, ..Forces::default() }).unwrap();
        let body = go(&damped, &mut damped.state(&[start(50.0)]).unwrap(), t).1.remove(0);
        let (s, decay) = (start(50.0), math::exp(-c * t));
        let last = DVec3::Z * (-G / c);
        let way = last * t + (s.velocity - last) * ((1.0 - decay) / c);
        let stray = Accuracy::preset(preset).gap * shape.size() * 0.25;
        assert!((body.path.x - s.position - way).length() < stray + 1e-12, "{:?}", body.path.x - s.position - way);
        assert!((body.path.v - last - (s.velocity - last) * decay).length() < 1e-11, "{}", body.path.v);
        // Its time runs as (1 − e^(−d t))/d.
        let slow = go(&free, &mut free.state(&[start(50.0)]).unwrap(), (1.0 - math::exp(-d * t)) / d).1.remove(0);
        let off = angle(body.turn, slow.turn);
        assert!(matches!(shape, Shape::Ball(_)) || off < stray / shape.reach() + 1e-11, "{off}");
        let expected = momentum(&shape, &slow) * math::exp(-d * t);
        assert!((momentum(&shape, &body) - expected).length() < 1e-11 * expected.length());
        let unslowed = go(&free, &mut free.state(&[start(50.0)]).unwrap(), t).1.remove(0);
        assert!(angle(body.turn, unslowed.turn) > 0.1 && (body.path.x - unslowed.path.x).length() > 0.1);
    }
}

/// `Forces::angular_damping` states the bounds. In the time, the spin falls by a fifth, and so the number of legs by a
/// tenth.
#[test]
fn the_number_of_legs_is_as_documented() {
    for shape in &shapes()[1..] {
        let mut world = world(std::slice::from_ref(shape), 0.3, Preset::Standard);
        world.act_on(0, Forces { angular_damping: 1.0, ..Forces::default() }).unwrap();
        let mut state = world.state(&[Start { spin: DVec3::Z * 10.0, ..start(50.0) }]).unwrap();
        go(&world, &mut state, 0.2);
        let legs = state.counts().expiries as f64 / 0.2;
        let inertia = shape.mass_properties(1000.0).inertia;
        let least = (10.0 * shape.reach() / (2.0 * Accuracy::default().gap * shape.size())).sqrt();
        let most = least * (inertia.max_element() / inertia.min_element()).sqrt();
        assert!(legs > 0.9 * least && legs < 1.01 * most, "{legs} a second, of {least} to {most}");
    }
}

/// Orientation and angular momentum after `t` by classic Runge–Kutta with `n` steps.
fn by_small_steps(inertia: DVec3, s: &Start, torque: DVec3, d: f64, t: f64, n: usize) -> (DMat3, DVec3) {
    let rate = |r: DMat3, l: DVec3| {
        let w = r * ((r.transpose() * l) / inertia);
        (DMat3::from_cols(w.cross(r.x_axis), w.cross(r.y_axis), w.cross(r.z_axis)), torque - l * d)
    };
    let mut r = DMat3::from_quat(s.orientation);
    let mut l = r * (inertia * (r.transpose() * s.spin));
    let h = t / n as f64;
    for _ in 0..n {
        let (a, p) = rate(r, l);
        let (b, q) = rate(r + a * (0.5 * h), l + p * (0.5 * h));
        let (c, u) = rate(r + b * (0.5 * h), l + q * (0.5 * h));
        let (e, v) = rate(r + c * h, l + u * h);
        r += (a + (b + c) * 2.0 + e) * (h / 6.0);
        l += (p + (q + u) * 2.0 + v) * (h / 6.0);
    }
    (r, l)
}

/// The angular momentum is exact. The orientation's error falls as the square of the legs' length, which is
/// proportional to the root of the gap: between draft and fine the gap falls by a factor of 100, and so does the error.
#[test]
fn a_torque_turns_a_body_as_another_integrator_says() {
    let (t, d) = (0.6, 0.4);
    for shape in &shapes()[1..] {
        let inertia = shape.mass_properties(1000.0).inertia;
        let torque = inertia.max_element() * DVec3::new(4.0, -10.0, 6.0);
        let (turn, l) = by_small_steps(inertia, &start(9.0), torque, d, t, 20_000);
        let off = |preset| {
            let mut world = world(std::slice::from_ref(shape), 0.3, preset);
            world.act_on(0, Forces { torque, angular_damping: d, ..Forces::default() }).unwrap();
            let body = go(&world, &mut world.state(&[start(9.0)]).unwrap(), t).1.remove(0);
            // Rounding of the small steps.
            assert!((momentum(shape, &body) - l).length() < 1e-10 * l.length(), "{}", momentum(shape, &body) - l);
            angle(body.turn, DQuat::from_mat3(&turn))
        };
        let [draft, fine] = [off(Preset::Draft), off(Preset::Fine)];
        assert!(draft < 1e-3 && fine < 0.03 * draft, "{draft} {fine}");
    }
}

/// A body that spins about its own axis with a force that turns with it goes round a circle of radius F/(m Ω²), in
/// flight and on a floor without friction; with a force that keeps its direction it flies off. In flight the force is
/// summed to 8e-9 of its impulse per leg, and legs stray by up to half a gap. On the floor, whose normal force is found
/// in steps, the error is that of the steps of h = `step √(size/g)`: half of the force acts as at the start and half as
/// at the end of each, so that the velocity is off by (Ω h)²/12, and within a step it goes straight on.
#[test]
fn a_force_that_turns_with_its_body_leads_round_a_circle() {
    let (rate, force) = (6.0, 3.0);
    for (shape, preset) in shapes().into_iter().flat_map(|s| {
        [Preset::Draft, Preset::Standard, Preset::Fine, Preset::Reference].map(|preset| (s.clone(), preset))
    }) {
        for floats in [true, false] {
            let height = if floats { 5.0 } else { shape.contact_spheres().iter().map(lowest).fold(0.0, f64::max) };
            let mut world = world(std::slice::from_ref(&shape), 0.0, preset);
            let twin = world.clone();
            let pull = force * shape.mass_properties(1000.0).mass;
            let gravity = f64::from(u8::from(!floats));
            let forces = Forces { own_force: DVec3::X * pull, gravity, ..Forces::default() };
            world.act_on(0, forces).unwrap();
            let radius = force / (rate * rate);
            let start = Start {
                velocity: DVec3::NEG_Y * (radius * rate),
                spin: DVec3::Z * rate,
                ..Start::at_rest(DVec3::Z * height)
            };
            let accuracy = Accuracy::preset(preset);
            let step = rate * accuracy.step * (shape.size() / G).sqrt();
            let stray = |time: f64| {
                let of_steps = step * step * (0.125 + (1.0 + rate * time) / 12.0);
                accuracy.gap * shape.size() + radius * if floats { 1e-7 } else { of_steps }
            };
            let mut twin = twin;
            twin.act_on(0, Forces { force: DVec3::X * pull, gravity, ..Forces::default() }).unwrap();
            for time in [0.4, 1.0, 2.0] {
                let (s, c) = math::sin_cos(rate * time);
                // About a centre at radius ahead of the start along the force.
                let there = DVec3::new(1.0 - c, -s, 0.0) * radius;
                let off = |world: &RigidWorld| {
                    let body = go(world, &mut world.state(&[start]).unwrap(), time).1.remove(0);
                    (body.path.x - there).truncate().length()
                };
                let (found, most) = (off(&world), stray(time));
                assert!(found < most, "{shape:?} {preset:?} {floats} {time}: {found} of {most}");
                assert!(off(&twin) > 10.0 * most, "{shape:?} {preset:?} {floats}: {}", off(&twin));
            }
        }
    }
}

/// A torque that turns with its body, about none of its principal axes: its angular momentum and orientation are those
/// of small steps.
#[test]
fn a_torque_that_turns_with_its_body_is_that_of_another_integrator() {
    let (t, n) = (0.6, 20_000);
    for shape in &shapes()[1..] {
        let inertia = shape.mass_properties(1000.0).inertia;
        let own = inertia.max_element() * DVec3::new(4.0, -10.0, 6.0);
        // Euler's equations in body axes.
        let rate = |turn: DQuat, w: DVec3| {
            (
                DQuat::from_vec4((turn * DQuat::from_vec4(w.extend(0.0))).into()) * 0.5,
                (own - w.cross(inertia * w)) / inertia,
            )
        };
        let s = start(9.0);
        let (mut turn, mut w, h) = (s.orientation, s.orientation.conjugate() * s.spin, t / f64::from(n));
        for _ in 0..n {
            let (a, p) = rate(turn, w);
            let (b, q) = rate(turn + a * (0.5 * h), w + p * (0.5 * h));
            let (c, u) = rate(turn + b * (0.5 * h), w + q * (0.5 * h));
            let (d, v) = rate(turn + c * h, w + u * h);
            turn = (turn + (a + (b + c) * 2.0 + d) * (h / 6.0)).normalize();
            w += (p + (q + u) * 2.0 + v) * (h / 6.0);
        }
        let off = |preset, is_twin: bool| {
            let mut world = world(std::slice::from_ref(shape), 0.3, preset);
            let forces = if is_twin {
                Forces { torque: s.orientation * own, ..Forces::default() }
            } else {
                Forces { own_torque: own, ..Forces::default() }
            };
            world.act_on(0, forces).unwrap();
            let body = go(&world, &mut world.state(&[s]).unwrap(), t).1.remove(0);
            angle(body.turn, turn).max((body.spin - turn * w).length() / w.length())
        };
        let [draft, fine] = [Preset::Draft, Preset::Fine].map(|preset| off(preset, false));
        // Second order in the legs, whose square is proportional to the gap: a hundredth of it.
        assert!(draft < 1e-3 && fine < 0.03 * draft, "{draft} {fine}");
        assert!(off(Preset::Fine, true) > 0.1);
    }
}

fn lowest(sphere: &plaus_sim::shape::ContactSphere) -> f64 {
    sphere.radius - sphere.centre.z
}

/// A block that slides: `v̇ = −µ g − c v`. The error is that of the steps, of second order.
#[test]
fn damping_acts_on_a_sliding_block() {
    let cuboid = [shapes().remove(1)];
    let (c, mu, t) = (0.8, 0.2, 0.7);
    for preset in [Preset::Draft, Preset::Standard] {
        let mut world = world(&cuboid, mu, preset);
        world.act_on(0, Forces { damping: c, ..Forces::default() }).unwrap();
        let s = Start { velocity: DVec3::X * 3.0, ..Start::at_rest(DVec3::Z * 0.05) };
        let body = go(&world, &mut world.state(&[s]).unwrap(), t).1.remove(0);
        let last = mu * G / c;
        let expected = (3.0 + last) * math::exp(-c * t) - last;
        assert!((body.path.v.x - expected).abs() < 1e-3 * expected, "{} for {expected}", body.path.v.x);
        let undamped = 3.0 - mu * G * t;
        assert!((body.path.v.x - undamped).abs() > 0.1);
    }
}

/// On ice, a torque turns a lying block as fast as in the air; where there is enough friction, the block stays.
#[test]
fn a_torque_turns_a_lying_block() {
    let shape = shapes().remove(1);
    let inertia = shape.mass_properties(1000.0).inertia.z;
    for (friction, turns) in [(0.0, true), (0.5, false)] {
        let mut world = world(std::slice::from_ref(&shape), friction, Preset::Standard);
        world.act_on(0, Forces { torque: DVec3::Z * inertia * 2.0, ..Forces::default() }).unwrap();
        let (outcome, bodies) = go(&world, &mut world.state(&[Start::at_rest(DVec3::Z * 0.05)]).unwrap(), 0.5);
        let spin = bodies[0].spin.z;
        assert_eq!(outcome == Outcome::AllAtRest, !turns, "{outcome:?}");
        assert!((spin - if turns { 1.0 } else { 0.0 }).abs() < 1e-9, "{spin}");
    }
}

/// Random throws onto ice: momentum along it falls as damping says, at every preset, to rounding; energy never grows by
/// more than steps may add. A twin with a thousandth more damping is found out.
#[test]
fn random_throws_lose_what_damping_takes() {
    let mut seed = 11_u64;
    let mut uniform = |low: f64, high: f64| {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        low + (high - low) * (seed >> 11) as f64 / (1_u64 << 53) as f64
    };
    for k in 0..24 {
        let shape = shapes().remove(k % 3);
        let preset = [Preset::Draft, Preset::Standard][k % 2];
        let mut world = world(std::slice::from_ref(&shape), 0.0, preset);
        let c = uniform(0.1, 2.0);
        world.act_on(0, Forces { damping: c, angular_damping: uniform(0.0, 2.0), ..Forces::default() }).unwrap();
        let mut vector = |size: f64| DVec3::new(uniform(-size, size), uniform(-size, size), uniform(-size, size));
        let s = Start { velocity: vector(3.0), spin: vector(10.0), ..start(0.6) };
        let mut state = world.state(&[s]).unwrap();
        let mut energy = f64::INFINITY;
        for part in 1..=10 {
            let t = 0.1 * f64::from(part);
            let (_, bodies) = go(&world, &mut state, t);
            let (v, expected) = (bodies[0].path.v.truncate(), s.velocity.truncate() * math::exp(-c * t));
            let off = (v - expected).length() / expected.length();
            assert!(off < 1e-11, "{k} at {t}: {off}");
            let twin = s.velocity.truncate() * math::exp(-1.001 * c * t);
            assert!((v - twin).length() > 5e-4 * c * t * expected.length());
            let now = world.energy(0, &bodies[0]);
            // The steps' error: 1e-3 of the weight times the size at standard, ten times as much at draft.
            let weight = shape.mass_properties(1000.0).mass * G * shape.size();
            assert!(now <= energy + [1e-2, 1e-3][k % 2] * weight, "{k} at {t}: {now} after {energy}");
            energy = now;
        }
    }
}

#[test]
fn forces_must_be_finite() {
    let mut world = world(&shapes(), 0.3, Preset::Standard);
    for forces in [
        Forces { damping: -0.1, ..Forces::default() },
        Forces { angular_damping: f64::NAN, ..Forces::default() },
        Forces { damping: f64::INFINITY, ..Forces::default() },
        Forces { torque: DVec3::Y * f64::INFINITY, ..Forces::default() },
    ] {
        assert!(matches!(world.act_on(1, forces), Err(WorldError::BadBody { body: 1, .. })), "{forces:?}");
    }
}

/// A block at rest that is kicked flies as if it had been thrown; a block in the air goes on with the added velocity.
#[test]
fn a_kick_is_a_throw() {
    let shape = shapes().remove(1);
    let mass = shape.mass_properties(1000.0);
    let world = world(std::slice::from_ref(&shape), 0.3, Preset::Standard);
    let mut state = world.state(&[Start::at_rest(DVec3::Z * 0.05)]).unwrap();
    let (outcome, bodies) = go(&world, &mut state, 1.0);
    assert_eq!((outcome, bodies[0].phase), (Outcome::AllAtRest, Phase::Rest));
    let rested = state.time();
    let (v, w) = (DVec3::new(1.0, 0.0, 3.0), DVec3::Z * 2.0);
    let angular = bodies[0].turn * (mass.inertia * (bodies[0].turn.conjugate() * w));
    world.kick(&mut state, 0, v * mass.mass, angular).unwrap();
    let thrown = go(&world, &mut state, rested + 0.4).1.remove(0);
    let expected = bodies[0].path.x + v * 0.4 - DVec3::Z * (0.5 * G * 0.16);
    assert!((thrown.path.x - expected).length() < 1e-12 && (thrown.spin - w).length() < 1e-12, "{thrown:?}");
    world.kick(&mut state, 0, DVec3::Y * mass.mass, DVec3::ZERO).unwrap();
    let again = go(&world, &mut state, rested + 0.5).1.remove(0);
    let expected = expected + (thrown.path.v + DVec3::Y) * 0.1 - DVec3::Z * (0.5 * G * 0.01);
    assert!((again.path.x - expected).length() < 1e-12, "{} for {expected}", again.path.x);
    assert!(world.kick(&mut state, 1, DVec3::ZERO, DVec3::ZERO).is_err());
    assert!(world.kick(&mut state, 0, DVec3::X * f64::NAN, DVec3::ZERO).is_err());
    let (outcome, bodies) = go(&world, &mut state, 8.0);
    assert!(outcome == Outcome::AllAtRest && (bodies[0].path.x.z - 0.05).abs() < 1e-5);
}

/// A body that stands on one that is taken out falls, and a body may be put where there is room.
#[test]
fn bodies_come_and_go_between_runs() {
    let cube = Shape::Cuboid(Cuboid::new(DVec3::splat(0.2), 0.0).unwrap());
    let world = world(&[cube.clone(), cube], 0.5, Preset::Standard);
    let starts = [0.1, 0.3].map(|z| Start::at_rest(DVec3::Z * z));
    let mut state = world.state(&starts).unwrap();
    assert_eq!(go(&world, &mut state, 1.0).0, Outcome::AllAtRest);
    let stacked = state.clone();
    world.remove(&mut state, 0).unwrap();
    let (outcome, bodies) = go(&world, &mut state, 3.0);
    assert_eq!((outcome, bodies[0].phase), (Outcome::AllAtRest, Phase::Gone));
    assert!((bodies[1].path.x.z - 0.1).abs() < 1e-5, "{}", bodies[1].path.x);
    assert!(world.kick(&mut state, 0, DVec3::ZERO, DVec3::ZERO).is_err());
    // It lies where the other would be put.
    let now = state.time();
    let inside = world.put(&mut state, 0, &Start { time: now, ..starts[0] });
    assert!(matches!(inside, Err(WorldError::BodiesOverlap { a: 0, b: 1, .. })), "{inside:?}");
    assert!(world.put(&mut state, 0, &Start { time: 0.5 * now, ..starts[0] }).is_err());
    world.put(&mut state, 0, &Start { time: now + 0.5, ..Start::at_rest(DVec3::Z * 0.6) }).unwrap();
    let (outcome, bodies) = go(&world, &mut state, 6.0);
    assert_eq!(outcome, Outcome::AllAtRest);
    assert!((bodies[0].path.x.z - 0.3).abs() < 1e-5, "{}", bodies[0].path.x);
    // The same changes to a copy give the same bits.
    let again = |mut state: State<RigidBodyState>| {
        world.remove(&mut state, 0).unwrap();
        go(&world, &mut state, 1.2);
        state.bodies()[1].path.x
    };
    assert_eq!(again(stacked.clone()), again(stacked));
}

//! Chains of random bodies with random joints, in space and on a floor; invalid joints.

use crate::common::{G, M};
use crate::rigid_joints::{cuboid, point, world};
use glam::{DQuat, DVec3};
use plaus_sim::rigid::{
    BodySpec, Interpolation, Joint, Key, Motor, MotorGoal, Phase, RigidBodyState, RigidWorld, RigidWorldDesc, Spring,
    Start, StaticShape, Track,
};
use plaus_sim::scenery::Plane;
use plaus_sim::shape::Shape;
use plaus_sim::{Accuracy, Law, Laws, Outcome, Preset, Scratch, State, WorldError};

/// Numbers spread evenly over [0, 1), from a seed.
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

/// A chain of random bodies, each joined to the one before it by a random joint, that moves as one; `chain` is told
/// where its first body is.
fn chain(
    numbers: &mut Numbers,
    count: usize,
    at: DVec3,
    friction: f64,
    speed: f64,
) -> (Vec<Shape>, Vec<Start>, Vec<Joint>) {
    let (mut shapes, mut starts, mut joints): (Vec<Shape>, Vec<Start>, Vec<Joint>) = Default::default();
    let (v, w) = (numbers.vector() * speed, numbers.vector() * (3.0 * speed));
    for k in 0..count {
        let half = DVec3::new(0.03, 0.03, 0.03) + DVec3::new(numbers.next(), numbers.next(), numbers.next()) * 0.05;
        let shape = if numbers.next() < 0.3 { Shape::Ball(half.x) } else { cuboid(half.x, half.y, half.z) };
        let orientation = numbers.turn();
        // Next to the previous body, with the joint between them.
        let way = (DVec3::X + numbers.vector()).normalize() * (0.12 + 0.08 * numbers.next());
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

/// Whether bodies are together at their joints: the largest distance between the anchors of a joint.
fn apart(joints: &[Joint], bodies: &[RigidBodyState]) -> f64 {
    let anchor = |k: usize, j: &Joint| {
        let body = if k == 0 { Some(j.body) } else { j.other };
        body.map_or(j.frames[k].at, |b| point(&bodies[b], j.frames[k].at))
    };
    joints.iter().map(|j| (anchor(0, j) - anchor(1, j)).length()).fold(0.0, f64::max)
}

/// Momentum, angular momentum about the origin, and kinetic energy.
fn totals(shapes: &[Shape], bodies: &[RigidBodyState]) -> (DVec3, DVec3, f64) {
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

/// The result for a chain in space whose last body is kicked: how far momentum and angular momentum have changed, over
/// what the bodies have of them; kinetic energy; and how far joints are apart. `None` if the chain overlapped itself.
fn kicked(seed: u64, friction: f64, missing: bool, until: f64) -> Option<([f64; 2], f64, f64)> {
    let mut numbers = Numbers(seed);
    let count = 2 + (seed % 4) as usize;
    let (shapes, starts, joints) = chain(&mut numbers, count, DVec3::ZERO, friction, 0.0);
    let mut world = world(&shapes, 0.0, Preset::Standard);
    for joint in &joints[usize::from(missing)..] {
        world.join(*joint).unwrap();
    }
    let mut state = world.state(&starts).ok()?;
    let mut scratch = Scratch::default();
    let mut go = |state: &mut State<RigidBodyState>, time: f64| -> Vec<RigidBodyState> {
        world.run(state, &mut scratch, time, &mut ()).unwrap();
        // Bodies that a joint is missing between do not share their steps' ends.
        let end = |b: &RigidBodyState| if missing { time } else { b.path.t };
        state.bodies().iter().enumerate().map(|(k, b)| world.at(k, b, end(b))).collect()
    };
    go(&mut state, 0.01);
    let own = shapes[count - 1].mass_properties(1000.0);
    let twist = numbers.vector() * (10.0 * own.inertia.min_element());
    world.kick(&mut state, count - 1, numbers.vector() * own.mass, twist).unwrap();
    // By this time, the joints have taken up the kick.
    let before = totals(&shapes, &go(&mut state, 0.1));
    let bodies = go(&mut state, until);
    let after = totals(&shapes, &bodies);
    let mass: f64 = shapes.iter().map(|s| s.mass_properties(1000.0).mass).sum();
    let scale = (2.0 * before.2 * mass).sqrt();
    let kept = [(after.0 - before.0).length() / scale, (after.1 - before.1).length() / (scale * 0.1)];
    Some((kept, after.2 / before.2 - 1.0, apart(&joints, &bodies)))
}

/// Random chains in space, of two to five bodies, whose joints hold them together after a kick. Linear and angular
/// momentum are kept to the rounding of their steps, at the ends of these. Energy is kept to the square of the step, a
/// tenth of a radian, with elastic impacts too. Joints are closed to within the gap that steps of lasting contact
/// leave, a thousandth of 1e-5 of a body's size. Twins are caught: a chain without one of its joints, and one whose
/// hinges rub.
#[test]
fn free_chains_keep_momentum_and_energy() {
    let (mut chains, mut caught) = (0, [0, 0]);
    let mut worst = [0.0_f64; 3];
    for seed in 0..60 {
        let Some((kept, energy, off)) = kicked(seed, 0.0, false, 0.4) else { continue };
        chains += 1;
        worst = [worst[0].max(energy.abs()), worst[1].max(off), worst[2].max(kept[0].max(kept[1]))];
        assert!(kept.iter().all(|k| *k < 1e-11), "{seed}: {kept:?}");
        assert!(energy.abs() < 5e-3, "{seed}: {energy}");
        assert!(off < 1e-8 * 0.1, "{seed}: {off}");
        caught[0] += u32::from(kicked(seed, 0.0, true, 0.25).is_none_or(|t| t.2 > 1e-2));
        caught[1] += u32::from(kicked(seed, 4e-3, false, 0.6).is_none_or(|t| t.1 < -5e-3));
    }
    println!("{chains} chains: energy, joints, momentum {worst:?}; twins {caught:?}");
    // A missing first joint shows if the kick pulls at it; chains of welds and balls do not rub.
    assert!(chains > 55 && caught[0] > 45 && caught[1] >= 15, "{caught:?} of {chains}");
}

/// Random chains thrown onto a floor: at no event is their energy above its earlier value by more than the steps'
/// error, they do not fall through, joints hold, and every run ends by time or rest. The same bodies without joints
/// come apart.
#[test]
fn chains_thrown_onto_a_floor_hold() {
    let (mut worst, mut parted) = ([0.0_f64; 3], 0);
    for seed in 0..40 {
        let go = |joined: bool| {
            let (shapes, starts, joints) = chain(&mut Numbers(seed), 3, DVec3::Z * 0.6, 1e-4, 2.0);
            let mut world = RigidWorld::new(RigidWorldDesc {
                bodies: shapes.iter().map(|s| BodySpec::solid(s.clone(), 1000.0, M)).collect(),
                parts: vec![StaticShape::Plane(Plane::new(DVec3::ZERO, DVec3::Z, M).unwrap())],
                laws: Laws::uniform(Law::new(0.4, 0.3)).unwrap(),
                gravity: DVec3::NEG_Z * G,
                accuracy: Accuracy::preset(Preset::Draft),
                skin: 1.0,
                sink: f64::NEG_INFINITY,
                duration: 1.5,
            })
            .unwrap();
            for joint in joints.iter().filter(|_| joined) {
                world.join(*joint).unwrap();
            }
            let mut state = world.state(&starts).ok()?;
            let energy = |state: &State<RigidBodyState>| -> f64 {
                state.bodies().iter().enumerate().map(|(k, b)| world.energy(k, &world.at(k, b, state.time()))).sum()
            };
            let (first, mut most) = (energy(&state), f64::NEG_INFINITY);
            let mut scratch = Scratch::default();
            let mut outcome = Outcome::TimeReached;
            for k in 1..=15 {
                outcome = world.run(&mut state, &mut scratch, 0.1 * f64::from(k), &mut ()).unwrap();
                most = most.max(energy(&state));
            }
            let bodies: Vec<RigidBodyState> =
                state.bodies().iter().enumerate().map(|(k, b)| world.at(k, b, state.time())).collect();
            assert!(matches!(outcome, Outcome::TimeReached | Outcome::AllAtRest), "{seed}: {outcome:?}");
            let deep = bodies.iter().enumerate().map(|(k, b)| world.depth(k, b)).fold(0.0, f64::max);
            Some(((most - first) / first, deep, apart(&joints, &bodies)))
        };
        let Some((gained, deep, off)) = go(true) else { continue };
        worst = [worst[0].max(gained), worst[1].max(deep), worst[2].max(off)];
        parted += u32::from(go(false).is_some_and(|t| t.2 > 0.02));
    }
    println!("{worst:?} {parted}");
    assert!(worst[0] < 1e-2 && worst[1] < 2e-3 && worst[2] < 5e-3 && parted > 35, "{worst:?} {parted}");
}

#[test]
fn bad_joints_are_named() {
    let [a, b] = [0.0, 1.0].map(|x| Start::at_rest(DVec3::X * x));
    let none = || world(&[Shape::Ball(0.1), Shape::Ball(0.1)], G, Preset::Standard);
    let good = Joint::hinge(DVec3::X * 0.5, DVec3::Y, 0, &a).to(1, &b);
    let refused = |joint: Joint, field: &str| {
        let error = none().join(joint).unwrap_err();
        assert!(matches!(error, WorldError::BadJoint { joint: 0, field: f, .. } if f.contains(field)), "{error}");
    };
    refused(Joint { other: Some(0), ..good }, "other body");
    refused(Joint { other: Some(2), ..good }, "index");
    refused(Joint { body: 7, ..good }, "index");
    refused(Joint::ball(DVec3::NAN, 0, &a), "anchor");
    refused(Joint::hinge(DVec3::ZERO, DVec3::ZERO, 0, &a), "axes");
    for limits in [[0.5, 0.5], [1.0, -1.0], [-4.0, 0.0], [-3.1, 3.1], [f64::NAN, 1.0], [0.0, f64::NAN]] {
        refused(good.with_limits(limits, 0.5), "limit");
    }
    refused(good.with_limits([-1.0, 1.0], 1.5), "restitution");
    refused(good.with_friction(-1.0), "friction");
    refused(good.with_friction(f64::NAN), "friction");
    for joint in [Joint::weld(DVec3::ZERO, 0, &a), Joint::ball(DVec3::ZERO, 0, &a), good] {
        refused(joint.that_breaks_at(0.0), "breaks");
        refused(joint.that_breaks_at(f64::NAN), "breaks");
    }
    let slider = Joint::slider(DVec3::X * 0.5, DVec3::Y, 0, &a).to(1, &b);
    for limits in [[0.5, 0.5], [1.0, -1.0], [f64::NEG_INFINITY, 0.0], [0.0, f64::NAN]] {
        refused(slider.with_limits(limits, 0.5), "limit");
    }
    let spring = Spring { stiffness: 1.0, rest: 0.0, damping: 1.0 };
    refused(good.with_spring(Spring { stiffness: -1.0, ..spring }), "stiffness");
    refused(slider.with_spring(Spring { damping: f64::NAN, ..spring }), "damping");
    refused(slider.with_spring(Spring { rest: f64::INFINITY, ..spring }), "rest");
    refused(good.with_spring(Spring { rest: 3.2, ..spring }), "rest");
    let key = |time: f64, value: f64| Key { time, value, slopes: [0.0; 2] };
    let keys = |keys: Vec<Key<f64>>, catch_up: f64| MotorGoal::Keys {
        track: Track { between: Interpolation::Linear, keys },
        catch_up,
    };
    let unpowered = |joint: Joint, goal: MotorGoal, most: f64, field: &str| {
        let mut world = none();
        world.join(joint).unwrap();
        let error = world.power(0, &Motor { goal, most }).unwrap_err();
        assert!(matches!(error, WorldError::BadJoint { joint: 0, field: f, .. } if f.contains(field)), "{error}");
    };
    unpowered(Joint::ball(DVec3::X * 0.5, 0, &a), MotorGoal::Speed(1.0), 1.0, "number");
    unpowered(good, MotorGoal::Speed(f64::NAN), 1.0, "speed");
    unpowered(good, MotorGoal::Speed(1.0), 0.0, "greatest");
    unpowered(slider, keys(vec![key(0.0, 1.0)], 0.0), 1.0, "catches up");
    unpowered(slider, keys(Vec::new(), 0.1), 1.0, "number of keys");
    unpowered(slider, keys(vec![key(1.0, 1.0), key(1.0, 2.0)], 0.1), 1.0, "time");
    unpowered(slider, keys(vec![key(1.0, f64::NAN)], 0.1), 1.0, "value");
    let at_start = |joint: Joint, starts: [Start; 2], field: &str| {
        let mut world = none();
        world.join(joint).unwrap();
        let error = world.state(&starts).unwrap_err();
        assert!(matches!(error, WorldError::BadJoint { joint: 0, field: f, .. } if f.contains(field)), "{error}");
    };
    at_start(good, [a, Start { position: DVec3::X * 1.001, ..b }], "holds together");
    at_start(good, [a, Start { orientation: DQuat::from_rotation_x(0.01), ..b }], "holds together");
    at_start(good, [a, Start { time: 1.0, ..b }], "start time");
    at_start(good.with_limits([0.2, 1.0], 0.5), [a, b], "angle");
    at_start(slider.with_limits([0.2, 1.0], 0.5), [a, b], "distance at the start");
    at_start(slider, [a, Start { orientation: DQuat::from_rotation_y(0.01), ..b }], "holds together");
    at_start(slider, [a, Start { position: b.position + DVec3::Z * 1e-3, ..b }], "holds together");
    let mut world = none();
    world.join(good).unwrap();
    let mut state = world.state(&[a, b]).unwrap();
    assert!(world.put_to_sleep(&mut state, 0).is_err() && world.put(&mut state, 0, &a).is_err());
    // A body that is taken out is released from its joint.
    world.remove(&mut state, 1).unwrap();
    assert!(!world.is_held(0, &state));
    world.run(&mut state, &mut Scratch::default(), 1.0, &mut ()).unwrap();
    assert!(state.bodies()[0].phase == Phase::Flight && state.bodies()[1].phase == Phase::Gone);
}

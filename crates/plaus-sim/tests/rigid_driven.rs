//! Bodies that are driven by keyframes, and their effect on others.

use glam::{DQuat, DVec3};
use plaus_dist::math;
use plaus_sim::rigid::{
    BodySpec, Interpolation, Key, Keyframes, RigidBodyState, RigidWorld, RigidWorldDesc, Start, StaticShape, Track,
};
use plaus_sim::scenery::Plane;
use plaus_sim::shape::{Cuboid, Frustum, Shape};
use plaus_sim::{Accuracy, Law, Laws, Material, Outcome, Scratch, State, WorldError};

const M: Material = Material(0);
const G: f64 = 9.81;

fn cuboid(x: f64, y: f64, z: f64) -> Shape {
    Shape::Cuboid(Cuboid::new(DVec3::new(x, y, z), 0.0).unwrap())
}

/// Bodies in space, or under gravity, of which the first is driven.
fn world(shapes: &[Shape], law: Law, gravity: f64, keys: &Keyframes) -> RigidWorld {
    let mut world = RigidWorld::new(RigidWorldDesc {
        bodies: shapes.iter().map(|s| BodySpec::solid(s.clone(), 1000.0, M)).collect(),
        parts: Vec::new(),
        laws: Laws::uniform(law).unwrap(),
        gravity: DVec3::NEG_Z * gravity,
        accuracy: Accuracy::default(),
        skin: 1.0,
        sink: f64::NEG_INFINITY,
        duration: 100.0,
    })
    .unwrap();
    world.drive(0, keys).unwrap();
    world
}

fn run(world: &RigidWorld, starts: &[Start], until: f64) -> State<RigidBodyState> {
    let mut state = world.state(starts).unwrap();
    world.run(&mut state, &mut Scratch::default(), until, &mut ()).unwrap();
    state
}

/// A body of a state at a time.
fn at(world: &RigidWorld, state: &State<RigidBodyState>, body: usize, time: f64) -> RigidBodyState {
    world.at(body, &state.bodies()[body], time)
}

fn upright(position: Track<DVec3>) -> Keyframes {
    Keyframes { position, rotation: Track::fixed(DQuat::IDENTITY) }
}

fn straight(velocity: DVec3) -> Keyframes {
    upright(Track::linear([(0.0, DVec3::ZERO), (2.0, velocity * 2.0)]))
}

/// A ball that a paddle hits leaves with `1 + e` times the paddle's speed, however fast and however thin the paddle is;
/// the paddle goes on.
#[test]
fn a_ball_leaves_a_paddle_as_it_leaves_a_moving_wall() {
    for shape in [Shape::Ball(0.02), cuboid(0.04, 0.04, 0.04), Frustum::cylinder(0.02, 0.04).unwrap().into()] {
        for (e, speed) in [(1.0, 1.5), (0.5, 3.0), (0.25, 900.0)] {
            let paddle = cuboid(0.002, 0.3, 0.3);
            let world = world(&[paddle, shape.clone()], Law::new(0.0, e), 0.0, &straight(DVec3::X * speed));
            let state = run(&world, &[Start::at_rest(DVec3::ZERO), Start::at_rest(DVec3::X * 0.5)], 1.0);
            let (v, paddle) = (at(&world, &state, 1, 1.0).path.v, at(&world, &state, 0, 1.0));
            // What the solver of impacts at several points may leave of a speed.
            assert!((v - DVec3::X * ((1.0 + e) * speed)).length() < 1e-8 * speed, "{shape:?} {e} {speed}: {v}");
            assert_eq!((paddle.path.x, paddle.path.v), (DVec3::X * speed, DVec3::X * speed));
        }
    }
}

/// A bar that turns steadily hits with the speed of its point of contact.
#[test]
fn a_turning_bar_hits_with_the_speed_of_its_point_of_contact() {
    let (spin, r) = (7.0, 0.02);
    let turned = |time: f64| (time, DQuat::from_rotation_z(spin * time));
    let keys = Keyframes {
        position: Track::fixed(DVec3::ZERO),
        rotation: Track::linear((0..8).map(|k| turned(f64::from(k) * 0.2))),
    };
    let world = world(&[cuboid(1.0, 0.02, 0.1), Shape::Ball(r)], Law::new(0.0, 0.5), 0.0, &keys);
    // At rest in front of the bar, 0.3 m from its axis when the bar's face arrives.
    let state = run(&world, &[Start::at_rest(DVec3::ZERO), Start::at_rest(DVec3::new(0.3, 0.1, 0.0))], 0.5);
    let v = at(&world, &state, 1, 0.5).path.v;
    // The face's normal when its distance from the ball's centre is a radius: sin α (0.3) − cos α (0.1) = −(r + 0.01).
    let far = (0.3_f64 * 0.3 + 0.1 * 0.1).sqrt();
    let angle = math::atan2(0.1, 0.3) - math::atan2(r + 0.01, (far * far - (r + 0.01) * (r + 0.01)).sqrt());
    let (s, c) = math::sin_cos(angle);
    let normal = DVec3::new(-s, c, 0.0);
    let along = 0.3 * c + 0.1 * s;
    let expected = normal * (1.5 * spin * along);
    // The bar meets it half a gap early.
    assert!((v - expected).length() < 2.0 * Accuracy::default().gap * spin * r, "{v} for {expected}");
}

/// Keys of x = a t²/2.
fn pushed(a: f64, until: f64) -> Keyframes {
    let key = |time: f64| {
        let v = DVec3::X * (a * time);
        Key { time, value: v * (0.5 * time), slopes: [v; 2] }
    };
    upright(Track { between: Interpolation::Cubic, keys: vec![key(0.0), key(0.5 * until), key(until)] })
}

/// A tray that accelerates carries a body that friction can hold on it, and otherwise pulls it with all the friction
/// available.
#[test]
fn a_tray_carries_what_friction_holds() {
    let (mu, until) = (0.4, 0.5);
    for (part, slides) in [(0.5, false), (2.0, true)] {
        let a = part * mu * G;
        let tray = cuboid(4.0, 1.0, 0.02);
        let world = world(&[tray, cuboid(0.06, 0.06, 0.03)], Law::new(mu, 0.0), G, &pushed(a, until));
        let size = 0.015;
        let above = DVec3::Z * (0.01 + 0.015 + 0.5 * Accuracy::default().gap * size);
        let state = run(&world, &[Start::at_rest(DVec3::ZERO), Start::at_rest(above)], until);
        let load = at(&world, &state, 1, until);
        let expected = if slides { mu * G } else { a };
        let way = 0.5 * expected * until * until;
        // Late by the time that the body takes to settle on the tray: a few times √(2 gap / g).
        let late = 4.0 * (2.0 * Accuracy::default().gap * size / G).sqrt();
        assert!((load.path.x.x - way).abs() < expected * until * late, "{} for {way}", load.path.x.x);
        assert!((load.path.v.x - expected * until).abs() < expected * late, "{} slides: {slides}", load.path.v.x);
        assert!((load.path.x.z - above.z).abs() < 2.0 * Accuracy::default().gap * size, "{}", load.path.x.z);
    }
}

/// Between the keys of a cubic, a body is nowhere off the cubic by more than a tenth of the gap at which bodies touch,
/// which is less than the preset's.
#[test]
fn cubics_are_followed() {
    let key = |time: f64, x: [f64; 3], v: [f64; 3]| Key {
        time,
        value: DVec3::from_array(x),
        slopes: [DVec3::from_array(v); 2],
    };
    let keys = [key(0.0, [0.0; 3], [1.0, 0.0, 0.0]), key(0.4, [0.3, 0.2, -0.1], [0.0, 2.0, 1.0])];
    let turn = |time: f64, q: [f64; 4], rate: [f64; 4]| Key {
        time,
        value: DQuat::from_array(q),
        slopes: [DQuat::from_array(rate); 2],
    };
    let turns = [turn(0.0, [0.0, 0.0, 0.0, 1.0], [3.0, 0.0, 0.0, 0.0]), turn(0.4, [0.6, 0.0, 0.8, 0.0], [0.0; 4])];
    let frames = Keyframes {
        position: Track { between: Interpolation::Cubic, keys: keys.to_vec() },
        rotation: Track { between: Interpolation::Cubic, keys: turns.to_vec() },
    };
    let shape = cuboid(0.1, 0.1, 0.1);
    let reach = shape.reach();
    let world = world(&[shape], Law::new(0.3, 0.5), G, &frames);
    let hermite = |part: f64, h: f64, [p, m, q, n]: [f64; 4]| {
        let (s, s2, s3) = (part, part * part, part * part * part);
        (2.0 * s3 - 3.0 * s2 + 1.0) * p + (s3 - 2.0 * s2 + s) * h * m + (3.0 * s2 - 2.0 * s3) * q + (s3 - s2) * h * n
    };
    let bound = 0.1 * Accuracy::default().gap * 0.05;
    for k in 0..=400 {
        let time = f64::from(k) * 1e-3;
        let body = world.at(0, &world.state(&[Start::at_rest(DVec3::ZERO)]).unwrap().bodies()[0], time);
        let part = time / 0.4;
        let value = |i: usize| {
            let [a, b] = [&keys[0], &keys[1]];
            hermite(part, 0.4, [a.value[i], a.slopes[1][i], b.value[i], b.slopes[0][i]])
        };
        let expected = DVec3::new(value(0), value(1), value(2));
        let q = |i: usize| {
            let [a, b] = [&turns[0], &turns[1]].map(|k| [k.value.to_array()[i], k.slopes[0].to_array()[i]]);
            hermite(part, 0.4, [a[0], a[1], b[0], b[1]])
        };
        let turned = DQuat::from_xyzw(q(0), q(1), q(2), q(3)).normalize();
        let off = (body.path.x - expected).length() + body.turn.angle_between(turned) * reach;
        // angle_between knows angles near 0 to the root of rounding.
        assert!(off < bound + 4e-8 * reach, "{off} at {time}");
    }
    let end = world.at(0, &world.state(&[Start::at_rest(DVec3::ZERO)]).unwrap().bodies()[0], 5.0);
    assert_eq!((end.path.x, end.path.v), (keys[1].value, DVec3::ZERO));
}

/// A body that lies on a standing lift is at rest, goes up with the lift, and comes to rest again; with the same bits
/// whether the run is paused or not.
#[test]
fn a_lift_carries_up_a_body_that_lies_on_it() {
    let track = Track::linear([(0.0, DVec3::ZERO), (2.0, DVec3::ZERO), (3.0, DVec3::Z * 0.2)]);
    let plate = cuboid(0.3, 0.3, 0.02);
    let shapes = [plate, cuboid(0.05, 0.05, 0.05), Frustum::cylinder(0.02, 0.04).unwrap().into()];
    let world = world(&shapes, Law::new(0.5, 0.2), G, &upright(track));
    let place = |x: f64, z: f64| Start::at_rest(DVec3::new(x, 0.0, z));
    let starts = [place(0.0, 0.0), place(-0.08, 0.04), place(0.08, 0.035)];
    let mut whole = world.state(&starts).unwrap();
    let outcome = world.run(&mut whole, &mut Scratch::default(), 10.0, &mut ()).unwrap();
    assert_eq!(outcome, Outcome::AllAtRest);
    for (k, half) in [(1, 0.025), (2, 0.02)] {
        let z = whole.bodies()[k].path.x.z;
        assert!((z - 0.21 - half).abs() < Accuracy::default().gap * 0.02, "body {k} at {z}");
    }
    let mut paused = world.state(&starts).unwrap();
    for time in [0.05, 1.0, 2.5, 10.0] {
        world.run(&mut paused, &mut Scratch::default(), time, &mut ()).unwrap();
    }
    for (a, b) in whole.bodies().iter().zip(paused.bodies()) {
        assert_eq!((a.path, a.turn), (b.path, b.turn));
    }
}

#[test]
fn bad_keys_are_named() {
    let refused = |position: Track<DVec3>, rotation: Track<DQuat>| {
        let mut world = world(&[Shape::Ball(0.1)], Law::new(0.3, 0.5), G, &straight(DVec3::X));
        world.drive(0, &Keyframes { position, rotation }).unwrap_err()
    };
    let still = || Track::fixed(DQuat::IDENTITY);
    for times in [[0.0, 1.0, 1.0], [0.0, 2.0, 1.0], [0.0, 1.0, f64::NAN], [0.0, 1.0, f64::INFINITY]] {
        let error = refused(Track::linear(times.map(|t| (t, DVec3::ZERO))), still());
        assert!(
            matches!(error, WorldError::BadKey { body: 0, track: "position", key: 2, field: "time", .. }),
            "{error}"
        );
    }
    let error = refused(Track::linear([(-1.0, DVec3::ZERO)]), still());
    assert!(matches!(error, WorldError::BadKey { key: 0, field: "time", .. }), "{error}");
    let error = refused(Track::linear([(0.0, DVec3::ZERO), (1.0, DVec3::X * f64::NAN)]), still());
    assert!(matches!(error, WorldError::BadKey { key: 1, field: "value", .. }), "{error}");
    let error = refused(Track::fixed(DVec3::ZERO), Track::fixed(DQuat::from_xyzw(0.0, 0.0, 0.0, 0.0)));
    assert!(matches!(error, WorldError::BadKey { track: "rotation", key: 0, field: "length", .. }), "{error}");
    let error = refused(Track { between: Interpolation::Linear, keys: Vec::new() }, still());
    assert!(matches!(error, WorldError::BadKey { field: "number of keys", .. }), "{error}");
    let mut world = world(&[Shape::Ball(0.1)], Law::new(0.3, 0.5), G, &straight(DVec3::X));
    assert!(world.drive(1, &straight(DVec3::X)).is_err());
}

/// Driven bodies go through fixed parts.
#[test]
fn a_driven_body_ignores_fixed_parts() {
    let mut world = RigidWorld::new(RigidWorldDesc {
        bodies: vec![BodySpec::solid(cuboid(0.1, 0.1, 0.1), 1000.0, M)],
        parts: vec![StaticShape::Plane(Plane::new(DVec3::ZERO, DVec3::Z, M).unwrap())],
        laws: Laws::uniform(Law::new(0.3, 0.5)).unwrap(),
        gravity: DVec3::NEG_Z * G,
        accuracy: Accuracy::default(),
        skin: 1.0,
        sink: -0.5,
        duration: 100.0,
    })
    .unwrap();
    world.drive(0, &straight(DVec3::NEG_Z)).unwrap();
    let state = run(&world, &[Start::at_rest(DVec3::ZERO)], 2.0);
    assert_eq!(at(&world, &state, 0, 2.0).path.x, DVec3::NEG_Z * 2.0);
}

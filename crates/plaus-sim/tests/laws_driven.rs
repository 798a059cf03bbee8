//! Laws of bodies that follow random keys, about any of their points: the point is where the keys have it, whatever is
//! struck feels the velocity that the keys say, and a smooth motion costs what a straight one does. The wrong twin's
//! centre of gravity goes from key to key instead, and is caught.

use crate::common::zoo::{Body, Dice, G, M};
use glam::{DQuat, DVec3, DVec4};
use plaus_dist::math;
use plaus_sim::mechanics::Other;
use plaus_sim::rigid::{
    BodySpec, Interpolation, Key, Keyframes, RigidWorld, RigidWorldDesc, Start, StaticShape, Track,
};
use plaus_sim::scenery::Plane;
use plaus_sim::shape::{Compound, Convex, Cuboid, Member, Shape};
use plaus_sim::trace::Trace;
use plaus_sim::{Law, Laws, Scratch, WorldError};

const MODES: [Interpolation; 3] = [Interpolation::Step, Interpolation::Linear, Interpolation::Cubic];

fn world(shapes: &[Shape], law: Law, gravity: f64, keys: &Keyframes) -> RigidWorld {
    let mut world = RigidWorld::new(RigidWorldDesc {
        bodies: shapes.iter().map(|s| BodySpec::solid(s.clone(), 1000.0, M)).collect(),
        laws: Laws::uniform(law).unwrap(),
        gravity: DVec3::NEG_Z * gravity,
        duration: 10.0,
        ..RigidWorldDesc::default()
    })
    .unwrap();
    world.drive(0, keys).unwrap();
    world
}

/// Keys of a few tenths of a second and metre, with turns up to about a right angle between two.
fn keys(dice: &mut Dice, [places, turns]: [Interpolation; 2]) -> Keyframes {
    let count = 2 + (dice.between(0.0, 3.0) as usize);
    let mut times = vec![dice.between(0.0, 0.2)];
    for _ in 1..count {
        times.push(times[times.len() - 1] + dice.between(0.05, 0.4));
    }
    let slope = |dice: &mut Dice| [dice.in_cube() * 0.5, dice.in_cube() * 0.5];
    let place = |&time: &f64| Key { time, value: dice.in_cube() * 0.2, slopes: slope(dice) };
    let position = Track { between: places, keys: times.iter().map(place).collect() };
    let mut turn = dice.turn();
    let turned = |&time: &f64| {
        turn = (DQuat::from_scaled_axis(dice.in_cube()) * turn).normalize();
        let rate = |dice: &mut Dice| DQuat::from_vec4(dice.in_cube().extend(dice.between(-1.0, 1.0)));
        Key { time, value: turn, slopes: [rate(dice), rate(dice)] }
    };
    Keyframes { position, rotation: Track { between: turns, keys: times.iter().map(turned).collect() } }
}

/// A body about one of its points; of a body of revolution, one of its axis.
fn off_centre(dice: &mut Dice, body: Body) -> (Shape, DVec3) {
    let point = dice.in_cube() * 0.06;
    let point = if body == Body::Pin { DVec3::Z * point.z } else { point };
    (body.shape().about(point).unwrap(), point)
}

/// Where the keys have the origin, and how they turn the body: the formulas as a textbook has them.
fn truth(keys: &Keyframes, time: f64) -> (DVec3, DQuat) {
    fn around<T: Copy>(track: &Track<T>, time: f64) -> (Key<T>, Key<T>, f64) {
        let after = track.keys.iter().position(|k| k.time > time);
        let (a, b) = match after {
            Some(0) => (0, 0),
            Some(k) => (k - 1, k),
            None => (track.keys.len() - 1, track.keys.len() - 1),
        };
        let (a, b) = (track.keys[a], track.keys[b]);
        (a, b, if b.time > a.time { (time - a.time) / (b.time - a.time) } else { 0.0 })
    }
    let hermite = |h: f64, s: f64, p: DVec4, m: DVec4, q: DVec4, n: DVec4| {
        let (s2, s3) = (s * s, s * s * s);
        p * (2.0 * s3 - 3.0 * s2 + 1.0)
            + m * (h * (s3 - 2.0 * s2 + s))
            + q * (3.0 * s2 - 2.0 * s3)
            + n * (h * (s3 - s2))
    };
    let (a, b, s) = around(&keys.position, time);
    let place = match keys.position.between {
        Interpolation::Step => a.value,
        Interpolation::Linear => a.value.lerp(b.value, s),
        Interpolation::Cubic => {
            let [p, m, q, n] = [a.value, a.slopes[1], b.value, b.slopes[0]].map(|v| v.extend(0.0));
            hermite(b.time - a.time, s, p, m, q, n).truncate()
        }
    };
    let (a, b, s) = around(&keys.rotation, time);
    let sign = if a.value.dot(b.value) < 0.0 { -1.0 } else { 1.0 };
    let turn = match keys.rotation.between {
        Interpolation::Step => a.value,
        Interpolation::Linear => {
            let step = b.value * a.value.conjugate() * sign;
            let (axis, angle) = (step.xyz(), 2.0 * math::atan2(step.xyz().length(), step.w));
            DQuat::from_scaled_axis(axis.normalize_or_zero() * (angle * s)) * a.value
        }
        Interpolation::Cubic => {
            let [p, m, q, n] =
                [a.value, a.slopes[1], b.value * sign, b.slopes[0] * sign].map(|q| DVec4::from_array(q.to_array()));
            DQuat::from_vec4(hermite(b.time - a.time, s, p, m, q, n)).normalize()
        }
    };
    (place, turn)
}

/// The wrong twin: keys of the centre of gravity, which is `centre` from the origin.
fn twin(keys: &Keyframes, centre: DVec3) -> Keyframes {
    let mut wrong = keys.clone();
    for (place, turn) in wrong.position.keys.iter_mut().zip(&keys.rotation.keys) {
        place.value += turn.value * centre;
    }
    wrong
}

/// Where a point of the body is that is `arm` from what the keys move.
fn point(keys: &Keyframes, time: f64, arm: DVec3) -> DVec3 {
    let (place, turn) = truth(keys, time);
    place + turn * arm
}

/// Times of a motion, none of them at a key.
fn times(keys: &Keyframes, count: u32) -> impl Iterator<Item = f64> {
    let end = keys.position.keys[keys.position.keys.len() - 1].time + 0.1;
    (0..count).map(move |k| end * (f64::from(k) + 0.37) / f64::from(count))
}

/// All points of a body are where the keys have them, to rounding: numbers of about 1 from some tens of operations.
#[test]
fn bodies_turn_about_what_their_keys_move() {
    let mut caught = 0;
    for nth in 0..400 {
        let mut dice = Dice::new(45, nth);
        let modes = [MODES[nth as usize % 3], MODES[nth as usize / 3 % 3]];
        let keys = keys(&mut dice, modes);
        let (shape, at) = off_centre(&mut dice, Body::ALL[nth as usize % 13]);
        let arm = dice.in_cube() * shape.reach();
        let world = world(&[shape], Law::new(0.3, 0.5), 0.0, &keys);
        let state = world.state(&[Start::at_rest(DVec3::ZERO)]).unwrap();
        let wrong = twin(&keys, -at);
        let (mut off, mut off_of_twin) = (0.0_f64, 0.0_f64);
        let at_keys = keys.position.keys.iter().map(|key| key.time);
        for time in at_keys.chain(times(&keys, 40)) {
            let body = world.at(0, &state.bodies()[0], time);
            let expected = point(&keys, time, arm);
            off = off.max((body.path.x + body.turn * arm - expected).length());
            off_of_twin = off_of_twin.max((point(&wrong, time, at + arm) - expected).length());
        }
        assert!(off < 1e-13, "{nth}, {modes:?}: {off}");
        caught += u32::from(off_of_twin > 1e-4);
    }
    // Where neither turns between keys, or both are on steps, the twins move alike.
    assert!(caught > 200, "only {caught}");
}

/// What a driven body strikes feels the velocity of the struck point: the difference of the keys' own motion over 2 µs.
#[test]
fn impacts_feel_the_velocity_of_the_struck_point() {
    let (mut hits, mut caught) = (0, 0);
    for nth in 0..1000 {
        let mut dice = Dice::new(46, nth);
        let modes = [MODES[1 + nth as usize % 2], MODES[1 + nth as usize / 2 % 2]];
        let keys = keys(&mut dice, modes);
        let (shape, at) = off_centre(&mut dice, Body::ALL[nth as usize / 4 % 13]);
        let e = 0.7;
        // On the way of a point of the body.
        let (when, arm) = (dice.between(0.1, 0.9), dice.in_cube() * (0.7 * shape.reach()));
        let when = when * keys.position.keys[keys.position.keys.len() - 1].time;
        let place = point(&keys, when, arm);
        let world = world(&[shape, Shape::Ball(0.006)], Law::new(0.3, e), 0.0, &keys);
        let Ok(mut state) = world.state(&[Start::at_rest(DVec3::ZERO), Start::at_rest(place)]) else { continue };
        let mut trace = Trace::default();
        world.run(&mut state, &mut Scratch::default(), 3.0, &mut trace).unwrap();
        let Some(hit) = trace.impacts.first().filter(|hit| !hit.lasting) else { continue };
        assert_eq!((hit.body, hit.other), (0, Other::Body(1)));
        let step = 1e-6;
        if keys.position.keys.iter().any(|key| (key.time - hit.time).abs() < 2.0 * step) {
            continue;
        }
        let felt = |keys: &Keyframes, shift: DVec3| {
            let (place, turn) = truth(keys, hit.time);
            let arm = turn.conjugate() * (hit.point + turn * shift - place);
            (point(keys, hit.time + step, arm) - point(keys, hit.time - step, arm)) / (2.0 * step)
        };
        let v = felt(&keys, DVec3::ZERO);
        let approach = -v.dot(hit.normal);
        // The difference is off by the rounding of places over 2 µs, and by v‴ h²/6: up to 1e4 m/s³ times 1e-13 s².
        let tolerance = 2e-9 * (1.0 + v.length());
        assert!((hit.approach - approach).abs() < tolerance, "{nth}, {modes:?}: {} for {approach}", hit.approach);
        let mass = 1000.0 * 4.0 / 3.0 * std::f64::consts::PI * 0.006 * 0.006 * 0.006;
        let gained = -hit.impulse.dot(hit.normal) / mass;
        let expected = -(1.0 + e) * approach;
        assert!((gained.abs() - expected.abs()).abs() < 1e-6 * expected.abs(), "{nth}: {gained} for {expected}");
        hits += 1;
        caught += u32::from((-felt(&twin(&keys, -at), DVec3::ZERO).dot(hit.normal) - approach).abs() > tolerance);
    }
    assert!(hits > 150 && caught > hits * 9 / 10, "{hits} hits, {caught} caught");
}

/// A flipper about its end strikes a light ball with the speed of the struck point; one about its centre of gravity,
/// whose end goes from the same key to the same key, is 5 % off.
#[test]
fn a_flipper_strikes_with_its_own_speed() {
    let (end, e, r) = (60_f64.to_radians(), 0.8, 0.0135);
    let flipper = Shape::Cuboid(Cuboid::new(DVec3::new(0.08, 0.008, 0.04), 0.0).unwrap());
    let turned = |time: f64, angle: f64| (time, DQuat::from_rotation_z(angle));
    let keys = Keyframes {
        position: Track::linear([(0.1, DVec3::ZERO), (0.12, DVec3::ZERO)]),
        rotation: Track::linear([turned(0.1, 0.0), turned(0.12, end)]),
    };
    let (s, c) = math::sin_cos(50_f64.to_radians());
    let ball = DVec3::new(c, s, 0.0) * 0.062;
    let speed = |shape: Shape, keys: &Keyframes| {
        let world = world(&[shape, Shape::Ball(r)], Law::new(0.0, e), 0.0, keys);
        let mut state = world.state(&[Start::at_rest(DVec3::ZERO), Start::at_rest(ball)]).unwrap();
        world.run(&mut state, &mut Scratch::default(), 0.3, &mut ()).unwrap();
        world.at(1, &state.bodies()[1], 0.3).path.v.length()
    };
    let middle = DVec3::X * 0.04;
    // The face is 4 mm off the axis: the ball touches it where it has its centre a radius farther off.
    let lever = (0.062_f64 * 0.062 - (r + 0.004) * (r + 0.004)).sqrt();
    let expected = (1.0 + e) * (end / 0.02) * lever;
    let found = speed(flipper.about(-middle).unwrap(), &keys);
    // The flipper meets it a gap early, of 1e-5 of 4 mm.
    assert!((found / expected - 1.0).abs() < 1e-5, "{found} for {expected}");
    let wrong = speed(flipper, &twin(&keys, middle));
    assert!((wrong / expected - 1.0).abs() > 0.05, "{wrong} for {expected}");
}

/// Tracks through places and turns that begin and end gently.
fn smooth(between: Interpolation, places: &[(f64, DVec3)], turns: &[(f64, DQuat)]) -> Keyframes {
    let still = DQuat::from_xyzw(0.0, 0.0, 0.0, 0.0);
    let place = |&(time, value): &(f64, DVec3)| Key { time, value, slopes: [DVec3::ZERO; 2] };
    let turn = |&(time, value): &(f64, DQuat)| Key { time, value, slopes: [still; 2] };
    Keyframes {
        position: Track { between, keys: places.iter().map(place).collect() },
        rotation: Track { between, keys: turns.iter().map(turn).collect() },
    }
}

/// A box on a board that turns and slides smoothly goes with it, as far as friction can take it.
#[test]
fn a_board_carries_what_lies_on_it() {
    let board = Shape::Cuboid(Cuboid::new(DVec3::new(0.3, 0.1, 0.01), 0.0).unwrap());
    let load = Shape::Cuboid(Cuboid::new(DVec3::new(0.03, 0.03, 0.02), 0.0).unwrap());
    // About a point 0.2 m beside its middle, so that its middle swings by 0.2 m.
    let board = board.about(DVec3::new(-0.2, 0.0, 0.0)).unwrap();
    let (start, end) = (DVec3::new(0.2, 0.0, 0.015), DQuat::from_rotation_z(1.0));
    let turns = [(0.2, DQuat::IDENTITY), (1.2, end)];
    let keys = smooth(Interpolation::Cubic, &[(0.2, DVec3::ZERO), (1.2, DVec3::Y * 0.1)], &turns);
    let world = world(&[board, load], Law::new(0.6, 0.0), G, &keys);
    let gap = 0.5e-5 * 0.005;
    let mut state = world.state(&[Start::at_rest(DVec3::ZERO), Start::at_rest(start + DVec3::Z * gap)]).unwrap();
    world.run(&mut state, &mut Scratch::default(), 5.0, &mut ()).unwrap();
    let at = world.at(1, &state.bodies()[1], 5.0);
    // Velocities below the preset's slowest slip are as good as none: 1 s of 1e-5 m/s.
    let expected = end * start + DVec3::Y * 0.1;
    assert!((at.path.x - expected).truncate().length() < 1e-5, "{} for {expected}", at.path.x);
    assert!(at.turn.angle_between(end) < 1e-3, "{}", at.turn);
}

/// A smooth motion has hardly more events than a straight one. Steps may be cut where a search's view of it ends.
#[test]
fn smooth_motions_cost_what_straight_ones_do() {
    let cuboid = |x: f64, y: f64, z: f64| Convex::Cuboid(Cuboid::new(DVec3::new(x, y, z), 0.0).unwrap());
    let spoon = Shape::from(
        Compound::new(&[
            Member::new(cuboid(0.06, 0.06, 0.003), DVec3::ZERO),
            Member::new(cuboid(0.12, 0.01, 0.003), DVec3::new(-0.09, 0.0, 0.0)),
        ])
        .unwrap(),
    );
    let turned = |x: f64, y: f64| DQuat::from_rotation_y(y) * DQuat::from_rotation_x(x);
    let turns = [(0.3, turned(0.0, 0.0)), (1.0, turned(0.08, -0.1)), (1.8, turned(-0.1, 0.05)), (2.6, DQuat::IDENTITY)];
    let places = [(0.3, 0.0), (1.0, 0.2), (1.8, 0.4), (2.6, 0.6)].map(|(t, x)| (t, DVec3::X * x));
    let load = Shape::from(
        Compound::new(&[
            Member::new(Convex::Ball(0.02), DVec3::ZERO),
            Member::new(Convex::Ball(0.013), DVec3::X * 0.018),
            Member::new(cuboid(0.05, 0.03, 0.03), DVec3::NEG_Z * 0.006),
        ])
        .unwrap(),
    );
    let events = |between: Interpolation| {
        let shapes = [spoon.clone(), load.clone()];
        let world = world(&shapes, Law::new(0.9, 0.3), G, &smooth(between, &places, &turns));
        let start = Start::at_rest(DVec3::new(0.02, 0.0, 0.03));
        let mut state = world.state(&[Start::at_rest(DVec3::ZERO), start]).unwrap();
        world.run(&mut state, &mut Scratch::default(), 2.6, &mut ()).unwrap();
        state.counts().events
    };
    let [straight, smooth] = [Interpolation::Linear, Interpolation::Cubic].map(events);
    assert!(2 * smooth < 3 * straight, "{smooth} events, and {straight} where it is straight");
}

/// Only a driven body may be about another point than its centre of gravity, and a body of revolution only about one of
/// its axis.
#[test]
fn what_cannot_be_about_a_point_is_refused() {
    let shape = Body::Cone.shape().about(DVec3::X * 0.01).unwrap();
    let parts = vec![StaticShape::Plane(Plane::new(DVec3::NEG_Z, DVec3::Z, M).unwrap())];
    let bodies = vec![BodySpec::solid(shape, 1000.0, M)];
    let world = RigidWorld::new(RigidWorldDesc { bodies, parts, ..RigidWorldDesc::default() }).unwrap();
    let error = world.state(&[Start::at_rest(DVec3::ZERO)]).unwrap_err();
    assert!(matches!(error, WorldError::BadBody { body: 0, .. }), "{error}");
    assert!(Body::Pin.shape().about(DVec3::X * 0.01).is_err());
    assert!(Body::Ball.shape().about(DVec3::X * f64::NAN).is_err());
}

//! A ball on a lane against the closed form: sliding into rolling, and the hook under oil and dry boards.

use glam::DVec3;
use plaus_sim::rigid::{BodySpec, Part, Phase, Rigid, RigidWorld, Start, Stretch};
use plaus_sim::scenery::Aabb;
use plaus_sim::shape::{MassProperties, Shape};
use plaus_sim::{Accuracy, Law, Laws, Material, Preset, Scratch};

const G: f64 = 9.81;
const RADIUS: f64 = 0.1085;
const MASS: f64 = 6.8;
const GYRATION: f64 = 0.066;

fn lane(stretches: Vec<Stretch>, gyration: f64) -> Rigid {
    let bounds = Aabb { min: DVec3::new(-5.0, -1.0, -1.0), max: DVec3::new(5.0, 100.0, 0.0) };
    let mass = MassProperties { mass: MASS, inertia: DVec3::splat(MASS * gyration * gyration) };
    Rigid::new(RigidWorld {
        bodies: vec![BodySpec { shape: Shape::Ball(RADIUS), mass, material: Material(0) }],
        parts: vec![Part::Block { bounds, material: Material(0), stretches }],
        laws: Laws::uniform(Law::new(0.1, 0.3)).unwrap(),
        gravity: DVec3::new(0.0, 0.0, -G),
        accuracy: Accuracy::preset(Preset::Standard),
        skin: 1.0,
        sink: f64::NEG_INFINITY,
        duration: 60.0,
    })
    .unwrap()
}

fn start(velocity: DVec3, spin: DVec3) -> Start {
    Start { velocity, spin, ..Start::at_rest(DVec3::new(0.0, 0.0, RADIUS)) }
}

/// PHYSICS: t = 2 v₀/(7 μ g), v = 5 v₀/7, x = 12 v₀²/(49 μ g); rounding of a handful of operations.
#[test]
fn a_sliding_solid_ball_comes_to_roll() {
    let world = lane(Vec::new(), RADIUS * 0.4_f64.sqrt());
    let v0 = 3.0;
    let mut state = world.state(&[start(DVec3::new(0.0, v0, 0.0), DVec3::ZERO)]).unwrap();
    let t = 2.0 * v0 / (7.0 * 0.1 * G);
    world.run(&mut state, &mut Scratch::default(), t + 0.5, &mut ()).unwrap();
    let body = &state.bodies()[0];
    assert_eq!(body.phase, Phase::Glide);
    assert!((body.path.t / t - 1.0).abs() < 1e-13, "{} for {t}", body.path.t);
    assert!((body.path.v.y / (5.0 * v0 / 7.0) - 1.0).abs() < 1e-13);
    assert!((body.path.x.y / (12.0 * v0 * v0 / (49.0 * 0.1 * G)) - 1.0).abs() < 1e-13);
    let end = world.at(0, body, t + 0.5);
    assert!((end.path.v + end.spin.cross(DVec3::new(0.0, 0.0, -RADIUS))).length() < 1e-13);
}

/// The same formulas, applied by hand stretch by stretch.
fn by_hand(mut x: DVec3, mut v: DVec3, mut w: DVec3, stretches: &[(f64, f64)], until: f64) -> (DVec3, DVec3, DVec3) {
    let n = DVec3::Z;
    let stiff = 1.0 + RADIUS * RADIUS / (GYRATION * GYRATION);
    let mut left = until;
    for (k, &(_, mu)) in stretches.iter().enumerate() {
        let end = stretches.get(k + 1).map_or(f64::INFINITY, |s| s.0);
        for _ in 0..2 {
            let u = v - w.cross(n) * RADIUS;
            let (a, turn, stop) = if u.length() > 1e-12 {
                let d = u / u.length();
                (d * (-mu * G), n.cross(d) * (mu * G * RADIUS / (GYRATION * GYRATION)), u.length() / (mu * G * stiff))
            } else {
                (DVec3::ZERO, DVec3::ZERO, f64::INFINITY)
            };
            // y + v t + a t²/2 = end, by the formula that does not cancel for small a.
            let gap = end - x.y;
            let line =
                if end.is_finite() { 2.0 * gap / (v.y + (v.y * v.y + 2.0 * a.y * gap).sqrt()) } else { f64::INFINITY };
            let dt = line.min(stop).min(left);
            x += v * dt + a * (0.5 * dt * dt);
            v += a * dt;
            w += turn * dt;
            left -= dt;
            if left == 0.0 || dt == line {
                break;
            }
        }
        if left == 0.0 {
            break;
        }
    }
    (x, v, w)
}

#[test]
fn a_hook_under_oil_and_dry_boards() {
    let map = vec![Stretch { from: -1.0, friction: Some(0.04) }, Stretch { from: 12.0, friction: Some(0.20) }];
    let world = lane(map, GYRATION);
    // A right-hander's release: 8 m/s, 30 rad/s mostly sideways.
    let (v, w) = (DVec3::new(0.25, 8.0, 0.0), DVec3::new(-12.0, -27.0, 6.0));
    for until in [0.8, 1.5, 1.7, 2.0, 2.5] {
        let mut state = world.state(&[start(v, w)]).unwrap();
        world.run(&mut state, &mut Scratch::default(), until, &mut ()).unwrap();
        let body = world.at(0, &state.bodies()[0], until);
        let (x, v, w) = by_hand(DVec3::new(0.0, 0.0, RADIUS), v, w, &[(-1.0, 0.04), (12.0, 0.20)], until);
        assert!((body.path.x - x).length() <= 1e-12 * x.length(), "{} for {x} at {until}", body.path.x);
        assert!((body.path.v - v).length() <= 1e-12 * v.length(), "{} for {v} at {until}", body.path.v);
        assert!((body.spin - w).length() <= 1e-12 * w.length(), "{} for {w} at {until}", body.spin);
    }
}

#[test]
fn the_mirrored_ball_runs_the_mirrored_path() {
    let map = vec![Stretch { from: -1.0, friction: Some(0.04) }, Stretch { from: 12.0, friction: Some(0.20) }];
    let world = lane(map, GYRATION);
    let end = |side: f64| {
        let (v, w) = (DVec3::new(side * 0.25, 8.0, 0.0), DVec3::new(-12.0, side * -27.0, side * 6.0));
        let mut state = world.state(&[start(v, w)]).unwrap();
        world.run(&mut state, &mut Scratch::default(), 2.4, &mut ()).unwrap();
        world.at(0, &state.bodies()[0], 2.4).path.x
    };
    let (left, right) = (end(1.0), end(-1.0));
    assert_eq!((left.x, left.y, left.z), (-right.x, right.y, right.z));
}

#[test]
fn a_ball_that_leaves_the_lane_falls() {
    let world = lane(Vec::new(), GYRATION);
    let mut state = world.state(&[start(DVec3::new(4.0, 0.0, 0.0), DVec3::ZERO)]).unwrap();
    world.run(&mut state, &mut Scratch::default(), 5.0, &mut ()).unwrap();
    let body = world.at(0, &state.bodies()[0], 5.0);
    assert!(body.path.x.x > 5.0 && body.path.x.z < -1.0, "{}", body.path.x);
}

//! A ball on a lane against the closed form: sliding into rolling, and the hook under oil and dry boards.

use glam::DVec3;
use plaus_sim::field::{Grid, Spline};
use plaus_sim::rigid::{BodySpec, Phase, RigidWorld, RigidWorldDesc, Section, Start, StaticShape, StaticSolid, Table};
use plaus_sim::scenery::{Aabb, Mesh, Plane};
use plaus_sim::shape::{Cuboid, MassProperties, Shape};
use plaus_sim::{Accuracy, Law, Laws, Material, Outcome, Preset, Scratch};
use std::sync::Arc;

const G: f64 = 9.81;
const RADIUS: f64 = 0.1085;
const MASS: f64 = 6.8;
const GYRATION: f64 = 0.066;

fn lane(sections: Vec<Section>, gyration: f64) -> RigidWorld {
    on(block(sections), gyration, Law::new(0.1, 0.3))
}

fn block(sections: Vec<Section>) -> StaticShape {
    let bounds = Aabb { min: DVec3::new(-5.0, -1.0, -1.0), max: DVec3::new(5.0, 100.0, 0.0) };
    StaticShape::Block { bounds, material: Material(0), sections }
}

fn on(part: StaticShape, gyration: f64, law: Law) -> RigidWorld {
    let mass = MassProperties { mass: MASS, inertia: DVec3::splat(MASS * gyration * gyration) };
    RigidWorld::new(RigidWorldDesc {
        bodies: vec![BodySpec { shape: Shape::Ball(RADIUS), mass, material: Material(0) }],
        parts: vec![part],
        laws: Laws::uniform(law).unwrap(),
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
fn a_sliding_solid_ball_begins_to_roll() {
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

/// The same formulas, applied by hand section by section.
fn by_hand(mut x: DVec3, mut v: DVec3, mut w: DVec3, sections: &[(f64, f64)], until: f64) -> (DVec3, DVec3, DVec3) {
    let n = DVec3::Z;
    let stiff = 1.0 + RADIUS * RADIUS / (GYRATION * GYRATION);
    let mut left = until;
    for (k, &(_, mu)) in sections.iter().enumerate() {
        let end = sections.get(k + 1).map_or(f64::INFINITY, |s| s.0);
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
    let map = vec![Section { from: -1.0, friction: Some(0.04) }, Section { from: 12.0, friction: Some(0.20) }];
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
    let map = vec![Section { from: -1.0, friction: Some(0.04) }, Section { from: 12.0, friction: Some(0.20) }];
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

/// Ground of every kind, level at height 0.
fn grounds() -> [(&'static str, StaticShape); 5] {
    let corners = [[-9.0, -9.0], [90.0, -9.0], [90.0, 90.0], [-9.0, 90.0]].map(|[x, y]| DVec3::new(x, y, 0.0));
    let mesh = Mesh::new(corners.to_vec(), &[([0, 1, 2], Material(0)), ([0, 2, 3], Material(0))], 0.0).unwrap();
    let slab = Shape::Cuboid(Cuboid::new(DVec3::new(200.0, 200.0, 1.0), 0.0).unwrap());
    let at = DVec3::NEG_Z * 0.5;
    let solid = StaticSolid { shape: slab, at, turn: glam::DQuat::IDENTITY, material: Material(0) };
    let table = Spline::new("height", Grid { origin: [0.0; 2], spacing: 0.5 }, [-1.0, 1.0], |_, _| 0.0).unwrap();
    [
        ("plane", StaticShape::Plane(Plane::new(DVec3::ZERO, DVec3::Z, Material(0)).unwrap())),
        ("block", block(Vec::new())),
        ("solid", StaticShape::Solid(Box::new(solid))),
        ("mesh", StaticShape::Mesh(Arc::new(mesh))),
        ("table", StaticShape::Table(Box::new(Table::new(table, Material(0))))),
    ]
}

/// A torque of c m g R against a rolling ball slows it by c g/(1 + k), where k = I/(m R²): it rolls out over
/// `v²(1 + k)/(2 c g)` in `v (1 + k)/(c g)`. This is exact to rounding on planes and boxes. Elsewhere there are steps
/// of 0.4 √(R/g) at the standard preset, at whose ends the resistance acts: it is late by at most one step, in which
/// the ball goes 1 % of the way. Two steps after that, the ball is known to rest.
#[test]
fn a_rolling_ball_comes_to_rest_where_resistance_says() {
    let (c, v) = (0.02, 1.2);
    let more = 1.0 + GYRATION * GYRATION / (RADIUS * RADIUS);
    let (way, time) = (v * v * more / (2.0 * c * G), v * more / (c * G));
    for (name, part) in grounds() {
        let world = on(part, GYRATION, Law::new(0.1, 0.3).with_resistance(c, 0.0));
        let rolling = start(DVec3::Y * v, DVec3::NEG_X * (v / RADIUS));
        let mut state = world.state(&[rolling]).unwrap();
        let outcome = world.run(&mut state, &mut Scratch::default(), 60.0, &mut ()).unwrap();
        let body = &state.bodies()[0];
        let is_exact = matches!(name, "plane" | "block");
        let (within, late) = if is_exact { (1e-12, 1e-12 * time) } else { (0.01, 1.2 * (RADIUS / G).sqrt()) };
        assert_eq!(outcome, Outcome::AllAtRest, "{name}: {} after {} events", body.path.v, state.counts().events);
        assert!((body.path.x.y / way - 1.0).abs() < within, "{name}: {} for {way}", body.path.x.y);
        assert!((body.path.t - time).abs() < late, "{name}: {} for {time}", body.path.t);
        assert!(body.path.v == DVec3::ZERO && body.spin == DVec3::ZERO, "{name}: {} {}", body.path.v, body.spin);
    }
}

/// First sliding, as without resistance, and rolling after that as above. If resistance is at least friction, a ball
/// that does not turn slides to a stop: `v²/(2 µ g)`.
#[test]
fn a_ball_that_slides_and_then_rolls_comes_to_rest() {
    let (mu, c, v) = (0.1, 0.02, 1.2);
    let plane = || StaticShape::Plane(Plane::new(DVec3::ZERO, DVec3::Z, Material(0)).unwrap());
    let rest = |law: Law| {
        let world = on(plane(), RADIUS * 0.4_f64.sqrt(), law);
        let mut state = world.state(&[start(DVec3::Y * v, DVec3::ZERO)]).unwrap();
        let outcome = world.run(&mut state, &mut Scratch::default(), 60.0, &mut ()).unwrap();
        assert_eq!(outcome, Outcome::AllAtRest);
        state.bodies()[0].path.x.y
    };
    let rolling = 5.0 * v / 7.0;
    let way = 12.0 * v * v / (49.0 * mu * G) + rolling * rolling * 1.4 / (2.0 * c * G);
    let found = rest(Law::new(mu, 0.3).with_resistance(c, 0.0));
    assert!((found / way - 1.0).abs() < 1e-12, "{found} for {way}");
    let (found, way) = (rest(Law::new(mu, 0.3).with_resistance(mu, 0.0)), v * v / (2.0 * mu * G));
    assert!((found / way - 1.0).abs() < 1e-12, "{found} for {way}");
}

/// A spin about the normal ends after `ω k R/(σ g)`, whether the ball is still rolling or standing by then.
#[test]
fn a_spin_about_the_normal_ends() {
    let (sigma, w) = (0.03, 25.0);
    let time = w * GYRATION * GYRATION / (RADIUS * sigma * G);
    for (v, c) in [(0.0, 0.02), (0.5, 0.0), (0.5, 0.02)] {
        let law = Law::new(0.1, 0.3).with_resistance(c, sigma);
        let world = on(block(Vec::new()), GYRATION, law);
        let spin = DVec3::new(-v / RADIUS, 0.0, w);
        let mut state = world.state(&[start(DVec3::Y * v, spin)]).unwrap();
        let outcome = world.run(&mut state, &mut Scratch::default(), 20.0, &mut ()).unwrap();
        let body = &state.bodies()[0];
        assert_eq!(outcome == Outcome::AllAtRest, c > 0.0, "{v} {c}");
        assert_eq!(body.spin.z, 0.0);
        if v == 0.0 {
            assert!((body.path.t / time - 1.0).abs() < 1e-12, "{} for {time}", body.path.t);
        }
    }
    // Half way, it has half of its spin left.
    let world = on(block(Vec::new()), GYRATION, Law::new(0.1, 0.3).with_resistance(0.02, sigma));
    let mut state = world.state(&[start(DVec3::ZERO, DVec3::Z * w)]).unwrap();
    world.run(&mut state, &mut Scratch::default(), 0.5 * time, &mut ()).unwrap();
    let half = world.at(0, &state.bodies()[0], 0.5 * time);
    assert!((half.spin.z / w - 0.5).abs() < 1e-12 && half.path.v == DVec3::ZERO, "{}", half.spin.z);
}

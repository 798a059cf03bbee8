//! Surfaces that grip better while they do not slide: the static coefficient of friction above that of sliding.

use glam::{DQuat, DVec3};
use plaus_dist::math;
use plaus_sim::rigid::{
    BodySpec, Keyframes, Phase, RigidBodyState, RigidWorld, RigidWorldDesc, Start, StaticShape, Track,
};
use plaus_sim::scenery::Plane;
use plaus_sim::shape::{Cuboid, Shape};
use plaus_sim::{Accuracy, Law, Laws, Material, Preset, Scratch};

const M: Material = Material(0);
const G: f64 = 9.81;
const SLIDING: f64 = 0.4;
const STICKING: f64 = 0.6;
/// The slope between the two.
const SLOPE: f64 = 0.5;
const PRESETS: [Preset; 4] = [Preset::Draft, Preset::Standard, Preset::Fine, Preset::Reference];

fn block() -> Shape {
    Shape::Cuboid(Cuboid::new(DVec3::new(0.04, 0.03, 0.01), 0.0).unwrap())
}

fn law(sticking: f64) -> Law {
    Law::new(SLIDING, 0.0).with_static_friction(sticking)
}

/// Bodies on a plane whose slope, along -x, is this: gravity is slanted, the plane level.
fn world(shapes: &[Shape], law: Law, slope: f64, preset: Preset) -> RigidWorld {
    let down = DVec3::new(-slope, 0.0, -1.0).normalize();
    RigidWorld::new(RigidWorldDesc {
        bodies: shapes.iter().map(|s| BodySpec::solid(s.clone(), 1000.0, M)).collect(),
        parts: vec![StaticShape::Plane(Plane::new(DVec3::ZERO, DVec3::Z, M).unwrap())],
        laws: Laws::uniform(law).unwrap(),
        gravity: down * G,
        accuracy: Accuracy::preset(preset),
        skin: 1.0,
        sink: f64::NEG_INFINITY,
        duration: 100.0,
    })
    .unwrap()
}

/// The bodies at a time.
fn after(world: &RigidWorld, starts: &[Start], time: f64) -> Vec<RigidBodyState> {
    let mut state = world.state(starts).unwrap();
    world.run(&mut state, &mut Scratch::default(), time, &mut ()).unwrap();
    state.bodies().iter().enumerate().map(|(k, body)| world.at(k, body, time)).collect()
}

fn on_slope(preset: Preset, sticking: f64, speed: f64, time: f64) -> RigidBodyState {
    let world = world(&[block()], law(sticking), SLOPE, preset);
    let start = Start { velocity: DVec3::X * speed, ..Start::at_rest(DVec3::Z * 0.005) };
    after(&world, &[start], time).remove(0)
}

/// Acceleration along the slope of what slides down, and of what slides up.
fn rates() -> [f64; 2] {
    let weight = G / (1.0 + SLOPE * SLOPE).sqrt();
    [SLOPE - SLIDING, SLOPE + SLIDING].map(|pull| -pull * weight)
}

/// A block on a slope between the two stays where it was put; with the coefficient of sliding alone it slides down.
#[test]
fn a_block_stays_on_a_slope_that_the_static_friction_holds() {
    for preset in PRESETS {
        let body = on_slope(preset, STICKING, 0.0, 20.0);
        assert!(body.phase == Phase::Rest && body.path.x.x.abs() < 1e-6, "{preset:?}: {:?}", body.path);
        let twin = on_slope(preset, 0.0, 0.0, 1.0).path.x.x;
        assert!((twin - 0.5 * rates()[0]).abs() < 1e-3, "{preset:?}: {twin}");
        // A little steeper than the static friction holds: it slides with the sliding one.
        let steep = on_slope(preset, 0.45, 0.0, 1.0).path.x.x;
        assert!((steep - 0.5 * rates()[0]).abs() < 1e-3, "{preset:?}: {steep}");
    }
}

/// Pushed down, it slides by the coefficient of sliding and does not stop.
#[test]
fn a_pushed_block_slides_on() {
    for preset in PRESETS {
        let body = on_slope(preset, STICKING, -0.2, 1.0);
        let way = -0.2 + 0.5 * rates()[0];
        assert!((body.path.x.x - way).abs() < 1e-3, "{preset:?}: {} for {way}", body.path.x.x);
    }
}

/// Pushed up, it slides until it stops, and stays; the twin slides back.
#[test]
fn a_block_that_slides_up_stays_where_it_stops() {
    for preset in PRESETS {
        let body = on_slope(preset, STICKING, 1.0, 5.0);
        let way = -0.5 / rates()[1];
        assert!((body.path.x.x - way).abs() < 1e-3 && body.phase == Phase::Rest, "{preset:?}: {:?}", body.path);
        assert!(on_slope(preset, 0.0, 1.0, 5.0).path.x.x < -1.0, "{preset:?}");
    }
}

/// A plank that tilts steadily carries a block until the slope is the static coefficient; then the block slides down
/// it by that of sliding.
#[test]
fn a_block_on_a_tilting_plank_starts_to_slide_at_the_static_friction() {
    let rate = 0.1;
    let slid = |preset, sticking: f64, angle: f64| {
        let plank = Shape::Cuboid(Cuboid::new(DVec3::new(2.0, 0.3, 0.02), 0.0).unwrap());
        let mut world = RigidWorld::new(RigidWorldDesc {
            bodies: [plank, block()].map(|s| BodySpec::solid(s, 1000.0, M)).into(),
            parts: Vec::new(),
            gravity: DVec3::NEG_Z * G,
            ..RigidWorldDesc {
                laws: Laws::uniform(law(sticking)).unwrap(),
                accuracy: Accuracy::preset(preset),
                bodies: Vec::new(),
                parts: Vec::new(),
                gravity: DVec3::ZERO,
                skin: 1.0,
                sink: f64::NEG_INFINITY,
                duration: 100.0,
            }
        })
        .unwrap();
        let turn = |k: i32| (f64::from(k), DQuat::from_rotation_y(-rate * f64::from(k)));
        let keys = Keyframes { position: Track::fixed(DVec3::ZERO), rotation: Track::linear((0..12).map(turn)) };
        world.drive(0, &keys).unwrap();
        let starts = [Start::at_rest(DVec3::ZERO), Start::at_rest(DVec3::Z * 0.015)];
        let bodies = after(&world, &starts, angle / rate);
        (bodies[0].turn.conjugate() * bodies[1].path.x).x
    };
    let starts = math::atan2(STICKING, 1.0);
    let (sine, cosine) = math::sin_cos(starts);
    for preset in PRESETS {
        let before = slid(preset, STICKING, starts - 0.01);
        assert!(before.abs() < 1e-4, "{preset:?}: {before}");
        let way = |time: f64| {
            let (pull, growth) = (sine - SLIDING * cosine, rate * (cosine + SLIDING * sine));
            -G * time * time * (0.5 * pull + growth * time / 6.0)
        };
        // It slides once it is faster than what counts as still, which the growing pull takes a while to reach.
        let accuracy = Accuracy::preset(preset);
        let still = accuracy.rest_residual * accuracy.step * (G * block().size()).sqrt();
        let late = (2.0 * still / (G * rate * (cosine + STICKING * sine))).sqrt();
        let after = slid(preset, STICKING, starts + 0.03);
        // Coriolis' force, 2 ω v, changes the load and with it the acceleration by 3 %.
        assert!(after > 1.03 * way(0.3) && after < 0.97 * way(0.3 - late), "{preset:?}: {after} {late}");
        assert!(slid(preset, 0.0, starts - 0.01) < -0.1, "{preset:?}");
    }
}

/// A ball on a slope that static friction lets it roll down, where that of sliding would let it slip.
#[test]
fn a_ball_rolls_where_static_friction_lets_it() {
    let slope = 1.8_f64;
    let cosine = 1.0 / (1.0 + slope * slope).sqrt();
    let (rolls, slips) = (slope * cosine * G / 1.4, (slope - SLIDING) * cosine * G);
    for preset in PRESETS {
        for (sticking, rate) in [(STICKING, rolls), (0.0, slips)] {
            let world = world(&[Shape::Ball(0.01)], law(sticking), slope, preset);
            let ball = &after(&world, &[Start::at_rest(DVec3::Z * 0.01)], 0.5)[0];
            let way = -0.125 * rate;
            assert!((ball.path.x.x - way).abs() < 1e-3 * way.abs(), "{preset:?}: {} for {way}", ball.path.x.x);
        }
    }
}

/// Two and twelve blocks on each other stay on the slope as one does: they move less than a thousandth of what they
/// would slide, 2 s · 2 s · g (sin θ − µ cos θ) / 2, which is metres.
#[test]
fn stacks_stay_on_a_slope_that_the_static_friction_holds() {
    for preset in PRESETS {
        for count in [2, 12] {
            let moved = |sticking: f64| {
                let cube = Shape::Cuboid(Cuboid::new(DVec3::new(0.4, 0.4, 0.02), 0.0).unwrap());
                let world = world(&vec![cube; count], law(sticking), SLOPE, preset);
                let starts: Vec<_> = (0..count).map(|k| Start::at_rest(DVec3::Z * (0.01 + 0.02 * k as f64))).collect();
                let bodies = after(&world, &starts, 2.0);
                bodies.iter().map(|b| b.path.x.x.abs()).fold(0.0, f64::max)
            };
            let (stays, slides) = (moved(STICKING), moved(0.0));
            assert!(stays < 1e-3 && slides > 0.5, "{preset:?} {count}: {stays} {slides}");
        }
    }
}

//! Bodies on tables whose surface is a random field: they come to rest where resistance and friction hold them.

use crate::common::bumps::noise;
use crate::common::zoo::{Body, Dice, G, M};
use glam::{DQuat, DVec3};
use plaus_sim::field::{Grid, Spline};
use plaus_sim::rigid::{BodySpec, Keyframes, RigidWorld, RigidWorldDesc, Start, StaticShape, Table, Track};
use plaus_sim::scenery::Plane;
use plaus_sim::shape::{Frustum, Profile, Revolution, Shape};
use plaus_sim::{Accuracy, Law, Laws, Outcome, Preset, Scratch};
use std::sync::Arc;

/// A field of random values that lie within four of `sd` of the mean.
fn field(mean: f64, sd: f64, spacing: f64, seed: u64) -> Spline {
    let value = move |i: i64, j: i64| mean + sd * noise(i + 1000 * seed as i64, j);
    Spline::new("field", Grid { origin: [0.0; 2], spacing }, [mean - 4.0 * sd, mean + 4.0 * sd], value).unwrap()
}

fn world(shape: &Shape, table: Table, law: Law, preset: Preset) -> RigidWorld {
    RigidWorld::new(RigidWorldDesc {
        bodies: vec![BodySpec::solid(shape.clone(), 1200.0, M)],
        parts: vec![StaticShape::Table(Box::new(table))],
        laws: Laws::uniform(law).unwrap(),
        accuracy: Accuracy::preset(preset),
        ..RigidWorldDesc::default()
    })
    .unwrap()
}

/// How a run ended.
struct End {
    outcome: Outcome,
    position: DVec3,
    /// Energy gained in J.
    gain: f64,
}

fn run(world: &RigidWorld, start: Start) -> End {
    let mut state = world.state(&[start]).unwrap();
    let before = world.energy(0, &state.bodies()[0]);
    let outcome = world.run(&mut state, &mut Scratch::default(), 20.0, &mut ()).unwrap();
    let body = world.at(0, &state.bodies()[0], state.time());
    End { outcome, position: body.path.x, gain: world.energy(0, &body) - before }
}

/// A body released over random bumps, turned anyhow, at up to half of `√(g · size)`. The bumps' slopes are up to
/// `steep` of the resistance to rolling: the heights of neighbours differ by up to 7 of the field's deviations.
fn released(body: Body, seed: u64, steep: f64, law: impl Fn(f64) -> Law, preset: Preset) -> (End, Spline, f64) {
    let mut dice = Dice::new(77, seed);
    let (spacing, rolling) = (0.02 * dice.between(0.5, 30.0), dice.between(0.02, 0.2));
    let sd = spacing * rolling * steep / 7.0;
    let (shape, height) = (body.shape(), field(0.0, sd, spacing, seed));
    let world = world(&shape, Table::new(height.clone(), M), law(rolling), preset);
    let up = 4.0 * sd + shape.reach() * dice.between(1.0, 1.5);
    let end = run(
        &world,
        Start {
            orientation: dice.turn(),
            velocity: dice.in_cube() * 0.5 * (shape.size() * G).sqrt(),
            spin: dice.in_cube() * 0.5 * (G / shape.size()).sqrt(),
            ..Start::at_rest(DVec3::new(dice.between(0.0, spacing), dice.between(0.0, spacing), up))
        },
    );
    (end, height, rolling)
}

/// On bumps less steep than resistance and friction can hold, every body comes to rest at every preset, with less
/// energy than it had. The twin without any resistance to rolling leaves balls rolling.
#[test]
fn every_body_comes_to_rest_on_gentle_bumps() {
    let law = |rolling| Law::new(0.5, 0.3).with_resistance(rolling, 0.02);
    for body in Body::ALL {
        for (preset, draws) in [(Preset::Draft, 4), (Preset::Standard, 4), (Preset::Fine, 1)] {
            for seed in 0..draws {
                let (end, ..) = released(body, seed, 0.3, law, preset);
                assert!(end.outcome == Outcome::AllAtRest && end.gain < 0.0, "{body:?} {preset:?} {seed}");
            }
        }
    }
    for preset in Preset::ALL {
        let (end, ..) = released(Body::Ball, 0, 0.3, |_| Law::new(0.5, 0.3).with_resistance(0.0, 0.02), preset);
        assert_eq!(end.outcome, Outcome::TimeReached, "{preset:?}");
    }
}

/// Where bumps are up to three times as steep as what resistance to rolling holds, balls rest only where they are not:
/// the slope under a ball is at most ρ. A twin with half of ρ in the test would be refused by some.
#[test]
fn balls_rest_only_where_resistance_holds_them() {
    let law = |rolling| Law::new(0.8, 0.2).with_resistance(rolling, 0.02);
    let mut refused = 0;
    for preset in Preset::ALL {
        for seed in 0..if preset == Preset::Reference { 3 } else { 12 } {
            let (end, height, rolling) = released(Body::Ball, seed, 8.0, law, preset);
            assert!(end.outcome == Outcome::AllAtRest && end.gain < 0.0, "{preset:?} {seed}: {:?}", end.outcome);
            let Shape::Ball(radius) = Body::Ball.shape() else { panic!("a ball") };
            // The point of contact lies along the normal; each round divides the error by the ratio of the radii.
            let mut slope = [0.0_f64; 2];
            for _ in 0..40 {
                let scale = radius / (1.0 + slope[0] * slope[0] + slope[1] * slope[1]).sqrt();
                let at = [0, 1].map(|k| end.position.to_array()[k] + slope[k] * scale);
                slope = height.slope_at(at[0], at[1]).1;
            }
            let steep = (slope[0] * slope[0] + slope[1] * slope[1]).sqrt();
            // Rounding of the foot, which takes four rounds in the engine.
            assert!(steep <= rolling * 1.01, "{preset:?} {seed}: {steep} for {rolling}");
            refused += usize::from(steep > 0.5 * rolling);
        }
    }
    assert!(refused > 0, "no ball rests where half of the resistance would not hold it");
}

/// A ball set down on bumps 1 mm high and 0.5 m apart gets a spin about the normal of some 1e-7 rad/s as it rolls a
/// little. Nothing resists that spin, but it must not keep the ball rolling.
#[test]
fn a_ball_set_down_on_smooth_bumps_rests() {
    for preset in Preset::ALL {
        for seed in 0..if preset == Preset::Reference { 4 } else { 25 } {
            let mut dice = Dice::new(78, seed);
            let law = Law::new(0.8, 0.0).with_resistance(0.2, 0.0);
            let world = world(&Shape::Ball(0.02), Table::new(field(0.0, 1e-3, 0.5, seed), M), law, preset);
            let at = DVec3::new(dice.between(0.0, 0.5), dice.between(0.0, 0.5), 0.03);
            assert_eq!(run(&world, Start::at_rest(at)).outcome, Outcome::AllAtRest, "{preset:?} {seed}");
        }
    }
}

/// A cylinder touches a level table with 32 points of its rim, more than a body lists. Where friction is a field
/// between 0.01 and 0.09, it stops after a way between those of both. The twin on ice slides on.
#[test]
fn a_flat_cylinder_slides_to_rest_over_a_field_of_friction() {
    let stone = Shape::from(Frustum::cylinder(0.14, 0.114).unwrap());
    for preset in Preset::ALL {
        for seed in 0..if preset == Preset::Reference { 2 } else { 12 } {
            let speed = Dice::new(79, seed).between(0.5, 1.5);
            let start = Start { velocity: DVec3::X * speed, ..Start::at_rest(DVec3::Z * 0.057) };
            let slide = |friction: Spline| {
                let mut table = Table::new(field(0.0, 0.0, 0.5, seed), M);
                table.friction = Some(friction);
                run(&world(&stone, table, Law::new(0.3, 0.5), preset), start)
            };
            let end = slide(field(0.05, 0.01, 0.5, seed));
            let way = |friction: f64| speed * speed / (2.0 * friction * G);
            let gone = end.position.truncate().length();
            assert!(gone > way(0.09) && gone < way(0.01), "{preset:?} {seed}: {gone}");
            assert!(end.outcome == Outcome::AllAtRest && end.gain < 0.0, "{preset:?} {seed}: {:?}", end.outcome);
        }
    }
    let mut table = Table::new(field(0.0, 0.0, 0.5, 0), M);
    table.friction = Some(field(0.0, 0.0, 0.5, 0));
    let start = Start { velocity: DVec3::X, ..Start::at_rest(DVec3::Z * 0.057) };
    let end = run(&world(&stone, table, Law::new(0.3, 0.5), Preset::Standard), start);
    assert!(end.outcome == Outcome::TimeReached && (end.position.x - 20.0).abs() < 1e-9, "{}", end.position);
}

/// A chess piece, in mm.
fn piece(foot: f64, outline: [[f64; 2]; 5], top: f64) -> Arc<Revolution> {
    let points = outline.map(|p| p.map(|x| x * 1e-3)).to_vec();
    Arc::new(Revolution::new(&Profile { foot: foot * 1e-3, rim: 1.5e-3, points, top: top * 1e-3 }, 40).unwrap())
}

/// A driven arm that turns as it sweeps over two chess pieces: once, what would stop the arm's turning was infinite,
/// and in the fifth of these draws the king's motion was no longer finite. Where the arm presses a piece into the
/// floor at
/// an angle that friction holds, nothing can give way: that ends a draw as [`Outcome::Crushed`], at reference too.
#[test]
fn pieces_with_resistance_survive_a_sweep() {
    let king = piece(14.5, [[8.0, 16.0], [18.0, 10.0], [60.0, 8.0], [78.0, 12.0], [84.0, 10.0]], 95.0);
    let queen = piece(13.5, [[8.0, 15.0], [18.0, 9.0], [55.0, 7.0], [70.0, 11.0], [76.0, 9.0]], 85.0);
    let places = [0.0, 0.055].into_iter().zip([&king, &queen]);
    let mut ended = 0;
    for seed in 0..8 {
        let mut dice = Dice::new(5, seed);
        let turned = |degrees: f64| {
            DQuat::from_rotation_z(degrees.to_radians()) * DQuat::from_rotation_x(0.5 * std::f64::consts::PI)
        };
        let high = dice.between(0.015, 0.05);
        dice.between(0.0, 1.0);
        let mut starts = vec![Start::at_rest(DVec3::new(-0.3, -0.15, 0.03))];
        let mut shapes = vec![Shape::from(Frustum::capsule(0.008, 0.26).unwrap())];
        for (x, shape) in places.clone() {
            let off = dice.in_cube() * 0.005;
            starts.push(Start::at_rest(DVec3::new(x + off.x, off.y, shape.balance())));
            shapes.push(Shape::Revolution(shape.clone()));
        }
        let mut world = RigidWorld::new(RigidWorldDesc {
            bodies: shapes.into_iter().map(|s| BodySpec::solid(s, 1000.0, M)).collect(),
            parts: vec![StaticShape::Plane(Plane::new(DVec3::ZERO, DVec3::Z, M).unwrap())],
            laws: Laws::uniform(Law::new(0.35, 0.3).with_resistance(0.02, 0.01)).unwrap(),
            duration: 4.0,
            ..RigidWorldDesc::default()
        })
        .unwrap();
        let at = |x: f64, y: f64| DVec3::new(x, y, high);
        let keys = Keyframes {
            position: Track::linear([(0.1, at(-0.3, -0.15)), (1.1, at(0.0, -0.09)), (2.6, at(0.3, -0.15))]),
            rotation: Track::linear([(0.1, turned(-20.0)), (1.1, turned(10.0)), (2.6, turned(40.0))]),
        };
        world.drive(0, &keys).unwrap();
        let mut state = world.state(&starts).unwrap();
        let outcome = world.run(&mut state, &mut Scratch::default(), 4.0, &mut ()).unwrap();
        let ends = matches!(outcome, Outcome::TimeReached | Outcome::AllAtRest);
        assert!(ends || matches!(outcome, Outcome::Crushed { .. }), "draw {seed}: {outcome:?}");
        ended += u32::from(ends);
    }
    assert!(ended >= 4, "{ended} of 8");
}

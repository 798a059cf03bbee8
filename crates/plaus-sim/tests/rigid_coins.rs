//! Tossed coins: each comes to lie flat, without spending all its events on wobbling.

use crate::common::zoo::{Dice, G, M};
use glam::{DQuat, DVec3};
use plaus_sim::rigid::{BodySpec, Phase, RigidWorld, RigidWorldDesc, Start, StaticShape};
use plaus_sim::scenery::Plane;
use plaus_sim::shape::{Frustum, Shape};
use plaus_sim::{Accuracy, Law, Laws, Outcome, Preset, Scratch};

const RADIUS: f64 = 0.012;
const HALF: f64 = 0.002;

/// A coin of gold with a spin about a line across it, on level ground.
fn toss(k: u64, preset: Preset) -> (RigidWorld, Start) {
    let mut dice = Dice::new(17, k);
    let shape = Shape::from(Frustum::cylinder(RADIUS, 2.0 * HALF).unwrap());
    let world = RigidWorldDesc {
        bodies: vec![BodySpec::solid(shape, 8000.0, M)],
        parts: vec![StaticShape::Plane(Plane::new(DVec3::ZERO, DVec3::Z, M).unwrap())],
        laws: Laws::uniform(Law::new(0.4, 0.4).with_resistance(0.05, 0.05)).unwrap(),
        gravity: DVec3::new(0.0, 0.0, -G),
        accuracy: Accuracy::preset(preset),
        skin: 0.5,
        sink: f64::NEG_INFINITY,
        duration: 10.0,
    };
    let tilt = dice.in_cube();
    let start = Start {
        position: DVec3::Z * 0.3,
        orientation: DQuat::from_xyzw(0.3 * tilt.x, 0.3 * tilt.y, 0.0, 1.0).normalize(),
        velocity: dice.in_cube() * 0.3 + DVec3::Z,
        spin: DVec3::new(dice.between(40.0, 60.0), dice.between(-3.0, 3.0), dice.between(-3.0, 3.0)),
        time: 0.0,
    };
    (RigidWorld::new(world).unwrap(), start)
}

/// A wobbling disk wobbles faster and faster. Before disks were laid flat when their energy falls below that of the
/// preset's rest speed, a quarter of the tosses spent their 20,000 events on wobbling.
#[test]
fn tossed_coins_come_to_lie() {
    let mut flat = 0;
    for (preset, tosses, most) in [(Preset::Draft, 20, 4_000), (Preset::Standard, 20, 5_000), (Preset::Fine, 2, 50_000)]
    {
        for k in 0..tosses {
            let (world, start) = toss(k, preset);
            let mut state = world.state(&[start]).unwrap();
            let outcome = world.run(&mut state, &mut Scratch::default(), 10.0, &mut ()).unwrap();
            let (body, events) = (&state.bodies()[0], state.counts().events);
            assert!(events < most, "{preset:?} {k}: {outcome:?} at {} after {events}", body.path.t);
            let gap = Accuracy::preset(preset).gap * HALF;
            assert!(world.depth(0, body) <= gap, "{preset:?} {k}");
            if outcome == Outcome::AllAtRest && body.path.x.z < 0.5 * RADIUS {
                // On its face, to the gap at which bodies touch.
                assert!((body.path.x.z - HALF).abs() <= gap, "{preset:?} {k}: {}", body.path.x.z);
                flat += 1;
            }
        }
    }
    // Others stand on their rim or roll away on it.
    assert!(flat > 10, "{flat}");
}

/// With half of the energy at which a coin is laid flat, the coin is laid flat; with ten times as much energy it goes
/// on.
#[test]
fn a_coin_is_laid_flat_only_with_little_energy_left() {
    for (preset, part, lies) in [(Preset::Standard, 0.5, true), (Preset::Standard, 10.0, false)] {
        let (world, _) = toss(0, preset);
        let speed = Accuracy::preset(preset).rest_speed;
        let height = 0.5 * speed * speed * HALF;
        let tilt = part * height / RADIUS;
        let turn = DQuat::from_rotation_x(tilt);
        let rise = (turn * DVec3::new(0.0, RADIUS, HALF)).z;
        let start = Start { orientation: turn, ..Start::at_rest(DVec3::Z * rise) };
        let mut state = world.state(&[start]).unwrap();
        world.run(&mut state, &mut Scratch::default(), 1e-6, &mut ()).unwrap();
        assert_eq!(state.bodies()[0].phase == Phase::Rest, lies, "{part}");
    }
}

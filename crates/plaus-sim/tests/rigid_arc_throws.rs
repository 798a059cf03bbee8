//! Bodies thrown at curved tracks: none passes through, from either side.

use crate::common::G;
use crate::common::zoo::Dice;
use crate::rigid_arcs::{FORM, RADIUS, arc, world};
use glam::DVec3;
use plaus_sim::rigid::Start;
use plaus_sim::scenery::ArcForm;
use plaus_sim::shape::{Cuboid, Frustum, Shape};
use plaus_sim::{Law, Outcome, Preset, Scratch};
use std::f64::consts::PI;

fn thrown(dice: &mut Dice) -> Shape {
    let size = 0.01 * dice.between(0.5, 1.5);
    match (dice.between(0.0, 5.0)) as u32 {
        0 => Shape::Ball(size),
        1 => Shape::Cuboid(Cuboid::new(DVec3::new(2.0, 3.0, 4.0) * size, 0.0).unwrap()),
        2 => Shape::Cuboid(Cuboid::new(DVec3::new(2.0, 3.0, 4.0) * size, 0.3 * size).unwrap()),
        3 => Shape::from(Frustum::cylinder(1.2 * size, 0.4 * size).unwrap()),
        _ => Shape::from(Frustum::capsule(0.6 * size, 2.0 * size).unwrap()),
    }
}

/// A body thrown into a pipe that is open at the top, too slowly to leave it, and turned in any way: where it is seen
/// deepest, over its reach; how far its middle is from the axis at most; and how much energy it has gained, over what a
/// fall by its size makes.
fn throw(seed: u64, preset: Preset, is_part: bool) -> [f64; 3] {
    let mut dice = Dice::new(107, seed);
    let shape = thrown(&mut dice);
    let form = ArcForm { width: 4.0, angles: [-PI - 1.0, 1.0], ..FORM };
    let parts = if is_part { vec![arc(form)] } else { Vec::new() };
    let world = world(shape.clone(), parts, Law::new(dice.between(0.0, 0.8), dice.between(0.0, 0.8)), preset);
    let start = Start {
        orientation: dice.turn(),
        velocity: dice.in_cube() * 0.8 - DVec3::Z * 0.5,
        spin: dice.in_cube() * 60.0,
        ..Start::at_rest(DVec3::new(dice.between(-0.1, 0.1), 0.0, RADIUS))
    };
    let (mut state, mut scratch) = (world.state(&[start]).unwrap(), Scratch::default());
    let before = world.energy(0, &state.bodies()[0]);
    let [mut deepest, mut farthest, mut gained] = [0.0_f64; 3];
    for k in 1..=15 {
        let time = 0.04 * f64::from(k);
        let outcome = world.run(&mut state, &mut scratch, time, &mut ()).unwrap();
        assert!(matches!(outcome, Outcome::TimeReached | Outcome::AllAtRest), "{seed} {preset:?}: {outcome:?}");
        let body = world.at(0, &state.bodies()[0], time);
        deepest = deepest.max(world.depth(0, &body) / shape.reach());
        let (x, weight) = (body.path.x, shape.mass_properties(2500.0).mass * G * shape.size());
        farthest = farthest.max((x - DVec3::Z * RADIUS).with_y(0.0).length());
        gained = gained.max((world.energy(0, &body) - before) / weight);
    }
    [deepest, farthest, gained]
}

/// Nothing passes through: the middle of a body that is thrown into a pipe stays in it, corners overlap by less
/// than a tenth of its reach half way through a step, and no energy is gained but by a step's error. Without the
/// track all fall through.
#[test]
fn nothing_passes_through_a_half_pipe() {
    for (preset, throws) in [(Preset::Draft, 30), (Preset::Standard, 30), (Preset::Fine, 6), (Preset::Reference, 1)] {
        for seed in 0..throws {
            let [deepest, farthest, gained] = throw(seed, preset, true);
            assert!(farthest < RADIUS, "{preset:?} {seed}: {farthest}");
            assert!(deepest < 0.1, "{preset:?} {seed}: {deepest}");
            assert!(gained < 1e-2, "{preset:?} {seed}: {gained}");
        }
    }
    assert!((0..10).all(|seed| throw(seed, Preset::Draft, false)[1] > RADIUS));
}

/// From behind and from beside, bodies meet the back, the sides and the ends: a ball dropped on a half pipe that is
/// upside down stays out of it, and so does one that comes along its axis.
#[test]
fn what_comes_from_behind_stays_outside() {
    for preset in [Preset::Draft, Preset::Standard] {
        for seed in 0..30 {
            let mut dice = Dice::new(108, seed);
            let form = ArcForm { angles: [0.0, PI], pitch: 0.0, ..FORM };
            let shape = thrown(&mut dice);
            let world = world(shape, vec![arc(form)], Law::new(0.3, 0.4), preset);
            let at = DVec3::new(dice.between(-0.15, 0.15), dice.between(-0.04, 0.04), 2.0 * RADIUS + 0.06);
            let start = Start { orientation: dice.turn(), velocity: DVec3::NEG_Z * 2.0, ..Start::at_rest(at) };
            let mut state = world.state(&[start]).unwrap();
            for k in 1..=10 {
                let time = 0.03 * f64::from(k);
                world.run(&mut state, &mut Scratch::default(), time, &mut ()).unwrap();
                let x = world.at(0, &state.bodies()[0], time).path.x;
                let out = (x - DVec3::Z * RADIUS).with_y(0.0).length();
                let is_inside = x.z > RADIUS && x.y.abs() < 0.05 && out < RADIUS;
                assert!(!is_inside, "{preset:?} {seed}: {x}");
            }
        }
    }
}

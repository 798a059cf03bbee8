//! Driven bodies press others against joints and walls: nothing is flung, and what has no way is named as crushed.

use crate::laws::wedges::Wedge;
use crate::laws::worlds::{G, M, on_floor};
use glam::{DQuat, DVec3};
use plaus_sim::rigid::{BodySpec, Joint, Keyframes, RigidWorld, Start, Track};
use plaus_sim::shape::{Cuboid, Shape};
use plaus_sim::{Accuracy, Law, Outcome, Preset, Scratch};

/// Maximum number of events of a world of at most seven bodies: the most of 400 worlds at the draft and standard
/// presets is 8,500, at which runs are cut.
const EVENTS: u64 = 20_000;

/// In random worlds, at all presets, runs come to an end of their own, all motion stays finite, and no point of a body
/// is faster than the driven body can make it. Before joints that an event interrupts were brought together, and before
/// driven bodies gave way, a third of these worlds had speeds from 10³ to 10¹² m/s.
#[test]
fn driven_bodies_fling_nothing() {
    let mut tightest = 0.0_f64;
    for (preset, worlds) in [(Preset::Draft, 60), (Preset::Standard, 20), (Preset::Fine, 4), (Preset::Reference, 1)] {
        for seed in 0..worlds {
            let Some(wedge) = Wedge::new(seed, preset) else { continue };
            let went = wedge.run(EVENTS);
            let is_over =
                matches!(went.outcome, Outcome::TimeReached | Outcome::AllAtRest | Outcome::Crushed { by: 0, .. });
            assert!(is_over, "{preset:?} {seed}: {went:?}");
            let part = went.fastest.map(|v| v / wedge.most());
            assert!(part.iter().all(|p| *p <= 1.0), "{preset:?} {seed}: {went:?} of {}", wedge.most());
            tightest = tightest.max(part[0]);
        }
    }
    println!("fastest over its bound: {tightest}");
}

/// A paddle that moves at a steady speed towards a ball, which is welded to the world or not.
fn paddle_to_ball(speed: f64, radius: f64, welded: bool, preset: Preset) -> (Outcome, f64, f64) {
    let thick = 0.08;
    let shapes = [Shape::Cuboid(Cuboid::new(DVec3::new(thick, 0.1, 0.1), 0.0).unwrap()), Shape::Ball(radius)];
    let bodies = shapes.map(|s| BodySpec::solid(s, 1000.0, M)).to_vec();
    let mut world = RigidWorld::new(on_floor(bodies, Law::new(0.2, 0.3), preset)).unwrap();
    let starts = [Start::at_rest(DVec3::new(-0.2, 0.0, 0.06)), Start::at_rest(DVec3::new(0.0, 0.0, 0.06))];
    let ends = [starts[0].position, starts[0].position + DVec3::X * 0.3];
    let position = Track::linear([(0.0, ends[0]), (0.3 / speed, ends[1])]);
    world.drive(0, &Keyframes { position, rotation: Track::fixed(DQuat::IDENTITY) }).unwrap();
    if welded {
        world.join(Joint::weld(starts[1].position, 1, &starts[1])).unwrap();
    }
    let mut state = world.state(&starts).unwrap();
    let outcome = world.run(&mut state, &mut Scratch::default(), 0.3 / speed, &mut ()).unwrap();
    (outcome, state.time(), (0.2 - radius - 0.5 * thick) / speed)
}

/// A ball that is welded to the world is crushed when the paddle is in it by a hundredth of its radius, to a step, and
/// the ending names both. A twin without the weld is pushed aside, whatever the speed and the preset.
#[test]
fn what_has_no_way_is_crushed() {
    for preset in [Preset::Draft, Preset::Standard, Preset::Fine] {
        for (speed, radius) in [(0.05, 0.02), (0.4, 0.03), (3.0, 0.01)] {
            let (outcome, time, met) = paddle_to_ball(speed, radius, true, preset);
            assert_eq!(outcome, Outcome::Crushed { body: 1, by: 0 }, "{speed} {radius} {preset:?}");
            // A joint's step is at most a quarter of the preset's, over √(size/g).
            let step = 0.25 * Accuracy::preset(preset).step * (radius / G).sqrt();
            let late = time - met - 0.01 * radius / speed;
            assert!((-1e-3 * radius / speed..2.0 * step).contains(&late), "{speed} {radius} {preset:?}: {late} {step}");
            let twin = paddle_to_ball(speed, radius, false, preset).0;
            assert!(matches!(twin, Outcome::TimeReached | Outcome::AllAtRest), "{twin:?}");
        }
    }
}

/// A paddle pushes pendulums aside that hang above it, on ball joints and hinges: none is crushed.
#[test]
fn what_swings_out_of_the_way_is_not_crushed() {
    for (k, preset) in [Preset::Draft, Preset::Standard, Preset::Fine].into_iter().enumerate() {
        for (speed, arm) in [(0.2, 0.12), (1.0, 0.2), (4.0, 0.15)] {
            let paddle = Shape::Cuboid(Cuboid::new(DVec3::new(0.02, 0.1, 0.1), 0.0).unwrap());
            let bob = [Shape::Ball(0.02), Shape::Cuboid(Cuboid::new(DVec3::splat(0.03), 0.0).unwrap())][k % 2].clone();
            let bodies = vec![BodySpec::solid(paddle, 1000.0, M), BodySpec::solid(bob, 500.0, M)];
            let mut world = RigidWorld::new(on_floor(bodies, Law::new(0.1, 0.3), preset)).unwrap();
            let starts = [-0.15, 0.0].map(|x| Start::at_rest(DVec3::new(x, 0.0, 0.08)));
            let track = [(0.0, starts[0].position), (0.4 / speed, starts[0].position + DVec3::X * 0.4)];
            let keys = Keyframes { position: Track::linear(track), rotation: Track::fixed(DQuat::IDENTITY) };
            world.drive(0, &keys).unwrap();
            let nail = starts[1].position + DVec3::Z * arm;
            let joint =
                if k == 1 { Joint::ball(nail, 1, &starts[1]) } else { Joint::hinge(nail, DVec3::Y, 1, &starts[1]) };
            world.join(joint).unwrap();
            let mut state = world.state(&starts).unwrap();
            let outcome = world.run(&mut state, &mut Scratch::default(), 0.4 / speed + 0.2, &mut ()).unwrap();
            assert!(matches!(outcome, Outcome::TimeReached | Outcome::AllAtRest), "{preset:?} {speed} {outcome:?}");
            let body = world.at(1, &state.bodies()[1], state.time());
            let off = (body.path.x + body.turn * (DVec3::Z * arm) - nail).length();
            assert!(off < 2e-3 * arm, "{preset:?} {speed}: {off}");
        }
    }
}

//! The example `curling`, a scene of one's own in one file: it runs, its ways are those of small steps, and chains
//! sample it as weighted draws of the prior say.

use crate::require_exact::compared;
use glam::DVec2;
use plaus_dist::{Purpose, Seed};
use plaus_mcmc::{Chain, Goal, Target};
use plaus_scenes::require::Require;
use plaus_scenes::{Asked, Rules, Scene};

#[path = "../examples/curling.rs"]
#[allow(dead_code, reason = "the example's `main` is run by a terminal")]
mod example;

use example::{Curling, slide};

/// Step of the integrator, in s: at 2.5 m/s a rebound is off by a quarter of a millimetre.
const STEP: f64 = 1e-4;

/// Where a stone comes to rest, and how often it bounced, by steps of time: friction takes away speed, and a stone
/// beyond the rail is put back as far as it came too far.
fn stepped(numbers: &[f64], restitution: f64) -> (DVec2, usize) {
    let (half, slowing) = (2.2 - 0.145, numbers[2] * 9.806_65);
    let angle = numbers[1].to_radians();
    let (mut place, mut velocity) = (DVec2::ZERO, numbers[0] * DVec2::new(angle.cos(), angle.sin()));
    let mut bounces = 0;
    while velocity.length() > slowing * STEP {
        let after = velocity - velocity.normalize() * slowing * STEP;
        place += 0.5 * STEP * (velocity + after);
        velocity = after;
        if place.y.abs() > half && place.y * velocity.y > 0.0 {
            place.y = place.y.signum() * (half - restitution * (place.y.abs() - half));
            velocity.y *= -restitution;
            bounces += 1;
        }
    }
    (place, bounces)
}

#[test]
fn stones_slide_as_small_steps_say() {
    let scene = Curling::new(2).unwrap();
    let (mut bounced, mut caught) = (0, 0);
    for nth in 0..100 {
        let mut draw = scene.start(&mut Seed(5).chain(0).at(nth, Purpose::START));
        // More of them are to reach the rail than by chance.
        draw[1] *= 4.0;
        draw[4] *= 2.0;
        for numbers in draw.chunks(3) {
            let way = slide(numbers);
            let [truth, twin] = [0.8, 0.7].map(|restitution| stepped(numbers, restitution));
            let end = way.last().unwrap().place;
            assert!(end.distance(truth.0) < 2e-3 && way.len() == truth.1 + 2, "{numbers:?}: {end}, {truth:?}");
            bounced += usize::from(truth.1 > 0);
            caught += usize::from(end.distance(twin.0) > 2e-3);
        }
        // What is shown ends where it is said to.
        for (track, numbers) in scene.animate(&draw).unwrap().motion.tracks.iter().zip(draw.chunks(3)) {
            let (shown, said) = (track.pieces.last().unwrap().position, slide(numbers).last().unwrap().place);
            assert!(DVec2::new(shown.x, -shown.z).distance(said) < 1e-12);
        }
    }
    assert!(bounced >= 50 && caught >= bounced / 2, "{bounced} bounced, {caught} caught");
}

/// Stones in the ring, the second off a rail: each solution is one by small steps too.
#[test]
fn what_it_finds_are_solutions() {
    let required: Require = serde_json::from_str(r#"{ "touches": { "body": "stone_2", "with": "rail" } }"#).unwrap();
    let scene = Asked::new(Curling::new(2).unwrap(), &[required]).unwrap();
    let moves = scene.moves(&Rules::default()).unwrap();
    for seed in 1..4 {
        let mut chain = Chain::start(&scene, &moves, Seed(seed).chain(0)).unwrap();
        let mut hits = 0;
        for iteration in 0..20_000 {
            chain.step().unwrap();
            let state = chain.state();
            let is_hit = scene.class(state.by_ref()).is_some();
            hits += u64::from(is_hit);
            if is_hit && iteration % 500 == 0 {
                let ends = [0, 3].map(|first| stepped(&state.draw[first..first + 3], 0.8));
                assert!(ends.iter().all(|(place, _)| place.distance(DVec2::new(28.0, 0.0)) < 0.61 + 2e-3), "{ends:?}");
                assert!(ends[1].1 > 0, "{ends:?}");
            }
        }
        assert!(hits > 1000, "seed {seed}: {hits} hits");
    }
}

#[test]
fn chains_sample_its_law() {
    let early = "rests = { body = 'stone_1', when = { to_s = 22.5, scale_ms = 300 } }";
    let [z, ignorant] = compared(|| Curling::new(1).unwrap(), &[early], 60_000);
    assert!(z < 3.0, "{z} standard errors");
    assert!(ignorant > 3.0, "only {ignorant} standard errors");
}

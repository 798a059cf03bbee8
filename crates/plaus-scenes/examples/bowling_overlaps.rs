//! Rolls a ball at ten pins many times, and counts how deep any two bodies, or a body and the lane, walls or pit, ever
//! were in each other: over the whole time, not only at the end.
//!
//! `cargo run --release -p plaus-scenes --example bowling_overlaps -- [shots] [preset] [first shot]`
//!
//! To pass through a pin's neck, a body would have to be more than 20 mm deep in it.
#![allow(
    clippy::disallowed_methods,
    clippy::print_stdout,
    clippy::unwrap_used,
    dead_code,
    reason = "a measuring program: it prints"
)]

#[path = "../../plaus-sim/examples/overlaps/mod.rs"]
mod overlaps;

use glam::DVec3;
use overlaps::Overlaps;
use plaus_dist::{Purpose, Seed, open_unit};
use plaus_scenes::bowling::Alley;
use plaus_sim::{Accuracy, Outcome, Preset, Scratch};

/// Depths in m above which shots are counted.
const DEPTHS: [f64; 6] = [1e-6, 1e-5, 1e-4, 1e-3, 5e-3, 2e-2];

fn argument<T: std::str::FromStr>(k: usize, usual: T) -> T {
    std::env::args().nth(k).and_then(|a| a.parse().ok()).unwrap_or(usual)
}

fn main() {
    let (shots, first): (u64, u64) = (argument(1, 60), argument(3, 0));
    let named: String = argument(2, "standard".into());
    let preset = Preset::ALL.into_iter().find(|p| p.name() == named).unwrap();
    let alley = Alley { accuracy: Accuracy::preset(preset), ..Alley::default() };
    let world = alley.world().unwrap();
    let mut scratch = Scratch::default();
    let (mut counts, mut outcomes) = ([[0_u64; DEPTHS.len()]; 2], [0_u64; 4]);
    let mut deepest = [(0.0_f64, 0); 2];
    for shot in first..first + shots {
        let mut stream = Seed(31).chain(0).at(shot, Purpose::START);
        let mut between = |low: f64, high: f64| low + (high - low) * open_unit(&mut stream);
        // Anywhere on the rack, up to 6 degrees, slow to fast, any spin up to rolling.
        let (angle, speed, distance) = (between(-0.1, 0.1), between(3.0, 9.0), 0.5);
        let velocity = DVec3::new(-angle * speed, speed, 0.0);
        let rolling = DVec3::new(-velocity.y, velocity.x, 0.0) * (between(0.0, 1.0) / alley.ball_radius);
        let x = between(-0.4, 0.4);
        let starts = alley.starts(distance, x, velocity, rolling).unwrap();
        let mut state = world.state(&starts).unwrap();
        let mut watch = Overlaps::new(&world);
        let outcome = world.run(&mut state, &mut scratch, 5.0, &mut watch).unwrap();
        let place = match outcome {
            Outcome::AllAtRest => 0,
            Outcome::TimeReached => 1,
            Outcome::OutOfEvents => 2,
            _ => 3,
        };
        outcomes[place] += 1;
        for kind in 0..2 {
            for (count, &depth) in counts[kind].iter_mut().zip(&DEPTHS) {
                *count += u64::from(watch.deepest[kind] > depth);
            }
            if watch.deepest[kind] > deepest[kind].0 {
                deepest[kind] = (watch.deepest[kind], shot);
            }
        }
        if place > 1 || watch.deepest[0] > 5e-3 {
            println!(
                "shot {shot}: {outcome:?}, {:?} deepest {:.2e} at {:?}",
                state.counts(),
                watch.deepest[0],
                watch.worst
            );
        }
    }
    println!("{shots} shots, {} preset; at rest, time over, out of events, not finite: {outcomes:?}", preset.name());
    for (kind, name) in ["two bodies", "a body and what stands still"].into_iter().enumerate() {
        println!("  {name}: deepest {:.2e} m (shot {}); shots deeper than:", deepest[kind].0, deepest[kind].1);
        for (count, depth) in counts[kind].iter().zip(&DEPTHS) {
            println!("    {depth:.0e} m: {count}");
        }
    }
}

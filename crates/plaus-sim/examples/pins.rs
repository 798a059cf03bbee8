//! Rolls a ball at ten pins many times, and prints how many fell, how much work that was, and how long it took.
//!
//! `cargo run --release -p plaus-sim --example pins -- [shots]`
#![allow(
    clippy::disallowed_methods,
    clippy::print_stdout,
    clippy::unwrap_used,
    reason = "a measuring program: it reads the clock and prints"
)]

use glam::DVec3;
use plaus_dist::{Purpose, Seed, open_unit};
use plaus_sim::worlds::Alley;
use plaus_sim::{Accuracy, Outcome, Preset, Scratch};
use std::time::Instant;

fn main() {
    let shots: usize = std::env::args().nth(1).map_or(100, |a| a.parse().unwrap());
    println!(
        "{:>9} {:>9} {:>9} {:>7} {:>8} {:>8}  pins down 0..10; outcomes (time, rest, events, bad)",
        "preset", "median", "90 %", "events", "impacts", "ns/event"
    );
    for preset in [Preset::Draft, Preset::Standard] {
        row(preset, shots);
    }
}

fn row(preset: Preset, shots: usize) {
    let alley = Alley { accuracy: Accuracy::preset(preset), ..Alley::default() };
    let world = alley.world().unwrap();
    let mut stream = Seed(3).chain(0).at(0, Purpose::START);
    let mut between = |low: f64, high: f64| low + (high - low) * open_unit(&mut stream);
    let mut scratch = Scratch::default();
    let (mut times, mut events, mut impacts) = (Vec::new(), 0, 0);
    let (mut down, mut outcomes) = ([0; 11], [0; 4]);
    for shot in 0..shots {
        // Towards the pocket between the head pin and the 3 pin, up to 6 degrees, rolling.
        let angle = between(-0.02, 0.1);
        let speed = between(7.0, 8.5);
        let velocity = DVec3::new(-angle * speed, speed, 0.0);
        let distance = 2.0;
        let x = between(0.0, 0.1) + angle * distance;
        let spin = DVec3::new(-velocity.y, velocity.x, 0.0) / alley.ball_radius;
        let starts = alley.starts(distance, x, velocity, spin).unwrap();
        let clock = Instant::now();
        let mut state = world.state(&starts).unwrap();
        let outcome = world.run(&mut state, &mut scratch, 5.0, &mut ()).unwrap();
        times.push(clock.elapsed().as_secs_f64());
        if std::env::args().nth(2).is_some() {
            println!("{shot} {outcome:?} {:?}", state.counts());
        }
        events += state.counts().events;
        impacts += state.counts().impacts;
        outcomes[match outcome {
            Outcome::TimeReached => 0,
            Outcome::AllAtRest => 1,
            Outcome::OutOfEvents => 2,
            _ => 3,
        }] += 1;
        let fallen = (1..=10).filter(|&k| {
            let body = world.at(k, &state.bodies()[k], state.time());
            !Alley::stands(k, body.path.x, body.turn * DVec3::Z)
        });
        down[fallen.count()] += 1;
    }
    let total: f64 = times.iter().sum();
    times.sort_by(f64::total_cmp);
    println!(
        "{:>9} {:>7.2}ms {:>7.2}ms {:>7} {:>8} {:>8.0}  {down:?} {outcomes:?}",
        preset.name(),
        1e3 * times[shots / 2],
        1e3 * times[shots * 9 / 10],
        events / shots as u64,
        impacts / shots as u64,
        1e9 * total / events as f64
    );
}

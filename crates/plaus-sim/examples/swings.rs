//! What bodies on joints cost, and how far each preset is from the truth: a double pendulum and Newton's cradle.
//!
//! `cargo run --release -p plaus-sim --example swings -- [draws]`
#![allow(
    clippy::print_stdout,
    clippy::disallowed_methods,
    reason = "a measuring program: it prints, and reads the clock"
)]

#[path = "../tests/common/swings/mod.rs"]
mod swings;

use glam::DVec3;
use plaus_sim::rigid::{RigidBodyState, RigidWorld, Start};
use plaus_sim::{Preset, Scratch};
use std::error::Error;
use std::time::Instant;
use swings::{Cradle, Double};

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

/// The bodies after a time.
fn after(world: &RigidWorld, starts: &[Start], time: f64) -> Result<Vec<RigidBodyState>, Box<dyn Error>> {
    let mut state = world.state(starts)?;
    world.run(&mut state, &mut Scratch::default(), time, &mut ())?;
    Ok(state.bodies().iter().enumerate().map(|(k, body)| world.at(k, body, time)).collect())
}

/// Milliseconds of a run of 2.5 s, the least of five, and its events.
fn cost(world: &RigidWorld, starts: &[Start]) -> Result<(f64, u64), Box<dyn Error>> {
    let mut scratch = Scratch::default();
    let (mut least, mut events) = (f64::INFINITY, 0);
    for _ in 0..5 {
        let mut state = world.state(starts)?;
        let begin = Instant::now();
        world.run(&mut state, &mut scratch, 2.5, &mut ())?;
        least = least.min(begin.elapsed().as_secs_f64() * 1e3);
        events = state.counts().events;
    }
    Ok((least, events))
}

fn main() -> Result<(), Box<dyn Error>> {
    let draws: u32 = std::env::args().nth(1).map_or(Ok(20), |n| n.parse())?;
    let part = |k: u32, step: f64| (0.5 + f64::from(k) * step) % 1.0;
    println!("medians of {draws} draws: ms for 2.5 s, events, error in mm after 1 s");
    for preset in Preset::ALL {
        let (mut ms, mut counts, mut off) = (Vec::new(), Vec::new(), Vec::new());
        for k in 0..draws {
            let double = Double([0.5 + part(k, 0.618_034), 3.0 * part(k, 0.754_878) - 1.0]);
            let (world, starts) = double.world(preset);
            off.push((Double::end(&after(&world, &starts, 1.0)?) - double.truth(1.0, 4000)).length() * 1e3);
            let (least, events) = cost(&world, &starts)?;
            ms.push(least);
            counts.push(events as f64);
        }
        let [ms, events, off] = [ms, counts, off].map(median);
        println!("double pendulum, {}: {ms:.3} ms, {events} events, {off:.2e} mm", preset.name());
    }
    for preset in Preset::ALL {
        let (mut ms, mut counts, mut off) = (Vec::new(), Vec::new(), Vec::new());
        for k in 0..draws {
            let cradle = Cradle(0.3 + 0.6 * part(k, 0.618_034));
            let (world, starts) = cradle.world(preset);
            let bodies = after(&world, &starts, 1.0)?;
            let truth = cradle.truth(1.0, 1e-3);
            let apart = bodies.iter().zip(truth).map(|(body, x): (_, DVec3)| (body.path.x - x).length());
            off.push(apart.fold(0.0, f64::max) * 1e3);
            let (least, events) = cost(&world, &starts)?;
            ms.push(least);
            counts.push(events as f64);
        }
        let [ms, events, off] = [ms, counts, off].map(median);
        println!("cradle, {}: {ms:.3} ms, {events} events, {off:.2e} mm", preset.name());
    }
    Ok(())
}

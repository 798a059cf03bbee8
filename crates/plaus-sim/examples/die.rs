//! Throws a die many times on a flat and on a bumpy table, and prints how it fell, how much work that was, and how long it took.
//!
//! `cargo run --release -p plaus-sim --example die -- [throws] [bumps] [preset]`
#![allow(clippy::disallowed_methods, clippy::print_stdout, clippy::unwrap_used)]

use glam::DVec3;
use plaus_dist::{Purpose, Seed, open_unit};
use plaus_sim::worlds::DieOnTable;
use plaus_sim::{Accuracy, Outcome, Preset, Scratch};
use std::time::Instant;

fn main() {
    let mut args = std::env::args().skip(1);
    let throws: usize = args.next().map_or(2000, |a| a.parse().unwrap());
    let only: Option<f64> = args.next().map(|a| a.parse().unwrap());
    let named = args.next();
    println!(
        "{:>9} {:>6} {:>8} {:>8} {:>7} {:>8} {:>8} {:>6} {:>6}  faces",
        "preset", "bumps", "median", "90 %", "events", "impacts", "ns/event", "rest", "other"
    );
    for bumps in [0.0, 0.1, 0.3].into_iter().filter(|b| only.is_none_or(|o| o == *b)) {
        for preset in
            Preset::ALL.into_iter().filter(|p| named.as_ref().map_or(*p != Preset::Reference, |n| n == p.name()))
        {
            row(preset, bumps, throws);
        }
    }
}

fn noise(i: i64, j: i64) -> f64 {
    let mut h = (i as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ (j as u64).wrapping_mul(0xc2b2_ae3d_27d4_eb4f);
    h ^= h >> 31;
    h = h.wrapping_mul(0xbf58_476d_1ce4_e5b9);
    h ^= h >> 29;
    // Near enough to a Gaussian: a sum of four uniforms.
    let u = |k: u32| f64::from((h >> (16 * k)) as u16) / 65535.0 - 0.5;
    (u(0) + u(1) + u(2) + u(3)) * 3.0_f64.sqrt()
}

fn row(preset: Preset, bumps: f64, throws: usize) {
    let die = DieOnTable { bumps, accuracy: Accuracy::preset(preset), ..DieOnTable::default() };
    let mut rng = Seed(1).chain(0).at(0, Purpose::START);
    let mut scratch = Scratch::default();
    let (mut times, mut events, mut impacts, mut rest, mut other) = (Vec::new(), 0, 0, 0, 0);
    let mut faces = [0; 6];
    for _ in 0..throws {
        let start = die.throw(|| open_unit(&mut rng));
        let clock = Instant::now();
        let world = die.world(noise).unwrap();
        let mut state = world.state(&[start]).unwrap();
        let outcome = world.run(&mut state, &mut scratch, 20.0, &mut ()).unwrap();
        times.push(clock.elapsed().as_secs_f64());
        events += state.counts().events;
        impacts += state.counts().impacts;
        let body = &state.bodies()[0];
        if outcome == Outcome::AllAtRest {
            rest += 1;
        } else {
            other += 1;
        }
        let up = body.turn.conjugate() * DVec3::Z;
        let k = (0..3).max_by(|&a, &b| up[a].abs().total_cmp(&up[b].abs())).unwrap();
        faces[2 * k + usize::from(up[k] > 0.0)] += 1;
    }
    let total: f64 = times.iter().sum();
    times.sort_by(f64::total_cmp);
    println!(
        "{:>9} {bumps:>6} {:>6.1}us {:>6.1}us {:>7.1} {:>8.1} {:>8.0} {rest:>6} {other:>6}  {faces:?}",
        preset.name(),
        1e6 * times[throws / 2],
        1e6 * times[throws * 9 / 10],
        events as f64 / throws as f64,
        impacts as f64 / throws as f64,
        1e9 * total / events as f64
    );
}

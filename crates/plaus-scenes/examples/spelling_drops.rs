//! Random ten-marble drops into bins, checked for tunnelling and for valid rest, with timing:
//! `cargo run --release -p plaus-scenes --example spelling_drops -- 100000 standard`.
//!
//! Further arguments: the number of marbles, the seconds between them, and `time` to measure only time, the fastest of
//! nine runs of each draw: `-- 1000 standard 10 0.1 time`.
#![allow(
    clippy::disallowed_methods,
    clippy::print_stdout,
    clippy::unwrap_used,
    reason = "a measuring program: it reads the clock and prints"
)]

#[path = "../../plaus-sim/examples/measure/mod.rs"]
mod measure;
#[path = "../../../tests/tests/spelling/watch.rs"]
mod watch;

use measure::Digest;
use plaus_dist::{Purpose, Seed, open_unit};
use plaus_scenes::spelling::{Bins, drops};
use plaus_sim::marbles::{Marble, Marbles, Phase, Start};
use plaus_sim::{Accuracy, Outcome, Preset, Scratch, State};
use std::time::Instant;
use watch::Watch;

#[derive(Default)]
struct Tally {
    tunnelled: usize,
    overlaps: usize,
    not_at_rest: usize,
    in_bins: usize,
    on_ridges: usize,
    on_marbles: usize,
    unsupported: usize,
    out_of_events: usize,
    events: u64,
    impacts: u64,
    expiries: u64,
    stale: u64,
    micros: Vec<f64>,
}

impl Tally {
    fn judge(&mut self, bins: &Bins, world: &Marbles, state: &State<Marble>) {
        let bodies = state.bodies();
        for (k, b) in bodies.iter().enumerate() {
            let x = b.path.at(state.time().max(b.path.t));
            let sunk = world.scenery().deepest_overlap(x, bins.marble).is_some_and(|(_, d)| d > 1e-4 * bins.marble);
            let close = bodies[..k]
                .iter()
                .any(|c| (c.path.at(state.time().max(c.path.t)) - x).length() < 2.0 * bins.marble * (1.0 - 1e-4));
            self.overlaps += usize::from(sunk || close);

            if b.phase != Phase::Rest {
                self.not_at_rest += 1;
                continue;
            }
            let linked = state.links().of(k as u32).next().is_some();
            if x.z < bins.height {
                self.in_bins += 1;
            } else if linked {
                self.on_marbles += 1;
            } else {
                self.on_ridges += 1;
            }
            let touching = |c: &plaus_sim::scenery::Surface| {
                let foot = world.scenery().project(*c, x);
                foot.normal.z > 0.0 && (foot.distance - bins.marble).abs() < 1e-4 * bins.marble
            };
            self.unsupported += usize::from(!linked && !b.contacts().iter().any(touching));
        }
    }
}

/// Runs of each draw if only time is measured.
const REPEATS: usize = 9;

fn main() {
    let mut args = std::env::args().skip(1);
    let runs: usize = args.next().map_or(100, |a| a.parse().unwrap());
    let name = args.next().unwrap_or("standard".into());
    let preset = Preset::ALL.into_iter().find(|p| p.name() == name).unwrap();
    let count: usize = args.next().map_or(10, |a| a.parse().unwrap());
    let interval: f64 = args.next().map_or(0.1, |a| a.parse().unwrap());
    let only_time = args.next().is_some_and(|a| a == "time");
    let bins = Bins::default();
    let mut world = bins
        .world(count, Accuracy { events: 1000, ..Accuracy::preset(preset) }, interval * count as f64 + 1.0)
        .unwrap();
    let mut scratch = Scratch::default();
    let (mut tally, mut digest) = (Tally::default(), Digest::new());
    for run in 0..runs {
        let mut stream = Seed(7).chain(0).at(run as u64, Purpose::START);
        let mut uniform = || open_unit(&mut stream);
        world.move_vertices(&bins.perturbed(0.0001, &mut uniform)).unwrap();
        let starts: Vec<Start> = drops(&bins, count, interval, &mut uniform);
        let mut state = world.state(&starts).unwrap();
        let fresh = state.clone();
        let mut fastest = f64::INFINITY;
        let mut outcome = Outcome::TimeReached;
        // The fastest of several, because other programs on the machine can only add time.
        for _ in 0..if only_time { REPEATS } else { 1 } {
            state.clone_from(&fresh);
            let begin = Instant::now();
            outcome = world.run(&mut state, &mut scratch, 1e9, &mut ()).unwrap();
            fastest = fastest.min(begin.elapsed().as_secs_f64() * 1e6);
        }
        tally.micros.push(fastest);
        for b in state.bodies() {
            digest.add_all(b.path.x.to_array().into_iter().chain(b.path.v.to_array()).chain([b.path.t]));
        }
        let counts = state.counts();
        tally.events += counts.events;
        tally.impacts += counts.impacts;
        tally.expiries += counts.expiries;
        tally.stale += counts.stale;
        tally.out_of_events += usize::from(!matches!(outcome, Outcome::AllAtRest | Outcome::TimeReached));
        if only_time {
            continue;
        }
        let mut watch = Watch::new(&bins, count);
        tally.judge(&bins, &world, &state);
        let mut again = world.state(&starts).unwrap();
        world.run(&mut again, &mut scratch, 1e9, &mut watch).unwrap();
        tally.tunnelled += watch.tunnelled();
        if watch.tunnelled() > 0 || outcome == Outcome::OutOfEvents {
            println!("run {run}: {} motions through something, {outcome:?}", watch.tunnelled());
        }
    }
    let total: f64 = tally.micros.iter().sum();
    tally.micros.sort_by(f64::total_cmp);
    let at = |q: f64| tally.micros[((runs - 1) as f64 * q) as usize] / 1000.0;
    println!("{runs} runs of {count} marbles, one every {interval} s, preset {name}");
    println!(
        "tunnelled {}, overlapping at the end {}, out of events {}",
        tally.tunnelled, tally.overlaps, tally.out_of_events
    );
    println!(
        "at rest: in bins {}, on ridges {}, on marbles {}, unsupported {}; still moving {}",
        tally.in_bins, tally.on_ridges, tally.on_marbles, tally.unsupported, tally.not_at_rest
    );
    println!("ms per run: median {:.4}, 10% {:.4}, 90% {:.4}, worst {:.4}", at(0.5), at(0.1), at(0.9), at(1.0));
    println!(
        "impacts per run {:.1}, expiries {:.1}, stale {:.1}",
        tally.impacts as f64 / runs as f64,
        tally.expiries as f64 / runs as f64,
        tally.stale as f64 / runs as f64
    );
    println!(
        "events per run {:.1}, ns per event {:.0}",
        tally.events as f64 / runs as f64,
        total * 1000.0 / tally.events as f64
    );
    println!("digest of the outcomes {:016x}", digest.get());
}

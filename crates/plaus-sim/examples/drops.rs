//! Random ten-marble drops into bins, checked for tunnelling and for valid rest, with timing: `cargo run --release -p plaus-sim --example drops -- 100000 standard`.
#![allow(clippy::disallowed_methods, clippy::print_stdout, clippy::unwrap_used, reason = "a measuring program: it reads the clock and prints")]

use glam::DVec3;
use plaus_dist::{Purpose, Seed, open_unit};
use plaus_sim::marbles::{Marble, Marbles, Phase, Start};
use plaus_sim::trace::Observer;
use plaus_sim::worlds::{Bins, drops};
use plaus_sim::{Accuracy, Outcome, Preset, Scratch, State};
use std::time::Instant;

/// Watches every motion: below the ridges no marble may change its bin, leave the box or sink through the floor.
struct Watch<'b> {
    bins: &'b Bins,
    last: Vec<Option<(usize, usize)>>,
    tunnelled: usize,
}

impl Observer<Marbles> for Watch<'_> {
    fn motion(&mut self, index: usize, body: &Marble) {
        let x = body.path.x;
        let below = x.z < self.bins.height - 2.0 * self.bins.margin;
        let now = self.bins.bin_of(x);
        if now.is_none() || x.z < self.bins.marble - 1e-9 || (below && self.last[index].is_some_and(|b| Some(b) != now)) {
            self.tunnelled += 1;
        }
        self.last[index] = if below { now } else { None };
    }
}

fn perturbed(bins: &Bins, world: &mut Marbles, uniform: &mut impl FnMut() -> f64) {
    let moved: Vec<(u32, DVec3)> = (0..bins.crossings())
        .map(|k| {
            let normal = || DVec3::new(uniform(), uniform(), uniform());
            // A sum of uniforms, 0.1 mm per axis.
            let offset = std::iter::repeat_with(normal).take(4).fold(DVec3::splat(-2.0), |a, b| a + b) * (0.0001 * 3.0_f64.sqrt());
            (k as u32, bins.crossing(k) + offset)
        })
        .collect();
    world.move_vertices(&moved).unwrap();
}

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
    micros: Vec<f64>,
}

impl Tally {
    fn judge(&mut self, bins: &Bins, world: &Marbles, state: &State<Marble>) {
        let bodies = state.bodies();
        for (k, b) in bodies.iter().enumerate() {
            let x = b.path.at(state.time().max(b.path.t));
            let sunk = world.scenery().deepest_overlap(x, bins.marble).is_some_and(|(_, d)| d > 1e-4 * bins.marble);
            let close = bodies[..k].iter().any(|c| (c.path.at(state.time().max(c.path.t)) - x).length() < 2.0 * bins.marble * (1.0 - 1e-4));
            self.overlaps += usize::from(sunk || close);
            if b.phase != Phase::Rest {
                self.not_at_rest += 1;
                continue;
            }
            let linked = state.links().iter().any(|l| l.contains(&(k as u32)));
            if x.z < bins.height {
                self.in_bins += 1;
            } else if linked {
                self.on_marbles += 1;
            } else {
                self.on_ridges += 1;
            }
            let touching = |c: &plaus_sim::scenery::Surface| {
                let foot = world.scenery().foot(*c, x);
                foot.normal.z > 0.0 && (foot.distance - bins.marble).abs() < 1e-4 * bins.marble
            };
            self.unsupported += usize::from(!linked && !b.contacts().iter().any(touching));
        }
    }
}

fn main() {
    let mut args = std::env::args().skip(1);
    let runs: usize = args.next().map_or(1000, |a| a.parse().unwrap());
    let name = args.next().unwrap_or("standard".into());
    let preset = Preset::ALL.into_iter().find(|p| p.name() == name).unwrap();
    let count: usize = args.next().map_or(10, |a| a.parse().unwrap());
    let interval: f64 = args.next().map_or(0.1, |a| a.parse().unwrap());
    let bins = Bins::default();
    let mut world = bins.world(count, Accuracy { events: 1000, ..Accuracy::preset(preset) }, interval * count as f64 + 1.0).unwrap();
    let mut scratch = Scratch::default();
    let mut tally = Tally::default();
    for run in 0..runs {
        let mut stream = Seed(7).chain(0).at(run as u64, Purpose::START);
        let mut uniform = || open_unit(&mut stream);
        perturbed(&bins, &mut world, &mut uniform);
        let starts: Vec<Start> = drops(&bins, count, interval, &mut uniform);
        let mut state = world.state(&starts).unwrap();
        let begin = Instant::now();
        let outcome = world.run(&mut state, &mut scratch, 1e9, &mut ());
        tally.micros.push(begin.elapsed().as_secs_f64() * 1e6);
        tally.events += state.counts().events;
        tally.out_of_events += usize::from(!matches!(outcome, Outcome::AllAtRest | Outcome::TimeReached));
        tally.judge(&bins, &world, &state);
        let mut watch = Watch { bins: &bins, last: vec![None; count], tunnelled: 0 };
        let mut again = world.state(&starts).unwrap();
        world.run(&mut again, &mut scratch, 1e9, &mut watch);
        tally.tunnelled += watch.tunnelled;
        if watch.tunnelled > 0 || outcome == Outcome::OutOfEvents {
            println!("run {run}: {} motions through something, {outcome:?}", watch.tunnelled);
        }
    }
    let total: f64 = tally.micros.iter().sum();
    tally.micros.sort_by(f64::total_cmp);
    let at = |q: f64| tally.micros[((runs - 1) as f64 * q) as usize] / 1000.0;
    println!("{runs} runs of {count} marbles, one every {interval} s, preset {name}");
    println!("tunnelled {}, overlapping at the end {}, out of events {}", tally.tunnelled, tally.overlaps, tally.out_of_events);
    println!(
        "at rest: in bins {}, on ridges {}, on marbles {}, unsupported {}; still moving {}",
        tally.in_bins, tally.on_ridges, tally.on_marbles, tally.unsupported, tally.not_at_rest
    );
    println!("ms per run: median {:.4}, 10% {:.4}, 90% {:.4}, worst {:.4}", at(0.5), at(0.1), at(0.9), at(1.0));
    println!("events per run {:.1}, ns per event {:.0}", tally.events as f64 / runs as f64, total * 1000.0 / tally.events as f64);
}

//! Random ten-marble drops into bins, checked for tunnelling and for valid rest, with timing: `cargo run --release -p plaus-sim --example drops -- 100000 standard`.
#![allow(clippy::disallowed_methods, clippy::print_stdout, clippy::unwrap_used, reason = "a measuring program: it reads the clock and prints")]

use glam::DVec3;
use plaus_dist::{Purpose, Seed, open_unit};
use plaus_sim::marbles::{Marble, Marbles, Phase, Start};
use plaus_sim::motion::Parabola;
use plaus_sim::roots::roots_of_quadratic;
use plaus_sim::trace::Observer;
use plaus_sim::worlds::{Bins, drops};
use plaus_sim::{Accuracy, Outcome, Preset, Scratch, State};
use std::time::Instant;

/// Watches every motion: a marble may cross the middle of a partition only above it, and stays in the box and above the floor.
struct Watch<'b> {
    bins: &'b Bins,
    last: Vec<Option<Parabola>>,
    tunnelled: usize,
}

impl Watch<'_> {
    /// Whether the way of a centre between two times crosses no middle plane of a partition below its ridge.
    fn is_clear(&self, path: &Parabola, until: f64) -> bool {
        let clear = self.bins.height - 2.0 * self.bins.margin + 0.9 * self.bins.marble;
        (0..2).all(|axis| {
            let lines = 1..[self.bins.columns, self.bins.rows][axis];
            lines.into_iter().all(|line| {
                let c = [path.x[axis] - line as f64 * self.bins.side, path.v[axis], 0.5 * path.a[axis]];
                let times = roots_of_quadratic(c).into_iter().flatten();
                times.into_iter().all(|dt| dt < 0.0 || path.t + dt > until || path.after(dt).z > clear)
            })
        })
    }
}

impl Observer<Marbles> for Watch<'_> {
    fn motion(&mut self, index: usize, body: &Marble) {
        let (x, r) = (body.path.x, self.bins.marble);
        let (width, breadth) = self.bins.extent();
        let inside = x.z > r * (1.0 - 1e-4) && x.x > 0.0 && x.y > 0.0 && x.x < width && x.y < breadth;
        let clear = self.last[index].is_none_or(|path| self.is_clear(&path, body.path.t));
        self.tunnelled += usize::from(!inside || !clear);
        self.last[index] = Some(body.path);
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
    impacts: u64,
    expiries: u64,
    stale: u64,
    micros: Vec<f64>,
}

impl Tally {
    fn judge(&mut self, bins: &Bins, world: &Marbles, state: &State<Marble>, run: usize) {
        let bodies = state.bodies();
        for (k, b) in bodies.iter().enumerate() {
            let x = b.path.at(state.time().max(b.path.t));
            let sunk = world.scenery().deepest_overlap(x, bins.marble).is_some_and(|(_, d)| d > 1e-4 * bins.marble);
            let close = bodies[..k].iter().any(|c| (c.path.at(state.time().max(c.path.t)) - x).length() < 2.0 * bins.marble * (1.0 - 1e-4));
            self.overlaps += usize::from(sunk || close);
            if sunk || close { println!("run {run} body {k} {x} {:?} {:?} {:?} sunk {:?} close {close}", b.phase, b.contacts(), state.links(),world.scenery().deepest_overlap(x, bins.marble).map(|(s,d)|(s,d/bins.marble))); }
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
        let counts = state.counts();
        tally.events += counts.events;
        tally.impacts += counts.impacts;
        tally.expiries += counts.expiries;
        tally.stale += counts.stale;
        tally.out_of_events += usize::from(!matches!(outcome, Outcome::AllAtRest | Outcome::TimeReached));
        tally.judge(&bins, &world, &state, run);
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
    println!("impacts per run {:.1}, expiries {:.1}, stale {:.1}", tally.impacts as f64 / runs as f64, tally.expiries as f64 / runs as f64, tally.stale as f64 / runs as f64);
    println!("events per run {:.1}, ns per event {:.0}", tally.events as f64 / runs as f64, total * 1000.0 / tally.events as f64);
}

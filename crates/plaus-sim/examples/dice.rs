//! Throws several dice together many times. Prints how it ended, how deep any two dice or a die and the table ever
//! overlapped, and how long it took.
//!
//! `cargo run --release -p plaus-sim --example dice -- [throws] [dice] [bumps] [preset] [first throw]`
//!
//! Whenever a die begins a new motion, overlaps are measured by the distance of the skins, at that time and half way
//! from the last one: not only at the end.
#![allow(
    clippy::disallowed_methods,
    clippy::print_stdout,
    clippy::unwrap_used,
    reason = "a measuring program: it reads the clock and prints"
)]

mod measure;
mod overlaps;

use measure::{noise, processor_time};
use overlaps::Overlaps;
use plaus_dist::{Purpose, Seed, open_unit};
use plaus_sim::worlds::DieOnTable;
use plaus_sim::{Accuracy, Outcome, Preset, Scratch};
use std::time::Instant;

fn argument<T: std::str::FromStr>(k: usize, usual: T) -> T {
    std::env::args().nth(k).and_then(|a| a.parse().ok()).unwrap_or(usual)
}

fn main() {
    let (throws, dice): (u64, usize) = (argument(1, 1000), argument(2, 6));
    let bumps: f64 = argument(3, 0.0);
    let named: String = argument(4, "standard".into());
    let first: u64 = argument(5, 0);
    let preset = Preset::ALL.into_iter().find(|p| p.name() == named).unwrap();
    let die = DieOnTable { bumps, accuracy: Accuracy::preset(preset), ..DieOnTable::default() };
    let mut tally = Tally::default();
    for k in first..first + throws {
        tally.throw(&die, dice, k);
    }
    tally.print(&format!("{dice} dice, {} preset, bumps {bumps}", preset.name()));
}

#[derive(Default)]
struct Tally {
    times: Vec<f64>,
    /// Total for the timed runs, in s.
    on_processor: f64,
    events: u64,
    impacts: u64,
    /// At rest, time over, out of events, not finite.
    outcomes: [u64; 4],
    /// Deepest overlaps over the size: of dice with each other, and with the table.
    deepest: [f64; 2],
    /// Throws in which dice overlapped by more than a hundredth of their size.
    deep: u64,
    worst: u64,
    stacked: u64,
}

impl Tally {
    fn throw(&mut self, die: &DieOnTable, dice: usize, k: u64) {
        let mut stream = Seed(7).chain(0).at(k, Purpose::START);
        let starts = die.throw_together(dice, || open_unit(&mut stream));
        let (mut scratch, clock, cpu) = (Scratch::default(), Instant::now(), processor_time().unwrap_or(0.0));
        let world = die.world_of(dice, noise).unwrap();
        let mut state = world.state(&starts).unwrap();
        let outcome = world.run(&mut state, &mut scratch, 20.0, &mut ()).unwrap();
        self.times.push(clock.elapsed().as_secs_f64());
        self.on_processor += processor_time().unwrap_or(0.0) - cpu;
        // Once more, with an observer.
        let mut state = world.state(&starts).unwrap();
        let mut watch = Overlaps::new(&world);
        assert_eq!(world.run(&mut state, &mut scratch, 20.0, &mut watch).unwrap(), outcome);
        self.events += state.counts().events;
        self.impacts += state.counts().impacts;
        let place = match outcome {
            Outcome::AllAtRest => 0,
            Outcome::TimeReached => 1,
            Outcome::OutOfEvents => 2,
            _ => 3,
        };
        self.outcomes[place] += 1;
        let size = 0.5 * die.edges.min_element();
        let deepest = watch.deepest.map(|d| d / size);
        if place != 0 || deepest[0] > 1e-2 {
            println!(
                "throw {k}: {outcome:?} at {} s, {:.1} ms, {:?}, overlaps {:.1e} {:.1e}",
                state.time(),
                1e3 * self.times[self.times.len() - 1],
                state.counts(),
                deepest[0],
                deepest[1]
            );
        }
        self.deep += u64::from(deepest[0] > 1e-2);
        if deepest[0] > self.deepest[0] {
            self.worst = k;
        }
        self.deepest = [0, 1].map(|k| self.deepest[k].max(deepest[k]));
        let high = state.bodies().iter().any(|b| b.path.x.z > 1.5 * die.edges.z);
        self.stacked += u64::from(die.bumps == 0.0 && high);
    }

    fn print(&mut self, what: &str) {
        self.times.sort_by(f64::total_cmp);
        let (n, total) = (self.times.len(), self.on_processor);
        let at = |part: usize| 1e3 * self.times[n * part / 100];
        println!("{what}: {n} throws");
        println!(
            "  at rest, time over, out of events, not finite: {:?}; a die on another at the end: {}",
            self.outcomes, self.stacked
        );
        println!(
            "  deepest overlap over half an edge, ever: {:.1e} of two dice (throw {}), {:.1e} with the table; {} throws beyond 1e-2",
            self.deepest[0], self.worst, self.deepest[1], self.deep
        );
        println!(
            "  {:.3} ms in the median, {:.3} at 99 % on the wall, {:.3} mean on the processor; {:.0} events, {:.0} impacts, {:.0} ns an event",
            at(50),
            at(99),
            1e3 * total / n as f64,
            self.events as f64 / n as f64,
            self.impacts as f64 / n as f64,
            1e9 * total / self.events as f64
        );
    }
}

//! Throws a die many times on a flat and on bumpy tables. Prints how it fell, how much work that was, and how long it
//! took. The first throw on a bumpy table is written as JSON, with all its motions and impacts.
//!
//! `cargo run --release -p plaus-sim --example die -- [throws] [bumps] [preset] [--trace PATH]`
#![allow(clippy::print_stdout, reason = "a measuring program: it prints")]

mod measure;

use glam::DVec3;
use measure::{Digest, Stopwatch, arguments, noise, write_trace};
use plaus_dist::{Purpose, Seed, open_unit};
use plaus_sim::trace::Trace;
use plaus_sim::worlds::DieOnTable;
use plaus_sim::{Accuracy, Outcome, Preset, Scratch, WorldError};
use std::error::Error;

fn main() -> Result<(), Box<dyn Error>> {
    let (args, path) = arguments("target/die.json")?;
    let throws: usize = args.first().map_or(Ok(500), |a| a.parse())?;
    let only: Option<f64> = args.get(1).map(|a| a.parse()).transpose()?;
    let is_asked = |p: &Preset| args.get(2).map_or(*p != Preset::Reference, |name| name == p.name());
    println!(
        "{:>9} {:>6} {:>8} {:>8} {:>8} {:>7} {:>8} {:>6} {:>6}  {:<16}  faces",
        "preset", "bumps", "median", "90 %", "cpu/thr", "events", "impacts", "rest", "other", "digest"
    );
    for bumps in [0.0, 0.1, 0.3].into_iter().filter(|b| only.is_none_or(|o| o == *b)) {
        for preset in Preset::ALL.into_iter().filter(is_asked) {
            row(preset, bumps, throws)?;
        }
    }
    let die = DieOnTable { bumps: only.unwrap_or(0.1), ..DieOnTable::default() };
    let mut rng = Seed(1).chain(0).at(0, Purpose::START);
    let world = die.world(noise)?;
    let mut state = world.state(&[die.throw(|| open_unit(&mut rng))])?;
    let mut trace = Trace::default();
    let outcome = world.run(&mut state, &mut Scratch::default(), 20.0, &mut trace)?;
    write_trace(&path, &trace)?;
    println!(
        "wrote {path}: {} motions and {} impacts, {outcome:?} at {:.3} s",
        trace.motions[0].len(),
        trace.impacts.len(),
        state.time()
    );
    Ok(())
}

fn row(preset: Preset, bumps: f64, throws: usize) -> Result<(), WorldError> {
    let die = DieOnTable { bumps, accuracy: Accuracy::preset(preset), ..DieOnTable::default() };
    let mut rng = Seed(1).chain(0).at(0, Purpose::START);
    let mut scratch = Scratch::default();
    let (mut events, mut impacts, mut rest, mut other) = (0, 0, 0, 0);
    let (mut faces, mut digest) = ([0; 6], Digest::new());
    let mut watch = Stopwatch::start();
    for _ in 0..throws {
        let start = die.throw(|| open_unit(&mut rng));
        // The table is new for each throw, as it is for a sampler.
        let (state, outcome) = watch.time(|| {
            let world = die.world(noise)?;
            let mut state = world.state(&[start])?;
            let outcome = world.run(&mut state, &mut scratch, 20.0, &mut ())?;
            Ok::<_, WorldError>((state, outcome))
        })?;
        events += state.counts().events;
        impacts += state.counts().impacts;
        let body = &state.bodies()[0];
        digest.add_all(body.path.x.to_array().into_iter().chain(body.turn.to_array()));
        if outcome == Outcome::AllAtRest {
            rest += 1;
        } else {
            other += 1;
        }
        let up = body.turn.conjugate() * DVec3::Z;
        let k = (0..3).fold(0, |best, k| if up[k].abs() > up[best].abs() { k } else { best });
        faces[2 * k + usize::from(up[k] > 0.0)] += 1;
    }
    println!(
        "{:>9} {bumps:>6} {:>6.1}us {:>6.1}us {:>6.1}us {:>7.1} {:>8.1} {rest:>6} {other:>6}  {:016x}  {faces:?}",
        preset.name(),
        1e6 * watch.quantile(0.5),
        1e6 * watch.quantile(0.9),
        1e6 * watch.mean(),
        events as f64 / throws as f64,
        impacts as f64 / throws as f64,
        digest.get()
    );
    Ok(())
}

//! A driven body presses random others against joints and walls, as the test `rigid_wedges` does with a few worlds.
//!
//! `cargo run --release -p plaus-sim --example wedges -- [first world] [number of worlds] [preset]`
#![allow(clippy::print_stdout, reason = "a measuring program: it prints")]

#[path = "../tests/common/laws/mod.rs"]
mod laws;
mod measure;

use laws::record::preset;
use laws::wedges::Wedge;
use measure::Stopwatch;
use plaus_sim::{Outcome, Preset};
use std::error::Error;

fn main() -> Result<(), Box<dyn Error>> {
    let mut args = std::env::args().skip(1);
    let first: u64 = args.next().map_or(Ok(0), |a| a.parse())?;
    let count: u64 = args.next().map_or(Ok(4), |a| a.parse())?;
    let chosen = args.next().map(|a| preset(&a).ok_or("draft, standard, fine or reference")).transpose()?;
    for preset in Preset::ALL.into_iter().filter(|p| chosen.is_none_or(|c| c == *p)) {
        let (mut worlds, mut bad, mut crushed, mut events) = (0, 0, 0, 0);
        let mut watch = Stopwatch::start();
        for seed in first..first + count {
            let Some(wedge) = Wedge::new(seed, preset) else { continue };
            worlds += 1;
            let went = watch.time(|| wedge.run(20_000));
            events += went.events;
            let ratio = went.fastest.map(|v| v / wedge.most());
            let is_over = matches!(went.outcome, Outcome::TimeReached | Outcome::AllAtRest | Outcome::Crushed { .. });
            crushed += u64::from(matches!(went.outcome, Outcome::Crushed { .. }));
            let is_bad = ratio.iter().any(|r| *r > 1.0) || !is_over;
            bad += u64::from(is_bad);
            if is_bad || count == 1 {
                println!("{} {seed}: {ratio:.1?} of {:.1} {went:?}", preset.name(), wedge.most());
            }
        }
        println!(
            "{}: {worlds} worlds, {crushed} crushed, {bad} bad, {events} events, seconds: median {:.4} longest {:.2}",
            preset.name(),
            watch.quantile(0.5),
            watch.quantile(1.0 - 1e-9)
        );
    }
    Ok(())
}

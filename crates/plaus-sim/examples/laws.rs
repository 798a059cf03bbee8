//! Throws random bodies of every shape and checks momentum, Coulomb's bound and energy from event to event, as the test
//! `laws_random` does with a few of them.
//!
//! `cargo run --release -p plaus-sim --example laws -- [worlds of each case] [preset] [part of a case's name]`
#![allow(clippy::print_stdout, reason = "a measuring program: it prints")]

#[path = "../tests/common/laws/mod.rs"]
mod laws;
mod measure;

use laws::campaign::{Case, tally};
use laws::record::preset;
use measure::Stopwatch;
use plaus_sim::Preset;
use std::error::Error;

fn main() -> Result<(), Box<dyn Error>> {
    let mut args = std::env::args().skip(1);
    let worlds: u64 = args.next().map_or(Ok(8), |a| a.parse())?;
    let chosen = args.next().map(|a| preset(&a).ok_or("draft, standard, fine or reference")).transpose()?;
    let wanted = args.next().unwrap_or_default();
    println!(
        "{:<30} {:<10} {:>7} {:>9} {:>7} {:>9} {:>9} {:>12} {:>8}",
        "law", "preset", "worlds", "events", "broken", "bounds", "by", "twins", "seconds"
    );
    for case in Case::ALL.into_iter().filter(|c| c.name().contains(&wanted)) {
        for preset in Preset::ALL.into_iter().filter(|p| chosen.is_none_or(|c| c == *p)) {
            let mut watch = Stopwatch::start();
            let t = watch.time(|| tally(case, preset, 0..worlds));
            println!(
                "{:<30} {:<10} {:>7} {:>9} {:>7} {:>9.1e} {:>9.1e} {:>5} of {:>4} {:>7.2}",
                case.name(),
                preset.name(),
                t.worlds,
                t.events,
                t.broken.len(),
                t.worst[0],
                t.worst[1],
                t.twins[1],
                t.twins[0],
                watch.quantile(0.5)
            );
            for (throw, kind, worst, size) in t.broken.iter().take(3) {
                println!("    world {throw} ({kind:?}): {worst:.1e} bounds, {size:.1e}");
            }
        }
    }
    Ok(())
}

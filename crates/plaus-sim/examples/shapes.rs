//! Throws every shape into every scenery, alone and in company:
//! `cargo run --release -p plaus-sim --example shapes [throws per pair]`.

#![allow(clippy::print_stdout, reason = "an example prints")]

#[path = "../tests/common/zoo.rs"]
mod zoo;

use plaus_sim::{Outcome, Preset};
use zoo::{Body, Place, throw};

fn main() {
    let throws: u64 = std::env::args().nth(1).and_then(|n| n.parse().ok()).unwrap_or(1);
    let (mut lost, mut endless, mut total) = (0, 0, 0);
    println!(
        "{:>10} {:>11} {:>6} {:>6} {:>9} {:>9} {:>9} {:>8}",
        "body", "place", "rest", "out", "outside", "deep", "gain", "events"
    );
    for body in Body::ALL {
        for place in Place::ALL {
            let (mut rest, mut stuck, mut out, mut deep, mut gain, mut events) =
                (0, 0, f64::NEG_INFINITY, 0.0_f64, 0.0_f64, 0);
            for k in 0..throws {
                let fate = throw(&[body], place, k, Preset::Standard, 3.0);
                rest += u64::from(fate.outcome == Outcome::AllAtRest);
                stuck += u64::from(matches!(fate.outcome, Outcome::OutOfEvents | Outcome::NotFinite { .. }));
                lost += u64::from(fate.out > 0.0);
                if fate.out > 0.0 || !matches!(fate.outcome, Outcome::AllAtRest | Outcome::TimeReached) {
                    println!("  {body:?} {place:?} throw {k}: {fate:?}");
                }
                (out, deep, gain) = (f64::max(out, fate.out), deep.max(fate.deep), gain.max(fate.gain));
                events += fate.events;
            }
            total += throws;
            endless += stuck;
            let (body, place) = (format!("{body:?}"), format!("{place:?}"));
            println!(
                "{body:>10} {place:>11} {rest:>6} {stuck:>6} {out:>9.2} {deep:>9.1e} {gain:>9.1e} {:>8}",
                events / throws
            );
        }
    }
    println!("{total} throws: {lost} out of their place, {endless} out of events or not finite");
}

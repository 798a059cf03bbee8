//! Hard cases of contact at every preset: the expected result, the result found, and what it took.
//!
//!     cargo run --release -p plaus-sim --example contact_cases -- \
//!         [seconds for each run] [preset, or all] [part of a name] [file of tosses]
//!
//! By default each run gets only 0.05 s, and many are cut off; `-- 20` runs everything. The file of tosses holds real
//! ones, one per line: see `read_tosses` in `tests/common/cases/throws.rs`.
#![allow(clippy::print_stdout, reason = "a measuring program: it prints")]

#[path = "../tests/common/cases/mod.rs"]
mod cases;
#[path = "../tests/common/laws/mod.rs"]
mod laws;
mod measure;

use cases::{CASES, Guard, Setting, read_tosses};
use laws::record::preset;
use measure::Stopwatch;
use plaus_sim::Preset;
use std::error::Error;

fn main() -> Result<(), Box<dyn Error>> {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let seconds: f64 = args.first().map_or(Ok(0.05), |a| a.parse())?;
    let name = args.get(1).filter(|a| *a != "all");
    let chosen = name.map(|a| preset(a).ok_or("draft, standard, fine, reference or all")).transpose()?;
    let wanted = args.get(2).map_or("", String::as_str);
    let tosses = args.get(3).map(std::fs::read_to_string).transpose()?;
    let tosses = tosses.map_or(Ok(Vec::new()), |text| read_tosses(&text))?;
    let guard = Guard { seconds, events: if seconds < 1.0 { 1_000 } else { 2_000_000 } };
    for case in CASES.iter().filter(|c| c.name.contains(wanted)) {
        println!("{}: {}", case.name, case.expected);
        for preset in Preset::ALL.into_iter().filter(|p| chosen.is_none_or(|c| c == *p)) {
            let throws = if seconds < 1.0 { 2 } else { 40 };
            let setting = Setting { preset, guard, throws, tosses: &tosses };
            let mut watch = Stopwatch::start();
            let found = watch.time(|| (case.run)(&setting));
            let verdict = if found.holds { "holds" } else { "FAILS" };
            println!("  {:<10} {verdict}  {:>7.2} s  {}", preset.name(), watch.quantile(0.5), found.text);
        }
    }
    Ok(())
}

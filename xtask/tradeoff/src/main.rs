//! What each preset of the simulator costs and gives, compared with rapier3d at several time steps:
//! `cargo xtask tradeoff`.
//!
//! A world is one file of `worlds` that implements [`World`](world::World), or [`Setting`](staged::Setting) where its
//! bodies and scenery are said once for both simulators; `peer` builds the worlds in rapier.
//! Cases with an exact answer are in `exact`.
#![allow(clippy::print_stderr, reason = "progress is for the person who waits")]
#![allow(clippy::disallowed_methods, reason = "it measures time")]

mod exact;
mod measure;
mod peer;
mod plots;
mod report;
mod staged;
mod world;
mod worlds;

use measure::{Plan, measure};
use plaus_figures::Result;
use plaus_figures::report::table;
use plaus_sim::Preset;
use std::fmt::Write as _;
use std::path::PathBuf;
use std::process::ExitCode;
use world::Way;

const USAGE: &str =
    "usage: cargo xtask tradeoff [--worlds A,B] [--draws N] [--seconds S] [--presets A,B] [--rates A,B] [--out FOLDER] [--quick]

    --worlds A,B   which worlds; all by default: bins, hi, acm, die, die-bumpy,
                   bowling, coin, track, bowl, dominoes, shard, shards, seesaw,
                   cradle, pendulum
    --draws N      draws per simulator and world, 2000 by default
    --seconds S    seconds of computing after which a simulator gets no further draws of a world, 12 by default
                   (three times that for worlds of many bodies)
    --presets A,B  which presets, all by default; without the reference, nothing is compared with it
    --rates A,B    the peer's steps a second, 60,240,1000 by default; multiples of 20
    --out FOLDER   where the files go, out/tradeoff by default
    --quick        60 draws and 1 second: shows that everything works, its numbers mean little";

struct Options {
    out: PathBuf,
    worlds: Vec<String>,
    plan: Plan,
}

/// The options; `None` if only the usage was asked for.
fn options() -> Result<Option<Options>> {
    let mut out = PathBuf::from("out/tradeoff");
    let mut chosen: Vec<String> = worlds::NAMES.map(str::to_owned).to_vec();
    let (mut draws, mut seconds, mut rates) = (2000, 12.0_f64, vec![60.0, 240.0, 1000.0]);
    let mut presets: Vec<String> = Preset::ALL.map(|p| p.name().to_owned()).to_vec();
    let mut arguments = std::env::args().skip(1);
    while let Some(argument) = arguments.next() {
        let mut value = || arguments.next().ok_or_else(|| format!("{argument} needs a value\n\n{USAGE}"));
        match argument.as_str() {
            "--help" | "-h" => return Ok(None),
            "--quick" => (draws, seconds) = (60, 1.0),
            "--out" => out = value()?.into(),
            "--draws" => draws = value()?.parse().map_err(|e| format!("--draws: {e}"))?,
            "--seconds" => seconds = value()?.parse().map_err(|e| format!("--seconds: {e}"))?,
            "--worlds" => chosen = value()?.split(',').map(str::to_owned).collect(),
            "--presets" => presets = value()?.split(',').map(str::to_owned).collect(),
            "--rates" => {
                rates = value()?
                    .split(',')
                    .map(|rate| rate.parse::<f64>().map_err(|e| format!("--rates: {rate}: {e}")))
                    .collect::<std::result::Result<_, _>>()?;
            }
            _ => return Err(format!("unknown option {argument}\n\n{USAGE}").into()),
        }
    }
    if let Some(rate) = rates.iter().find(|rate| !(**rate >= 20.0 && **rate % 20.0 == 0.0)) {
        return Err(format!("--rates: {rate} is no multiple of 20").into());
    }
    if draws == 0 || seconds.is_nan() || seconds <= 0.0 {
        return Err("--draws and --seconds must be more than 0".into());
    }
    if let Some(name) = chosen.iter().find(|name| !worlds::NAMES.contains(&name.as_str())) {
        return Err(format!("there is no world {name}; worlds: {}", worlds::NAMES.join(", ")).into());
    }
    if let Some(name) = presets.iter().find(|name| !Preset::ALL.iter().any(|p| p.name() == name.as_str())) {
        return Err(format!("there is no preset {name}: draft, standard, fine, reference").into());
    }
    let is_asked = |p: &Preset| presets.iter().any(|name| name == p.name());
    let presets = Preset::ALL.into_iter().rev().filter(is_asked).map(Way::Preset);
    let ways = presets.chain(rates.into_iter().map(Way::Peer)).collect();
    Ok(Some(Options { out, worlds: chosen, plan: Plan { draws, seconds, ways } }))
}

fn main() -> ExitCode {
    let done = match options() {
        Ok(None) => {
            eprintln!("{USAGE}");
            Ok(())
        }
        Ok(Some(options)) => trade(options),
        Err(error) => Err(error),
    };
    if let Err(error) = done {
        eprintln!("cargo xtask tradeoff: {error}");
        return ExitCode::FAILURE;
    }
    ExitCode::SUCCESS
}

/// Measures every world and writes the report.
fn trade(Options { out, worlds, plan }: Options) -> Result<()> {
    std::fs::create_dir_all(&out)?;
    let exact = exact::report(&plan.rates())?;
    let mut sections = String::new();
    let mut summaries = Vec::new();
    for name in &worlds {
        eprintln!("{name}");
        let mut world = worlds::world(name)?;
        let rows = measure(world.as_mut(), &plan)?;
        let distances = report::distances(&rows, &world.readings(), plan.finest());
        write!(sections, "\n## {}\n\n", world.title())?;
        sections += &report::section(world.as_ref(), &rows, &distances, plan.finest());
        plots::cost_and_distance(&out, world.as_ref(), &rows, &distances)?;
        plots::growth(&out, world.as_ref(), &rows)?;
        write!(sections, "\n![Cost and distance]({name}.png) ![Error over time]({name}-error.png)\n")?;
        summaries.push(report::summary(name, &rows, &plan.ways));
        // After each world, so that a reader who does not wait has the results so far.
        std::fs::write(out.join("report.md"), page(&plan, &summaries, &exact, &sections))?;
    }
    eprintln!("{}\nwrote {}", page(&plan, &summaries, &exact, &sections), out.join("report.md").display());
    Ok(())
}

/// The report as far as it has come.
fn page(plan: &Plan, summaries: &[Vec<String>], exact: &str, sections: &str) -> String {
    let mut text = format!(
        "# What exactness costs\n\nMade by `cargo xtask tradeoff`. Draws and outcomes follow from fixed seeds ({} draws at most, fewer where {} s of computing were over, three times that for worlds of many bodies). Times are seconds \
         of processor time of one thread, all simulators in one process by turns, so that a busy machine slows them \
         alike. The simulator computes in f64 throughout: event times are compared \
         across bodies, and an f32 holds 2 s to no better than 1e-7 s, in which a marble moves more than the fine preset's tolerances; there is no f32 variant to compare.\n",
        plan.draws, plan.seconds
    );
    text += "\n## In short\n\nMedian and mean ms of a draw.\n\n";
    let names: Vec<String> = plan.ways.iter().map(|way| way.name()).collect();
    let head: Vec<&str> = ["world"].into_iter().chain(names.iter().map(String::as_str)).collect();
    text += &table(&head, summaries.to_vec());
    text + "\n## Against exact answers\n\nRelative errors.\n\n" + exact + sections
}

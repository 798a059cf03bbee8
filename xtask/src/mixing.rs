//! How fast scenarios give independent solutions, beside plain draws of the prior: the tables of `docs/sampling.md`.

use crate::command::{Command, Failure, built, cargo, plaus, target};
use crate::steps::now;
use std::fs;
use std::path::Path;

/// A scenario with settings that make a run of half a minute or so.
type Row = (&'static str, &'static [&'static str]);

const MIXING: &[Row] = &[
    ("bowling-strike", &["warmup=300", "iterations=1000"]),
    ("bowling-leave-6-7", &["warmup=600", "iterations=1500"]),
    ("bowling-spare-6-7", &["warmup=2000", "iterations=20000"]),
    ("bowling-spare-7-10-paper", &["warmup=2000", "iterations=10000"]),
    ("dice-one", &["warmup=1000", "iterations=8000"]),
    ("dice-six-together", &["warmup=1000", "iterations=2000"]),
    ("spelling-hi", &["warmup=2000", "iterations=20000"]),
    ("spelling-acm", &["warmup=4000", "iterations=20000"]),
    ("ball2d", &["sigma_d=0.1", "warmup=2000", "iterations=200000"]),
];
const SEEDS: [&str; 2] = ["1", "2"];

/// Scenarios whose time to the first solution is measured, the process's start included.
const FIRST: &[&str] =
    &["bowling-strike", "dice-one", "spelling-hi", "spelling-acm", "dice-six-together", "bowling-leave-6-7"];
const FIRST_SEEDS: [&str; 3] = ["1", "2", "3"];

/// Prints both tables, of all rows or those whose scenario has `word` in its name.
pub(crate) fn run(arguments: &[&str]) -> Result<(), Failure> {
    let word = match arguments {
        [] => "",
        [word] => word,
        _ => return Err(Failure::new("usage: cargo xtask mixing [WORD]")),
    };
    cargo(&["build", "--release", "--package", "plaus-cli"]).run()?;
    let out = target().join("mixing");
    println!("independent solutions a minute of one processor; two chains, one thread");
    println!("scenario                    seed    chains     prior  ratio  largest R-hat  ESS/1000 it, of");
    for (scenario, settings) in MIXING.iter().filter(|(scenario, _)| scenario.contains(word)) {
        for seed in SEEDS {
            mixing(scenario, settings, seed, &out)?;
        }
    }
    println!("\nseconds to the first solution, one thread");
    for scenario in FIRST.iter().filter(|scenario| scenario.contains(word)) {
        let times = FIRST_SEEDS.iter().map(|seed| first(scenario, seed, &out)).collect::<Result<Vec<_>, _>>()?;
        println!("{scenario:26}  {}", times.join("  "));
    }
    Ok(())
}

/// Samples one row, and prints its line.
fn mixing(scenario: &str, settings: &[&str], seed: &str, out: &Path) -> Result<(), Failure> {
    let folder = anew(out)?;
    let (_, printed) =
        sample(scenario, seed, &folder, &["--json", "--compare-prior", "--set", "chains=2", "--set", "thin=1"])
            .args(settings.iter().flat_map(|setting| ["--set", setting]))
            .output()?;
    let printed = String::from_utf8_lossy(&printed).into_owned();
    let compared = printed.lines().find(|line| line.contains("\"compare_prior\""));
    let [chains, prior] = ["chains", "prior"].map(|key| compared.and_then(|line| numbers(line, key).next()));
    let (_, diagnosed) = plaus(&["diagnose", &folder, "--json"]).output()?;
    let diagnosed = String::from_utf8_lossy(&diagnosed).into_owned();
    // Variables of the draw come first, in this list and among the scalars.
    let of_draw = diagnosed.split("\"role\":\"draw\"").skip(1);
    let rows = of_draw.filter_map(|row| Some((numbers(row, "rhat").next()?, numbers(row, "ess_per_1000").next()?)));
    let (rhats, ess): (Vec<f64>, Vec<f64>) = rows.unzip();
    let shown = |number: Option<f64>| number.map_or_else(|| "-".to_owned(), |number| format!("{number:.0}"));
    let ratio = chains.zip(prior).filter(|(_, prior)| *prior > 0.0);
    println!(
        "{scenario:26}  {seed:>4}  {:>8}  {:>8}  {:>5}  {:>13.3}  {:>11.2}",
        shown(chains),
        shown(prior),
        ratio.map_or_else(|| "-".to_owned(), |(chains, prior)| format!("{:.1}", chains / prior)),
        rhats.into_iter().fold(0.0, f64::max),
        ess.into_iter().fold(f64::INFINITY, f64::min),
    );
    Ok(())
}

/// Seconds until a run has its first solution, the process's start included.
fn first(scenario: &str, seed: &str, out: &Path) -> Result<String, Failure> {
    let folder = anew(out)?;
    let begun = now();
    let (code, _) = sample(scenario, seed, &folder, &["--quiet", "--solutions", "1"]).output()?;
    let seconds = begun.elapsed().as_secs_f64();
    Ok(if code == 0 { format!("{seconds:.2}") } else { "none".to_owned() })
}

fn sample(scenario: &str, seed: &str, folder: &str, more: &[&str]) -> Command {
    let file = format!("scenarios/{scenario}.toml");
    Command::new(built("release", "plaus"))
        .args(["sample", &file, "--threads", "1", "--seed", seed, "--out", folder])
        .args(more)
}

/// A folder for a run, which does not exist yet.
fn anew(out: &Path) -> Result<String, Failure> {
    if out.exists() {
        fs::remove_dir_all(out).map_err(Failure::new)?;
    }
    Ok(out.to_string_lossy().into_owned())
}

/// The numbers that follow a key in JSON, in order.
fn numbers<'a>(json: &'a str, key: &str) -> impl Iterator<Item = f64> + use<'a> {
    let key = format!("\"{key}\":");
    let places: Vec<usize> = json.match_indices(&key).map(|(place, _)| place + key.len()).collect();
    places.into_iter().filter_map(move |place| {
        let end = json[place..].find([',', '}', ']'])?;
        json[place..place + end].trim().parse().ok()
    })
}

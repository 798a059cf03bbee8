//! How fast scenarios give independent solutions, beside plain draws of the prior: the tables of
//! `docs/validation/mixing.md`.

use crate::command::{Command, Failure, built, cargo, plaus, root, target};
use crate::steps::now;
use std::fs;
use std::path::Path;
use std::time::{Duration, Instant};

/// A scenario with settings that make a run of at most a minute or so of processor time.
type Row = (&'static str, &'static [&'static str]);

const MIXING: &[Row] = &[
    ("bowling-strike", &["warmup=500", "iterations=2500"]),
    ("bowling-leave-6-7", &["warmup=4000", "iterations=4000"]),
    ("bowling-spare-6-7", &["warmup=20000", "iterations=20000"]),
    ("bowling-spare-7-10-paper", &["warmup=2000", "iterations=10000"]),
    ("dice-one", &["warmup=1000", "iterations=8000"]),
    ("dice-six-together", &["warmup=1000", "iterations=2000"]),
    ("spelling-hi", &["warmup=2000", "iterations=20000"]),
    ("spelling-acm", &["warmup=4000", "iterations=20000"]),
    ("ball2d", &["sigma_d=0.1", "warmup=2000", "iterations=200000"]),
];

/// Scenarios whose time to the first solution is measured, the process's start included.
const FIRST: &[&str] =
    &["bowling-strike", "dice-one", "spelling-hi", "spelling-acm", "dice-six-together", "bowling-leave-6-7"];
const FIRST_SEEDS: [&str; 3] = ["1", "2", "3"];
/// Longest time for a first solution.
const FIRST_WITHIN: &str = "60s";

/// No row is begun later than this.
const LONGEST: Duration = Duration::from_secs(30 * 60);

/// Prints both tables, of all rows or those whose scenario has `word` in its name, as they are in the documents.
pub(crate) fn run(arguments: &[&str]) -> Result<(), Failure> {
    let (word, seeds) = match arguments {
        [] => ("", &["1"][..]),
        [word] => (*word, &["1"][..]),
        [word, seeds @ ..] => (*word, seeds),
    };
    cargo(&["build", "--release", "--package", "plaus-cli"]).run()?;
    let (out, begun) = (target().join("mixing"), now());
    let mut left: Vec<String> = Vec::new();
    println!("| scenario, seed | chains | prior | ratio | effective draws a second | largest R-hat |");
    println!("| --- | --- | --- | --- | --- | --- |");
    for (scenario, settings) in MIXING.iter().filter(|(scenario, _)| scenario.contains(word)) {
        for seed in seeds {
            if !is_late(begun, &mut left, &format!("{scenario}, {seed}")) {
                println!("| `{scenario}`, {seed} | {} |", mixing(scenario, settings, seed, &out)?.join(" | "));
            }
        }
    }
    println!("\n| first solution | {} |", FIRST_SEEDS.map(|seed| format!("seed {seed}")).join(" | "));
    println!("| --- |{}", " --- |".repeat(FIRST_SEEDS.len()));
    for scenario in FIRST.iter().filter(|scenario| scenario.contains(word)) {
        if !is_late(begun, &mut left, &format!("the first solution of {scenario}")) {
            let times = FIRST_SEEDS.iter().map(|seed| first(scenario, seed, &out)).collect::<Result<Vec<_>, _>>()?;
            println!("| `{scenario}` | {} |", times.join(" | "));
        }
    }
    left.iter().for_each(|row| eprintln!("not measured, because {} minutes are over: {row}", LONGEST.as_secs() / 60));
    Ok(())
}

/// Whether a row comes too late; if it does, it is noted, and otherwise announced.
fn is_late(begun: Instant, left: &mut Vec<String>, row: &str) -> bool {
    let is_late = begun.elapsed() > LONGEST;
    if is_late {
        left.push(row.to_owned());
    } else {
        eprintln!("after {:.0} s: {row}", begun.elapsed().as_secs_f64());
    }
    is_late
}

/// Samples a row, and returns its cells: independent solutions a minute of one processor by two chains and by the
/// prior, their ratio, effective draws a second and R-hat of the draw's worst variables.
fn mixing(scenario: &str, settings: &[&str], seed: &str, out: &Path) -> Result<[String; 5], Failure> {
    let folder = anew(out)?;
    let always = ["chains=2", "thin=1", "method=chain"];
    let settings = always.iter().chain(settings).flat_map(|setting| ["--set", setting]);
    let (_, printed) = sample(scenario, seed, &folder, &["--json", "--compare-prior"]).args(settings).output()?;
    let printed = String::from_utf8_lossy(&printed).into_owned();
    let compared = printed.lines().find(|line| line.contains("\"compare_prior\""));
    let of = |key| compared.and_then(|line| numbers(line, key).next());
    let ([chains, prior], seconds) = (["chains", "prior"].map(of), of("processor_seconds"));
    let (_, diagnosed) = plaus(&["diagnose", &folder, "--json"]).output()?;
    let diagnosed = String::from_utf8_lossy(&diagnosed).into_owned();
    // Variables of the draw come first, in this list and among the scalars.
    let of_draw = diagnosed.split("\"role\":\"draw\"").skip(1);
    let rows = of_draw.filter_map(|row| Some((numbers(row, "rhat").next()?, numbers(row, "ess_bulk").next()?)));
    let (rhats, ess): (Vec<f64>, Vec<f64>) = rows.unzip();
    let (rhat, ess) = (rhats.into_iter().fold(0.0, f64::max), ess.into_iter().fold(f64::INFINITY, f64::min));
    let shown = |number: Option<f64>, digits: usize| {
        number.map_or_else(|| "–".to_owned(), |number| format!("{number:.digits$}"))
    };
    let ratio = chains.zip(prior.filter(|&prior| prior > 0.0)).map(|(chains, prior)| chains / prior);
    let a_second = seconds.filter(|_| ess.is_finite()).map(|seconds| ess / seconds);
    Ok([shown(chains, 0), shown(prior, 1), shown(ratio, 2), shown(a_second, 1), format!("{rhat:.3}")])
}

/// Seconds of processor time until a run has its first solution, the process's start included; of the clock where the
/// system does not tell.
fn first(scenario: &str, seed: &str, out: &Path) -> Result<String, Failure> {
    let folder = anew(out)?;
    let (begun, before) = (now(), processor_seconds());
    let wanted = ["--quiet", "--solutions", "1", "--max-time", FIRST_WITHIN];
    let (code, _) = sample(scenario, seed, &folder, &wanted).output()?;
    let seconds = before.zip(processor_seconds()).map(|(before, after)| after - before);
    let seconds = seconds.unwrap_or_else(|| begun.elapsed().as_secs_f64());
    Ok(if code == 0 { format!("{seconds:.2} s") } else { format!("none in {FIRST_WITHIN}") })
}

/// Processor time of all finished child processes, in seconds; only Linux tells.
pub(crate) fn processor_seconds() -> Option<f64> {
    let stat = fs::read_to_string("/proc/self/stat").ok()?;
    // The program's name, in brackets, may contain blanks. cutime and cstime are the 14th and 15th numbers after it, in
    // hundredths of a second on every system that Rust supports.
    let after = stat.rsplit(')').next()?;
    let ticks = after.split_whitespace().skip(13).take(2).map(str::parse::<f64>);
    Some(ticks.sum::<Result<f64, _>>().ok()? / 100.0)
}

fn sample(scenario: &str, seed: &str, folder: &str, more: &[&str]) -> Command {
    let file = root().join("scenarios").join(scenario).with_extension("toml");
    Command::new(built("release", "plaus"))
        .args(["sample", &file.to_string_lossy(), "--threads", "1", "--seed", seed, "--out", folder])
        .args(more)
}

/// A folder for a run, which does not exist yet.
pub(crate) fn anew(out: &Path) -> Result<String, Failure> {
    if out.exists() {
        fs::remove_dir_all(out).map_err(Failure::new)?;
    }
    Ok(out.to_string_lossy().into_owned())
}

/// The numbers that follow a key in JSON, in order.
pub(crate) fn numbers<'a>(json: &'a str, key: &str) -> impl Iterator<Item = f64> + use<'a> {
    let key = format!("\"{key}\":");
    let places: Vec<usize> = json.match_indices(&key).map(|(place, _)| place + key.len()).collect();
    places.into_iter().filter_map(move |place| {
        let end = json[place..].find([',', '}', ']'])?;
        json[place..place + end].trim().parse().ok()
    })
}

//! How fast scenarios give independent solutions, beside plain draws of the prior: the tables of
//! `docs/validation/mixing.md`.

use crate::command::{Command, Failure, built, plaus, root, target};
use crate::documented::files;
use crate::steps::{self, now};
use std::fs;
use std::path::{Path, PathBuf};
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

/// Settings of a run that says by which method it samples.
const METHODS: [(&str, &[&str]); 4] = [
    ("auto", &[]),
    ("chain", &["--set", "method=chain"]),
    ("chain, moves that learn", &["--set", "method=chain", "--set", "adapt=true", "--set", "adapt_weights=true"]),
    ("independent", &["--set", "method=independent"]),
];
/// Number of clearly different solutions, and for how long they are waited for.
const DIFFERENT: &str = "12";
const DIFFERENT_WITHIN: &str = "20s";

/// Prints all tables, of all rows or those whose scenario has `word` in its name.
pub(crate) fn run(arguments: &[&str]) -> Result<(), Failure> {
    let (word, seeds) = match arguments {
        [] => ("", &["1"][..]),
        [word] => (*word, &["1"][..]),
        [word, seeds @ ..] => (*word, seeds),
    };
    println!("{}\n\n{}\n\n{}", independent(word, seeds)?, firsts(word)?, different(word)?);
    Ok(())
}

/// A table that says on standard error which row it is at, and which it leaves out because the time is over.
struct Timed {
    begun: Instant,
    table: String,
    left: Vec<String>,
}

impl Timed {
    fn new(head: &[&str]) -> Result<Self, Failure> {
        steps::release().run()?;
        let table = format!("| {} |\n|{}", head.join(" | "), " --- |".repeat(head.len()));
        Ok(Self { begun: now(), table, left: Vec::new() })
    }

    fn add(&mut self, name: &str, cells: impl FnOnce() -> Result<Vec<String>, Failure>) -> Result<(), Failure> {
        let seconds = self.begun.elapsed();
        if seconds > LONGEST {
            self.left.push(name.to_owned());
            return Ok(());
        }
        eprintln!("after {:.0} s: {name}", seconds.as_secs_f64());
        self.table += &format!("\n| {name} | {} |", cells()?.join(" | "));
        Ok(())
    }

    fn end(self) -> String {
        let minutes = LONGEST.as_secs() / 60;
        self.left.iter().for_each(|row| eprintln!("not measured, because {minutes} minutes are over: {row}"));
        self.table
    }
}

/// Independent solutions a minute, beside draws of the prior.
pub(crate) fn independent(word: &str, seeds: &[&str]) -> Result<String, Failure> {
    let head = ["scenario, seed", "chains", "prior", "ratio", "effective draws a second", "largest R-hat"];
    let (mut table, out) = (Timed::new(&head)?, target().join("mixing"));
    for (scenario, settings) in MIXING.iter().filter(|(scenario, _)| scenario.contains(word)) {
        for seed in seeds {
            table.add(&format!("`{scenario}`, {seed}"), || Ok(mixing(scenario, settings, seed, &out)?.into()))?;
        }
    }
    Ok(table.end())
}

/// Processor time to the first solution.
pub(crate) fn firsts(word: &str) -> Result<String, Failure> {
    let seeds = FIRST_SEEDS.map(|seed| format!("seed {seed}"));
    let head: Vec<&str> = ["first solution"].into_iter().chain(seeds.iter().map(String::as_str)).collect();
    let (mut table, out) = (Timed::new(&head)?, target().join("mixing"));
    let seconds = |scenario: &str, seed: &str| {
        let found = until(&in_scenarios(scenario), seed, "1", FIRST_WITHIN, &[], &out)?;
        Ok(found.map_or_else(|| format!("none in {FIRST_WITHIN}"), |seconds| format!("{seconds:.2} s")))
    };
    for scenario in FIRST.iter().filter(|scenario| scenario.contains(word)) {
        table.add(&format!("`{scenario}`"), || FIRST_SEEDS.iter().map(|seed| seconds(scenario, seed)).collect())?;
    }
    Ok(table.end())
}

/// Processor time from the command to a dozen clearly different solutions, by each method, of every shipped world.
pub(crate) fn different(word: &str) -> Result<String, Failure> {
    let head: Vec<&str> = ["world"].into_iter().chain(METHODS.iter().map(|(name, _)| *name)).collect();
    let (mut table, out) = (Timed::new(&head)?, target().join("mixing"));
    for file in files("scenarios/worlds", ".toml")? {
        let name = file.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        if name.contains(word) {
            let seconds = |(_, settings): &(&str, &[&str])| {
                let found = until(&file, "1", DIFFERENT, DIFFERENT_WITHIN, settings, &out)?;
                Ok(found.map_or_else(|| "–".to_owned(), |seconds| format!("{seconds:.2} s")))
            };
            table.add(&format!("`{name}`"), || METHODS.iter().map(seconds).collect())?;
        }
    }
    Ok(table.end())
}

/// Samples a row, and returns its cells: independent solutions a minute of one processor by two chains and by the
/// prior, their ratio, effective draws a second and R-hat of the draw's worst variables.
fn mixing(scenario: &str, settings: &[&str], seed: &str, out: &Path) -> Result<[String; 5], Failure> {
    let folder = anew(out)?;
    let always = ["chains=2", "thin=1", "method=chain"];
    let settings = always.iter().chain(settings).flat_map(|setting| ["--set", setting]);
    let (_, printed) =
        sample(&in_scenarios(scenario), seed, &folder, &["--json", "--compare-prior"]).args(settings).output()?;
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

/// Seconds of processor time until a run has as many solutions as are wanted, the process's start included (by the
/// clock where the system does not tell); `None` if the time is over before.
fn until(
    file: &Path,
    seed: &str,
    wanted: &str,
    within: &str,
    settings: &[&str],
    out: &Path,
) -> Result<Option<f64>, Failure> {
    let folder = anew(out)?;
    let (begun, before) = (now(), processor_seconds());
    let words = ["--quiet", "--solutions", wanted, "--max-time", within];
    let (code, _) = sample(file, seed, &folder, &words).args(settings).output()?;
    let seconds = before.zip(processor_seconds()).map(|(before, after)| after - before);
    let seconds = seconds.unwrap_or_else(|| begun.elapsed().as_secs_f64());
    match code {
        0 => Ok(Some(seconds)),
        1 => Ok(None),
        _ => Err(Failure(format!("sampling {} failed with exit code {code}", file.display()))),
    }
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

fn in_scenarios(name: &str) -> PathBuf {
    root().join("scenarios").join(name).with_extension("toml")
}

fn sample(file: &Path, seed: &str, folder: &str, more: &[&str]) -> Command {
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

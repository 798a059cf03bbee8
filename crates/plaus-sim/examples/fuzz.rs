//! Random worlds under laws that hold for all of them (`tests/common/fuzz`), for some time, over fresh seeds.
//!
//! `cargo run --release -p plaus-sim --example fuzz -- [--minutes N] [--seed S] [--seeds N] [--preset P] [--law L]
//! [--out FOLDER]`
//!
//! Without arguments, it examines four worlds for one law.
//!
//! It prints law, seed, preset and what was found of each world that breaks a law, and writes the scenario that repeats
//! it into the folder. Its exit code is 1 then.
#![allow(clippy::print_stdout, clippy::disallowed_methods, reason = "a program for the terminal, which keeps time")]

#[path = "../tests/common/fuzz/mod.rs"]
mod fuzz;
#[path = "../tests/common/laws/mod.rs"]
mod laws;

use fuzz::{Law, Verdict};
use plaus_sim::Preset;
use std::error::Error;
use std::io::Write;
use std::path::PathBuf;
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::{Duration, Instant};

/// Seconds after which a world counts as without an end.
const PATIENCE: u64 = 20;

struct Options {
    minutes: f64,
    seed: u64,
    seeds: u64,
    preset: Option<Preset>,
    law: Option<Law>,
    out: PathBuf,
    /// Worlds that broke a law before this program started itself anew.
    broken: u64,
}

fn options() -> Result<Options, Box<dyn Error>> {
    let mut options = Options {
        minutes: 1.0,
        seed: 0,
        seeds: u64::MAX,
        preset: None,
        law: None,
        out: PathBuf::from("out/fuzz-worlds"),
        broken: 0,
    };
    let words: Vec<String> = std::env::args().skip(1).collect();
    if words.is_empty() {
        (options.seeds, options.law, options.preset) = (4, Some(Law::Energy), Some(Preset::Draft));
    }
    for pair in words.chunks(2) {
        let [key, value] = pair else { return Err(format!("{} needs a value", pair[0]).into()) };
        match key.as_str() {
            "--minutes" => options.minutes = value.parse()?,
            "--seed" => options.seed = value.parse()?,
            "--seeds" => options.seeds = value.parse()?,
            "--preset" => {
                options.preset = Some(laws::record::preset(value).ok_or("draft, standard, fine or reference")?);
            }
            "--law" => {
                let names = || Law::ALL.map(Law::name).join(", ");
                options.law = Some(Law::named(value).ok_or_else(names)?);
            }
            "--broken" => options.broken = value.parse()?,
            "--out" => options.out = PathBuf::from(value),
            _ => return Err(format!("{key}: not an option").into()),
        }
    }
    Ok(options)
}

/// Writes the scenario of a world that breaks a law; returns where.
fn write(
    out: &PathBuf,
    law: Law,
    seed: u64,
    preset: Preset,
    verdict: Option<&Verdict>,
) -> Result<PathBuf, Box<dyn Error>> {
    std::fs::create_dir_all(out)?;
    let stem = format!("{}-{seed}-{}", law.name(), preset.name());
    let world = verdict.map_or_else(|| law.world(seed, preset), |v| v.world.clone());
    let found = verdict.map_or("no end", |v| &v.found);
    let scenario = fuzz::scenario::scenario(&world, &format!("{} {seed}: {found}", law.name()), &stem);
    for (name, text) in scenario.files {
        std::fs::write(out.join(name), text)?;
    }
    let path = out.join(stem).with_extension("toml");
    std::fs::write(&path, scenario.text)?;
    Ok(path)
}

fn main() -> Result<(), Box<dyn Error>> {
    let options = options()?;
    let end = Instant::now() + Duration::from_secs_f64(60.0 * options.minutes);
    let mut broken = options.broken;
    let mut tally: Tally = Law::ALL.map(|law| (law, 0, 0, [0; 2]));
    let presets: Vec<Preset> = Preset::ALL.into_iter().filter(|p| options.preset.is_none_or(|o| o == *p)).collect();
    let mut said = Instant::now();
    'seeds: for seed in options.seed..options.seed.saturating_add(options.seeds) {
        for k in 0..tally.len() {
            let law = tally[k].0;
            if options.law.is_some_and(|l| l != law) {
                continue;
            }
            // One preset a seed, in turn: the coarser ones cost less, and come up as often.
            let preset = presets[(seed % presets.len() as u64) as usize];
            if Instant::now() > end {
                break 'seeds;
            }
            let (tell, told) = channel();
            // A world that never comes back is left on its thread.
            std::thread::Builder::new().stack_size(16 << 20).spawn(move || {
                let verdict = std::panic::catch_unwind(|| law.examine(seed, preset));
                let _ = tell.send(verdict);
            })?;
            let (verdict, fault) = match told.recv_timeout(Duration::from_secs(PATIENCE)) {
                Ok(Ok(verdict)) => (verdict, None),
                Ok(Err(_)) => (None, Some("panicked".to_owned())),
                Err(RecvTimeoutError::Timeout) => (None, Some(format!("no end in {PATIENCE} s"))),
                Err(RecvTimeoutError::Disconnected) => (None, Some("its thread died".to_owned())),
            };
            let is_endless = fault.as_ref().is_some_and(|f| f.starts_with("no end"));
            let fault = fault.or_else(|| verdict.as_ref().filter(|v| v.is_breach()).map(|v| v.found.clone()));
            if verdict.is_none() && fault.is_none() {
                continue;
            }
            tally[k].1 += 1;
            if let Some(caught) = verdict.as_ref().and_then(|v| v.twin) {
                tally[k].3[0] += 1;
                tally[k].3[1] += u64::from(caught);
            }
            if let Some(fault) = fault {
                (tally[k].2, broken) = (tally[k].2 + 1, broken + 1);
                let path = write(&options.out, law, seed, preset, verdict.as_ref())?;
                println!("\r{} seed {seed} {}: {fault}\n  {}", law.name(), preset.name(), path.display());
                if is_endless {
                    table(&tally);
                    return again(&options, seed + 1, broken, end);
                }
            }
        }
        if said.elapsed() > Duration::from_secs(2) {
            said = Instant::now();
            print!("\rseed {seed}, {broken} worlds break a law");
            std::io::stdout().flush()?;
        }
    }
    println!();
    table(&tally);
    std::process::exit(i32::from(broken > 0));
}

type Tally = [(Law, u64, u64, [u64; 2]); Law::ALL.len()];

fn table(tally: &Tally) {
    println!("{:<10} {:>8} {:>8} {:>14}", "law", "worlds", "broken", "twins refused");
    for (law, worlds, faults, twins) in tally.iter().filter(|t| t.1 > 0) {
        println!("{:<10} {worlds:>8} {faults:>8} {:>7} of {:>4}", law.name(), twins[1], twins[0]);
    }
}

/// Starts this program anew from a seed on: a thread that never comes back cannot be ended.
fn again(options: &Options, seed: u64, broken: u64, end: Instant) -> Result<(), Box<dyn Error>> {
    let left = end.saturating_duration_since(Instant::now()).as_secs_f64() / 60.0;
    let seeds = options.seeds.saturating_sub(seed - options.seed);
    let mut next = std::process::Command::new(std::env::current_exe()?);
    for (key, value) in [
        ("--minutes", left.to_string()),
        ("--seed", seed.to_string()),
        ("--seeds", seeds.to_string()),
        ("--broken", broken.to_string()),
    ] {
        next.args([key, &value]);
    }
    next.arg("--out").arg(&options.out);
    if let Some(preset) = options.preset {
        next.args(["--preset", preset.name()]);
    }
    if let Some(law) = options.law {
        next.args(["--law", law.name()]);
    }
    replace(next)
}

/// Puts a program in the place of this one, with its threads.
#[cfg(unix)]
fn replace(mut next: std::process::Command) -> Result<(), Box<dyn Error>> {
    use std::os::unix::process::CommandExt;
    Err(next.exec().into())
}

#[cfg(not(unix))]
fn replace(mut next: std::process::Command) -> Result<(), Box<dyn Error>> {
    std::process::exit(next.status()?.code().unwrap_or(1))
}

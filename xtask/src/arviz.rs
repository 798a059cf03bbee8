//! The ArviZ read-back: an exported run, read by another program.

use crate::command::{Command, Failure, plaus, target};
use crate::registry;
use crate::steps::Done;
use std::fs;
use std::path::Path;

/// A run small enough to read back in seconds, long enough that its diagnostics are numbers.
const SAMPLE: [&str; 12] = [
    "--seed",
    "1",
    "--chains",
    "4",
    "--iterations",
    "5000",
    "--threads",
    "2",
    "--set",
    "sampler.warmup=1000",
    "--set",
    "sampler.thin=1",
];

pub(crate) fn run() -> Result<Done, Failure> {
    let folder = target().join("arviz");
    if folder.exists() {
        fs::remove_dir_all(&folder).map_err(Failure::new)?;
    }
    fs::create_dir_all(&folder).map_err(Failure::new)?;
    let [run, zarr, csv, json] = ["run", "run.zarr", "run.csv", "diagnose.json"].map(|name| folder.join(name));
    plaus(&["sample", "scenarios/ball2d.toml", "--out"]).args([&run]).args(SAMPLE).shown_and_run()?;
    for (format, out) in [("zarr", &zarr), ("csv", &csv)] {
        plaus(&["export"]).args([&run]).args(["--format", format, "--out"]).args([out]).shown_and_run()?;
    }
    diagnose(&run, &json)?;
    let script =
        Command::new("python3").args(["xtask/python/check_arviz.py", "--venv"]).args([target().join("arviz-venv")]);
    let script = script.args(["--zarr"]).args([&zarr]).args(["--csv"]).args([&csv]).args(["--diagnose"]).args([&json]);
    println!("$ {}", script.shown());
    registry::outcome(script.status()?, "ArviZ does not read what plaus wrote")
}

/// `plaus diagnose --json`, which exits with 1 if it finds the run too short; here only the numbers matter.
fn diagnose(run: &Path, json: &Path) -> Result<(), Failure> {
    let command = plaus(&["diagnose"]).args([run]).args(["--json"]);
    println!("$ {}", command.shown());
    let (code, out) = command.output()?;
    if code > 1 {
        return Err(Failure(format!("plaus diagnose failed with exit code {code}")));
    }
    fs::write(json, out).map_err(Failure::new)
}

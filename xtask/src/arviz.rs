//! The ArviZ read-back: a run, exported, as another program reads it.

use crate::command::{Command, Failure, cargo, target};
use crate::steps::Done;
use std::fs;
use std::path::Path;

/// The script's exit code where it could not install what it needs.
const NO_REGISTRY: i32 = 77;

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
    match script.status()? {
        0 => Ok(Done::Passed),
        NO_REGISTRY if std::env::var_os("CI").is_none_or(|ci| ci != "true") => Ok(Done::Skipped(
            "the Python packages it needs cannot be installed here; with CI=true this fails".to_owned(),
        )),
        NO_REGISTRY => {
            Err(Failure::new("the Python packages it needs cannot be installed, and CI=true says they must be"))
        }
        code => Err(Failure(format!("ArviZ does not read what plaus wrote (exit code {code})"))),
    }
}

/// The release binary that a step before has built.
fn plaus(arguments: &[&str]) -> Command {
    cargo(&["run", "--quiet", "--release", "--package", "plaus-cli", "--"]).args(arguments)
}

/// `plaus diagnose --json`, which exits with 1 where it finds the run too short: here only the numbers matter.
fn diagnose(run: &Path, json: &Path) -> Result<(), Failure> {
    let command = plaus(&["diagnose"]).args([run]).args(["--json"]);
    println!("$ {}", command.shown());
    let (code, out) = command.output()?;
    if code > 1 {
        return Err(Failure(format!("plaus diagnose failed with exit code {code}")));
    }
    fs::write(json, out).map_err(Failure::new)
}

impl Command {
    fn shown_and_run(self) -> Result<(), Failure> {
        println!("$ {}", self.shown());
        self.run()
    }
}

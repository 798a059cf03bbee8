//! Pieces of runs on real engines: HyperQueue and OpenJD from PyPI, and Slurm if it is installed.

use crate::command::{Command, Failure, built, root, target};
use crate::registry;
use crate::steps::{self, Done, Step};

const SCENARIO: &str = "scenarios/ball2d.toml";
/// Seconds that the runs take whose speeds are compared.
const SPEED: &str = "60";
/// Number of pieces in the merges that are measured.
const PIECES: [&str; 3] = ["100", "1000", "10000"];

/// The part that needs only PyPI, and takes less than a minute.
pub(crate) fn quick() -> Result<Done, Failure> {
    check(&["--quick", "hyperqueue", "openjd"])
}

/// Everything, including measurements of cost.
pub(crate) fn run() -> Result<(), Failure> {
    let all = || check(&["--speed", SPEED, "hyperqueue", "openjd", "slurm"]);
    steps::run(vec![
        steps::released(),
        Step::new("pieces on every engine", all),
        Step::new("many pieces merged", merges),
    ])
}

fn check(more: &[&str]) -> Result<Done, Failure> {
    let script = Command::new("python3").args(["xtask/python/check_engines.py"]);
    let script = script.args(["--venv"]).args([target().join("engines-venv")]);
    let script = script.args(["--work"]).args([target().join("engines")]);
    let script = script.args(["--plaus"]).args([built("release", "plaus")]);
    let script = script.args(["--scenario"]).args([root().join(SCENARIO)]).args(more);
    println!("$ {}", script.shown());
    registry::outcome(script.status()?, "pieces on an engine are not what one machine makes")
}

fn merges() -> Result<Done, Failure> {
    for pieces in PIECES {
        let script = Command::new("python3").args(["xtask/python/measure_merge.py", "--pieces", pieces]);
        let script = script.args(["--work"]).args([target().join("engines")]);
        let script = script.args(["--plaus"]).args([built("release", "plaus")]);
        script.args(["--scenario"]).args([root().join(SCENARIO)]).shown_and_run()?;
    }
    Ok(Done::Passed)
}

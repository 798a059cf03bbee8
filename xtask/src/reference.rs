//! The pages of reference in `docs/reference`, made from the command itself: its schema, and its help.

use crate::command::{Command, Failure, built, root};
use crate::steps::{self, Step};

/// `cargo xtask reference`.
pub(crate) fn write() -> Result<(), Failure> {
    steps::run(vec![steps::released(), Step::command("pages of reference", script())])
}

/// That the pages are what the release binary, which an earlier step has built, says.
pub(crate) fn checked() -> Step {
    Step::command("pages of reference", script().args(["--check"]))
}

fn script() -> Command {
    let folder = root().join("docs/reference");
    Command::new("python3").args(["xtask/python/reference.py"]).args([built("release", "plaus"), folder])
}

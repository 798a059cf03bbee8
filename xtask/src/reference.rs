//! The schema of scenario files, made from their types, and the pages of reference in `docs/reference`, made from the
//! command itself: its schema, and its help.

use crate::command::{Command, Failure, built, cargo, root};
use crate::steps::{self, Done, Step};

/// `cargo xtask reference`.
pub(crate) fn write() -> Result<(), Failure> {
    let schema = Step::new("the schema of scenario files", schema);
    steps::run(vec![schema, steps::released(), Step::command("pages of reference", script())])
}

/// That the pages are what the release binary, which an earlier step has built, says.
pub(crate) fn checked() -> Step {
    Step::command("pages of reference", script().args(["--check"]))
}

fn schema() -> Result<Done, Failure> {
    let example = ["run", "--quiet", "--package", "plaus-scenes", "--example", "schema"];
    let (code, made) = cargo(&example).output()?;
    if code != 0 {
        return Err(Failure("the types make no schema".to_owned()));
    }
    std::fs::write(root().join("crates/plaus-scenes/schema.json"), made).map_err(Failure::new)?;
    Ok(Done::Passed)
}

fn script() -> Command {
    let folder = root().join("docs/reference");
    Command::new("python3").args(["xtask/python/reference.py"]).args([built("release", "plaus"), folder])
}

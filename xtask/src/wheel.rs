//! The Python package: built as a wheel, and tested as users install it.

use crate::command::{Command, Failure, cargo, target};
use crate::registry;
use crate::steps::{self, Done, Step};

const WRONG: &str = "the wheel does not do what it should";

const USAGE: &str = "cargo xtask wheel [--check | --measure | --licences | --portable [TRIPLE]]";

/// `cargo xtask wheel [--check | --measure | --licences | --portable [TRIPLE]]`.
pub(crate) fn run(arguments: &[&str]) -> Result<(), Failure> {
    match arguments {
        [] => steps::run(vec![built()]),
        ["--check"] => steps::run(vec![steps::released(), licences(), built(), all_pythons()]),
        ["--measure"] => steps::run(vec![steps::released(), examples(), built(), Step::new("tried", check), measure()]),
        ["--licences"] => script("write-licences").shown_and_run(),
        // That of another platform cannot be tried here.
        ["--portable"] => steps::run(vec![portable(&format!("{}-unknown-linux-gnu", std::env::consts::ARCH)), tests()]),
        ["--portable", triple] if !triple.starts_with('-') => steps::run(vec![portable(triple)]),
        _ => Err(Failure(USAGE.to_owned())),
    }
}

/// The check that needs only the code.
pub(crate) fn licences() -> Step {
    Step::new("licences in the wheel", check_licences)
}

/// A wheel from what the tests have built, tested with its notebooks on the installed Python. A wheel to distribute
/// takes many minutes more, and is left to `cargo xtask wheel --check`.
pub(crate) fn tried() -> Step {
    let profile = |what| script(what).args(["--profile", "dev"]);
    Step::new("the Python package and its notebooks", move || {
        match outcome(profile("build"), "the wheel cannot be built")? {
            Done::Passed => outcome(profile("check"), WRONG),
            skipped => Ok(skipped),
        }
    })
}

/// The wheel to distribute.
pub(crate) fn built() -> Step {
    Step::new("the wheel", || outcome(script("build"), "the wheel cannot be built"))
}

/// The wheel to distribute for a platform; for Linux, one that also works on old systems.
fn portable(triple: &str) -> Step {
    let script = script("build").args(["--platform", triple]);
    Step::new("the wheel", move || outcome(script, "the wheel cannot be built"))
}

/// That it works, in an environment without Rust.
fn tests() -> Step {
    Step::new("the wheel where there is no Rust", || outcome(script("check").args(["--no-notebooks"]), WRONG))
}

/// The wheel that only tests use, not optimised.
pub(crate) fn quickly_built() -> Step {
    Step::new("a wheel for tests", || outcome(script("build").args(["--profile", "dev"]), "the wheel cannot be built"))
}

fn script(what: &str) -> Command {
    Command::new("python3").args(["xtask/python/wheel.py", what, "--target"]).args([target()])
}

fn examples() -> Step {
    let words = [
        "build",
        "--release",
        "--package",
        "plaus-scenes",
        "--package",
        "plaus-sim",
        "--example",
        "spelling_drops",
        "--example",
        "die",
    ];
    Step::command("what the simulator is compared with", cargo(&words))
}

fn check_licences() -> Result<Done, Failure> {
    outcome(script("licences"), "licences are missing in the wheel")
}

fn check() -> Result<Done, Failure> {
    outcome(script("check"), WRONG)
}

fn all_pythons() -> Step {
    let all = || outcome(script("check").args(["--all"]), WRONG);
    Step::new("the wheel on every Python there is, and notebooks", all)
}

fn measure() -> Step {
    Step::new("numbers", || outcome(script("measure"), "numbers cannot be taken"))
}

fn outcome(command: Command, wrong: &str) -> Result<Done, Failure> {
    println!("$ {}", command.shown());
    registry::outcome(command.status()?, wrong)
}

//! Blender: whether it plays exports, and the extension for it, packed and tested.

use crate::command::{Command, Failure, target};
use crate::registry;
use crate::steps::{self, Step};
use crate::{test, wheel};

/// `cargo xtask blender [--extension | --every | --zip]`.
pub(crate) fn run(arguments: &[&str]) -> Result<(), Failure> {
    match arguments {
        [] => {
            let mut all = test::blender();
            all.extend([wheel::quickly_built(), extension()]);
            steps::run(all)
        }
        ["--extension"] => steps::run(vec![wheel::quickly_built(), extension()]),
        ["--every"] => steps::run(vec![wheel::quickly_built(), tried("check-all")]),
        ["--zip"] => steps::run(vec![wheel::built(), Step::command("the zip", script("zip"))]),
        _ => Err(Failure("cargo xtask blender [--extension | --every | --zip]".to_owned())),
    }
}

/// Tests the extension in Blender's Python module, with the wheel that is not optimised.
pub(crate) fn extension() -> Step {
    tried("check")
}

fn tried(what: &'static str) -> Step {
    Step::new("the extension for Blender", move || {
        let tried = script(what).args(["--profile", "dev"]);
        println!("$ {}", tried.shown());
        registry::outcome(tried.status()?, "the extension for Blender does not do what it should")
    })
}

fn script(what: &str) -> Command {
    Command::new("python3").args(["xtask/python/blender_extension.py", what, "--target"]).args([target()])
}

//! The command as an archive to download, for one platform.

use crate::command::{Command, Failure, built, target};
use crate::registry;
use crate::steps::{self, Done, Step};
use std::path::Path;

/// `cargo xtask archive [TRIPLE]`: into `target/archive`.
pub(crate) fn run(arguments: &[&str]) -> Result<(), Failure> {
    let build = steps::release().args(["--locked"]);
    match arguments {
        [] => steps::run(vec![Step::command("plaus in release", build), checked()]),
        // That of another platform cannot be tried here.
        [triple] if !triple.starts_with('-') => {
            let program = Path::new(triple).join("release");
            let words = ["pack", "--target", triple].map(str::to_owned);
            let pack = move || outcome(script(&program.to_string_lossy(), &words));
            steps::run(vec![
                Step::command("plaus in release", build.args(["--target", triple])),
                Step::new("the archive", pack),
            ])
        }
        _ => Err(Failure("cargo xtask archive [TRIPLE]".to_owned())),
    }
}

/// The archive of this platform, unpacked and used; `plaus` has been built in release.
pub(crate) fn checked() -> Step {
    Step::new("the archive of the command", || outcome(script("release", &["check".to_owned()])))
}

fn script(within: &str, words: &[String]) -> Command {
    let program = built(within, "plaus");
    let script = Command::new("python3").args(["xtask/python/archive.py"]).args(words).args(["--plaus"]);
    script.args([program]).args(["--venv"]).args([target().join("archive-venv"), target().join("archive")])
}

fn outcome(command: Command) -> Result<Done, Failure> {
    println!("$ {}", command.shown());
    registry::outcome(command.status()?, "the archive is not what it should be")
}

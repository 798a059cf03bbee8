//! Golden traces: checked, or written anew.

use crate::command::{Command, Failure, cargo};

/// Asks the test `golden` to write the traces instead of comparing them.
const BLESS: &str = "PLAUS_BLESS";

pub(crate) fn run(arguments: &[&str]) -> Result<(), Failure> {
    match arguments {
        [] => check(&[]).run(),
        ["--bless"] => {
            check(&["golden_traces_have_the_same_bits"]).env(BLESS, "1").run()?;
            println!(
                "tests/golden is as this build makes it. Look at `git status tests/golden`: where a trace changed that was"
            );
            println!(
                "there before, runs of earlier versions no longer have the same bits, so add a line to CHANGELOG.md that is"
            );
            println!("marked value-breaking and says why.");
            Ok(())
        }
        _ => Err(Failure::new("usage: cargo xtask golden [--bless]")),
    }
}

fn check(more: &[&str]) -> Command {
    cargo(&["test", "--package", "plaus-tests", "--test", "golden"]).args(more)
}

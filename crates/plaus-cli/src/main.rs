//! `plaus`: samples plausible animations of a scenario, and hands them on.

use std::process::ExitCode;

fn main() -> ExitCode {
    ExitCode::from(plaus_cli::run(std::env::args_os()))
}

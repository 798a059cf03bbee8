//! `plaus`: samples plausible animations of a scenario, and exports them.

use std::process::ExitCode;

fn main() -> ExitCode {
    ExitCode::from(plaus_cli::run(std::env::args_os()))
}

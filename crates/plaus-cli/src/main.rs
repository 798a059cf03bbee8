//! `plaus`: samples plausible animations of a scenario, and hands them on.
//!
//! Data goes to stdout, progress and errors to stderr. Exit codes: 0 done, 1 no satisfying sample or failed diagnostics, 2 a wrong scenario, command
//! line or run, 130 interrupted with a checkpoint.

mod clock;
mod commands;
mod console;
mod failure;
mod interrupt;
mod label;
mod plots;
mod progress;
mod report;
mod scenario_file;
mod svg;
mod table;

use clap::Parser;
use failure::Outcome;
use std::process::ExitCode;

/// Samples many plausible animations of one scenario.
#[derive(Parser)]
#[command(name = "plaus", version, about, max_term_width = 100, arg_required_else_help = true)]
#[command(after_help = "Start: `plaus new ball2d ball.toml`, then `plaus sample ball.toml --out run`.\n\
    Exit codes: 0 done; 1 no satisfying sample, or failed diagnostics; 2 wrong scenario, command line or run; 130 interrupted, \
    with a checkpoint.")]
struct Cli {
    #[command(subcommand)]
    command: commands::Command,
}

fn main() -> ExitCode {
    let Cli { command } = Cli::parse();
    match command.run() {
        Ok(Outcome::Done) => ExitCode::SUCCESS,
        Ok(Outcome::Unsatisfied) => ExitCode::from(1),
        Ok(Outcome::Interrupted) => ExitCode::from(interrupt::EXIT),
        Err(failure) => failure.report(),
    }
}

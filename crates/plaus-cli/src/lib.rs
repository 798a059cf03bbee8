//! The command `plaus`, as a library for programs that include it.
//!
//! ```
//! // As at a terminal, with what it prints.
//! assert_eq!(plaus_cli::run(["plaus", "explain", "sigma_d"]), 0);
//! // In silence, with what is wrong as text.
//! let wrong = plaus_cli::call(["diagnose", "no/such/run"]).unwrap_err();
//! assert!(wrong.contains("there is no such run"), "{wrong}");
//! ```
//!
//! Data goes to stdout, progress and errors to stderr. Exit codes: 0 done; 1 no satisfying sample, or failed
//! diagnostics; 2 a wrong scenario, command line or run; 130 interrupted with a checkpoint.

mod clock;
mod commands;
mod console;
mod demanded;
mod failure;
mod glossary;
mod interrupt;
mod likely;
mod output;
mod plots;
mod progress;
mod report;
mod scenario_file;
mod svg;
mod table;
mod waiting;
mod why;

pub use likely::{in_words as chance_in_words, to_json as chance_to_json};
pub use plaus_gallery::label::of as label_of;
pub use report::to_json as diagnosis_to_json;
pub use why::to_json as tally_to_json;

use clap::{CommandFactory, FromArgMatches, Parser};
use failure::{Failure, Outcome};
use plaus_scenes::scenario;
use std::error::Error as _;
use std::ffi::OsString;
use std::num::{IntErrorKind, ParseIntError};

/// Samples many plausible animations of a physical world in which something must happen.
#[derive(Parser)]
#[command(name = "plaus", version, max_term_width = 100, arg_required_else_help = true)]
#[command(after_help = "Start: `plaus new ball2d ball.toml`, then `plaus try ball.toml`.\n\
    Exit codes: 0 done; 1 no satisfying sample, or failed diagnostics; 2 wrong scenario, command line or run; \
    130 interrupted, with a checkpoint.")]
struct Cli {
    #[command(subcommand)]
    command: commands::Command,
}

/// Runs a command line, whose first word is the program's name, and gives the exit code.
pub fn run<A: Into<OsString> + Clone>(arguments: impl IntoIterator<Item = A>) -> u8 {
    let command = match parsed(arguments) {
        Ok(command) => command,
        Err(error) => {
            let _ = error.print(); // there is nowhere left to report a failure
            return error.exit_code() as u8;
        }
    };
    match command.run() {
        Ok(Outcome::Done) => 0,
        Ok(Outcome::Unsatisfied) => 1,
        Ok(Outcome::Interrupted) => interrupt::EXIT,
        Err(failure) => failure.report(),
    }
}

/// The command that a command line says.
fn parsed<A: Into<OsString> + Clone>(arguments: impl IntoIterator<Item = A>) -> Result<commands::Command, clap::Error> {
    let matches = commands::grouped_help(Cli::command()).try_get_matches_from(arguments);
    matches.and_then(|matches| Cli::from_arg_matches(&matches)).map(|cli| cli.command).map_err(with_hint)
}

/// The error, with the valid value nearest to a misspelt one. clap misses some of these: it does not know swapped
/// letters. Errors of the number parser are rephrased.
fn with_hint(mut error: clap::Error) -> clap::Error {
    use clap::error::{ContextKind, ContextValue, ErrorKind};
    let cause = error.source().and_then(|cause| cause.downcast_ref::<ParseIntError>()).map(ParseIntError::kind);
    if let (Some(cause), Some(given), Some(flag)) =
        (cause, error.get(ContextKind::InvalidValue), error.get(ContextKind::InvalidArg))
    {
        let why = match cause {
            IntErrorKind::PosOverflow => "it is too large",
            _ => "it must be a whole number, 0 or more",
        };
        return clap::Error::raw(ErrorKind::ValueValidation, format!("invalid value '{given}' for '{flag}': {why}\n"));
    }
    let hint = match (error.get(ContextKind::InvalidValue), error.get(ContextKind::ValidValue)) {
        (Some(ContextValue::String(given)), Some(ContextValue::Strings(valid))) => {
            scenario::nearest(given, valid.iter().map(String::as_str)).map(str::to_owned)
        }
        _ => None,
    };
    if let Some(hint) = hint.filter(|_| error.get(ContextKind::SuggestedValue).is_none()) {
        error.insert(ContextKind::SuggestedValue, ContextValue::String(hint));
    }
    error
}

/// Runs a command line that begins without the program's name. Errors are returned as text instead of being printed.
///
/// # Errors
///
/// The text that the command would print on stderr before it ends with exit code 2.
pub fn call<A: Into<OsString> + Clone>(arguments: impl IntoIterator<Item = A>) -> Result<(), String> {
    let words = arguments.into_iter().map(Into::into);
    let all = std::iter::once(OsString::from("plaus")).chain(words);
    let command = parsed(all).map_err(|error| error.to_string())?;
    match command.run() {
        Ok(_) | Err(Failure::ReaderGone) => Ok(()),
        Err(Failure::Message(message)) => Err(message),
        Err(Failure::Scenario(error)) => Err(error.to_string()),
    }
}

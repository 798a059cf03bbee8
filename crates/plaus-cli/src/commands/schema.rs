//! `plaus schema`

use crate::console;
use crate::failure::{Failure, Outcome};
use plaus_scenes::scenario;

/// Prints the JSON Schema of scenario files.
pub(super) fn run() -> Result<Outcome, Failure> {
    console::print_line(&format!("{:#}", scenario::published_schema()))?;
    Ok(Outcome::Done)
}

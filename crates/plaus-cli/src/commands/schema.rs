//! `plaus schema`

use crate::failure::{Failure, Outcome};
use crate::output;
use plaus_scenes::scenario;

/// Prints the JSON Schema of scenario files.
pub(super) fn run() -> Result<Outcome, Failure> {
    output::print_line(&format!("{:#}", scenario::published_schema()))?;
    Ok(Outcome::Done)
}

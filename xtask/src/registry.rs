//! Checks that need packages of a registry: skipped where none is in reach, unless CI says that one must be.

use crate::command::Failure;
use crate::steps::Done;

/// Exit code of a script that could not install what it needs.
const ABSENT: i32 = 77;

/// What came of a script that installs what it needs.
pub(crate) fn outcome(code: i32, wrong: &str) -> Result<Done, Failure> {
    match code {
        0 => Ok(Done::Passed),
        ABSENT => absent("the packages it needs cannot be installed"),
        code => Err(Failure(format!("{wrong} (exit code {code})"))),
    }
}

/// Something is not there, and cannot be had.
pub(crate) fn absent(why: &str) -> Result<Done, Failure> {
    if std::env::var_os("CI").is_some_and(|ci| ci == "true") {
        return Err(Failure(format!("{why}, and CI=true says they must be there")));
    }
    Ok(Done::Skipped(format!("{why} here; with CI=true this fails")))
}

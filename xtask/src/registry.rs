//! Checks that need packages from a registry: skipped if no registry is in reach, unless CI requires one.

use crate::command::Failure;
use crate::steps::Done;

/// Exit code of a script that could not install what it needs.
const ABSENT: i32 = 77;

/// The outcome of a script that installs what it needs.
pub(crate) fn outcome(code: i32, wrong: &str) -> Result<Done, Failure> {
    outcome_where(is_ci(), code, wrong)
}

/// The outcome if something is missing and cannot be installed.
pub(crate) fn absent(why: &str) -> Result<Done, Failure> {
    absent_where(is_ci(), why)
}

fn is_ci() -> bool {
    std::env::var_os("CI").is_some_and(|ci| ci == "true")
}

fn outcome_where(ci: bool, code: i32, wrong: &str) -> Result<Done, Failure> {
    match code {
        0 => Ok(Done::Passed),
        ABSENT => absent_where(ci, "the packages it needs cannot be installed"),
        code => Err(Failure(format!("{wrong} (exit code {code})"))),
    }
}

fn absent_where(ci: bool, why: &str) -> Result<Done, Failure> {
    if ci {
        return Err(Failure(format!("{why}, and CI=true says they must be there")));
    }
    Ok(Done::Skipped(format!("{why} here; with CI=true this fails")))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn packages_may_be_missing_but_not_under_ci() {
        assert!(matches!(outcome_where(false, ABSENT, "wrong"), Ok(Done::Skipped(why)) if why.contains("CI=true")));
        assert!(
            matches!(outcome_where(true, ABSENT, "wrong"), Err(Failure(why)) if why.contains("cannot be installed"))
        );
        for ci in [false, true] {
            assert!(matches!(outcome_where(ci, 0, "wrong"), Ok(Done::Passed)));
            assert!(matches!(outcome_where(ci, 1, "wrong"), Err(Failure(why)) if why == "wrong (exit code 1)"));
        }
    }
}

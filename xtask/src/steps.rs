//! Steps run one after the other, each with its duration.

use crate::command::{Command, Failure, cargo};
use std::time::Instant;

/// The outcome of a step that did not fail.
#[derive(Debug)]
pub(crate) enum Done {
    Passed,
    /// It could not be run here, and need not be, for this reason.
    Skipped(String),
}

/// Something that must pass.
pub(crate) struct Step {
    name: &'static str,
    work: Box<dyn FnOnce() -> Result<Done, Failure>>,
}

impl Step {
    pub(crate) fn new(name: &'static str, work: impl FnOnce() -> Result<Done, Failure> + 'static) -> Self {
        Self { name, work: Box::new(work) }
    }

    /// A step that is one command.
    pub(crate) fn command(name: &'static str, command: Command) -> Self {
        Self::new(name, move || {
            println!("$ {}", command.shown());
            command.run().map(|()| Done::Passed)
        })
    }
}

/// Builds the command as it is released: with all that it can read.
pub(crate) fn release() -> Command {
    cargo(&["build", "--release", "--package", "plaus-cli", "--features", "plaus-cli/usd"])
}

/// The command, built in release.
pub(crate) fn released() -> Step {
    Step::command("plaus in release", release())
}

/// Runs `steps` until one fails, and says at the end how many passed.
pub(crate) fn run(steps: Vec<Step>) -> Result<(), Failure> {
    run_on(steps, false)
}

/// The same, but a failure keeps the others from nothing: who waits long for the result wants to know all of it.
pub(crate) fn run_all(steps: Vec<Step>) -> Result<(), Failure> {
    run_on(steps, true)
}

fn run_on(steps: Vec<Step>, after_failures: bool) -> Result<(), Failure> {
    let count = steps.len();
    let mut passed = 0;
    let (mut skipped, mut failed) = (Vec::new(), Vec::new());
    let mut durations = Vec::new();
    let begun = now();
    for (number, Step { name, work }) in (1..).zip(steps) {
        println!("\n=== step {number} of {count}: {name}");
        let start = now();
        let done = work();
        let seconds = start.elapsed().as_secs_f64();
        durations.push((name, seconds));
        match done {
            Ok(Done::Passed) => {
                println!("=== {name}: passed in {seconds:.1} s");
                passed += 1;
            }
            Ok(Done::Skipped(why)) => {
                println!("=== {name}: SKIPPED, {why}");
                skipped.push(name);
            }
            Err(Failure(why)) => {
                println!("=== {name}: FAILED after {seconds:.1} s: {why}");
                failed.push(name);
            }
        }
        if !failed.is_empty() && !after_failures {
            break;
        }
    }
    println!("\n=== durations");
    for (name, seconds) in &durations {
        println!("{seconds:8.1} s  {name}");
    }
    println!("{:8.1} s  in all", begun.elapsed().as_secs_f64());
    let mut closing = format!("steps: {passed} passed, {} failed", failed.len());
    if !skipped.is_empty() {
        closing.push_str(&format!(", {} skipped ({})", skipped.len(), skipped.join(", ")));
    }
    if durations.len() < count {
        closing.push_str(&format!(", {} not run", count - durations.len()));
    }
    println!("{closing}");
    match &failed[..] {
        [] => Ok(()),
        [one] => Err(Failure(format!("the step `{one}` failed; its output is above"))),
        more => Err(Failure(format!("these steps failed, with their output above: `{}`", more.join("`, `")))),
    }
}

#[allow(
    clippy::disallowed_methods,
    reason = "how long a chore takes is for the person who waits, no result depends on it"
)]
pub(crate) fn now() -> Instant {
    Instant::now()
}

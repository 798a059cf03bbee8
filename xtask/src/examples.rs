//! Runs every example of every crate, several at a time.

use crate::command::{Command, Failure, built, root};
use crate::steps::Done;
use std::fs;
use std::num::NonZero;
use std::sync::Mutex;
use std::thread;

/// Runs every example of every crate.
pub(crate) fn run() -> Result<Done, Failure> {
    let names = names()?;
    let queue = Mutex::new(names.iter());
    let failed = Mutex::new(Vec::new());
    let work = || {
        while let Some(name) = queue.lock().ok().and_then(|mut queue| queue.next()) {
            if let Err(Failure(why)) = run_one(name) {
                failed.lock().map(|mut all| all.push(why)).unwrap_or_default();
            }
        }
    };
    thread::scope(|scope| {
        for _ in 0..thread::available_parallelism().map_or(1, NonZero::get) {
            scope.spawn(work);
        }
    });
    let mut failed = failed.into_inner().unwrap_or_default();
    failed.sort();
    println!("{} examples ran", names.len());
    if failed.is_empty() { Ok(Done::Passed) } else { Err(Failure(failed.join("; "))) }
}

/// Names of all examples.
fn names() -> Result<Vec<String>, Failure> {
    let mut found = Vec::new();
    for package in fs::read_dir(root().join("crates")).map_err(Failure::new)? {
        let package = package.map_err(Failure::new)?;
        let Ok(examples) = fs::read_dir(package.path().join("examples")) else { continue };
        for example in examples {
            let path = example.map_err(Failure::new)?.path();
            if path.extension().is_some_and(|extension| extension == "rs") {
                found.push(path.file_stem().unwrap_or_default().to_string_lossy().into_owned());
            }
        }
    }
    found.sort();
    Ok(found)
}

/// Runs one; its output is shown when it has ended, so that the outputs of two examples do not mix.
fn run_one(name: &str) -> Result<(), Failure> {
    let command = Command::new(built("debug/examples", name));
    let shown = command.shown().to_owned();
    let (code, printed) = command.output()?;
    println!("$ {shown}\n{}", String::from_utf8_lossy(&printed));
    if code == 0 { Ok(()) } else { Err(Failure(format!("`{shown}` failed with exit code {code}"))) }
}

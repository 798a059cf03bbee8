//! `--confirm`: which solutions hold at the reference accuracy.

use crate::console::{self, quoted};
use crate::failure::Failure;
use crate::interrupt;
use crate::table::grouped;
use plaus_run::disk::RealDisk;
use plaus_run::{Confirmation, Error, Run, RunOf, RunVisitor};
use plaus_scenes::{AccuracyPreset, Scene};

/// What solutions are held against.
pub(super) const ACCURACY: AccuracyPreset = AccuracyPreset::Reference;

struct Confirm {
    threads: usize,
    tell: bool,
}

impl RunVisitor for Confirm {
    type Output = Result<Option<Confirmation>, Error>;
    fn visit<S: Scene>(self, run: RunOf<'_, S>) -> Self::Output {
        Confirmation::of(&run, ACCURACY, self.threads, |done, all| {
            if self.tell && console::is_live() {
                let (done, all) = (grouped(done as u64), grouped(all as u64));
                console::note(&format!("\r\x1b[2Kconfirming solutions: {done} of {all}"));
            }
            !interrupt::asked()
        })
    }
}

/// Simulates every distinct solution of a run again and writes the list beside its records. `None`: interrupted.
pub(super) fn confirm(run: &Run, threads: usize, tell: bool) -> Result<Option<Confirmation>, Failure> {
    let confirmation = run.visit(Confirm { threads, tell })?;
    if tell && console::is_live() {
        console::note("\r\x1b[2K");
    }
    let confirmation = confirmation?;
    if let Some(list) = &confirmation {
        let _claim = run.folder().claim()?;
        list.write(run.folder(), &RealDisk)?;
    }
    Ok(confirmation)
}

/// How many hold, in words.
pub(super) fn in_words(run: &Run, list: &Confirmation) -> String {
    format!(
        "at {} accuracy {} of {} distinct solutions hold; {} lists them, and `plaus export --confirmed` keeps to those that hold",
        list.accuracy.name(),
        grouped(list.held),
        grouped(list.solutions.len() as u64),
        quoted(&run.folder().confirmed()),
    )
}

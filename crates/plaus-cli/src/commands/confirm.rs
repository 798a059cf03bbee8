//! `--confirm`: finds which solutions still hold at reference accuracy.

use crate::console::quoted;
use crate::failure::Failure;
use crate::interrupt;
use crate::table::{counted, grouped};
use crate::waiting::{self, Waiting};
use plaus_run::disk::RealDisk;
use plaus_run::{Confirmation, Run, RunReader};
use plaus_scenes::AccuracyPreset;
use std::sync::atomic::{AtomicBool, Ordering};

/// The accuracy at which solutions are confirmed.
pub(super) const ACCURACY: AccuracyPreset = AccuracyPreset::Reference;

/// Simulates every distinct solution of a run again, and writes the list beside the run's records. Once the flag is
/// set, which the reader's simulations see too, those that are left stay so.
pub(super) fn confirm(
    run: &RunReader<'_>,
    flag: &AtomicBool,
    threads: usize,
    tell: bool,
) -> Result<Confirmation, Failure> {
    let waiting = tell.then(|| Waiting::on("confirming solutions".to_owned()));
    let list = Confirmation::of(run, ACCURACY, threads, |done, all| {
        waiting::far(done as u64, all as u64, "solutions");
        !flag.load(Ordering::SeqCst)
    })?;
    drop(waiting);
    let folder = run.run().folder();
    let _claim = folder.claim()?;
    list.write(folder, &RealDisk)?;
    Ok(list)
}

/// Says in words what is known so far, if that is not all.
pub(super) fn cut_in_words(run: &Run, list: &Confirmation) -> String {
    let (all, done) = (list.left + list.solutions.len() as u64, list.solutions.len() as u64);
    let why = if interrupt::asked() { "interrupted" } else { "out of time" };
    format!(
        "{why} while confirming: {} of {} checked, {} of them hold; continue with: plaus resume {} --confirm",
        grouped(done),
        counted(all, "distinct solution"),
        grouped(list.held),
        quoted(run.folder().path()),
    )
}

/// Says in words how many hold.
pub(super) fn in_words(run: &Run, list: &Confirmation) -> String {
    format!(
        "at {} accuracy {} of {} hold; {} lists them, and `plaus export --confirmed` keeps to \
         those",
        list.accuracy.name(),
        grouped(list.held),
        counted(list.solutions.len() as u64, "distinct solution"),
        quoted(&run.folder().confirmed()),
    )
}

//! `--confirm`: finds which solutions still hold at reference accuracy.

use crate::console::quoted;
use crate::failure::Failure;
use crate::table::{counted, grouped};
use crate::waiting::{self, Waiting};
use plaus_run::disk::RealDisk;
use plaus_run::{Confirmation, Run, RunReader};
use plaus_scenes::AccuracyPreset;
use std::sync::atomic::{AtomicBool, Ordering};

/// The accuracy at which solutions are confirmed.
pub(super) const ACCURACY: AccuracyPreset = AccuracyPreset::Reference;

/// Simulates every distinct solution of a run again, and writes the list beside the run's records. `None`: the
/// flag was set, which the reader's simulations see too.
pub(super) fn confirm(
    run: &RunReader<'_>,
    flag: &AtomicBool,
    threads: usize,
    tell: bool,
) -> Result<Option<Confirmation>, Failure> {
    let waiting = tell.then(|| Waiting::on("confirming solutions".to_owned()));
    let confirmation = Confirmation::of(run, ACCURACY, threads, |done, all| {
        waiting::far(format!("{} of {}", grouped(done as u64), grouped(all as u64)));
        !flag.load(Ordering::SeqCst)
    })?;
    drop(waiting);
    if let Some(list) = &confirmation {
        let folder = run.run().folder();
        let _claim = folder.claim()?;
        list.write(folder, &RealDisk)?;
    }
    Ok(confirmation)
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

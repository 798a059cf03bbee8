//! `--confirm`: finds which solutions still hold at reference accuracy.

use crate::console::{self, quoted};
use crate::failure::Failure;
use crate::interrupt;
use crate::table::grouped;
use plaus_run::disk::RealDisk;
use plaus_run::{Confirmation, Run, RunReader};
use plaus_scenes::AccuracyPreset;

/// The accuracy at which solutions are confirmed.
pub(super) const ACCURACY: AccuracyPreset = AccuracyPreset::Reference;

/// Simulates every distinct solution of a run again, and writes the list beside the run's records. `None`: interrupted.
pub(super) fn confirm(run: &RunReader<'_>, threads: usize, tell: bool) -> Result<Option<Confirmation>, Failure> {
    let confirmation = Confirmation::of(run, ACCURACY, threads, |done, all| {
        if tell && console::is_live() {
            let (done, all) = (grouped(done as u64), grouped(all as u64));
            console::note(&format!("\r\x1b[2Kconfirming solutions: {done} of {all}"));
        }
        !interrupt::asked()
    });
    if tell && console::is_live() {
        console::note("\r\x1b[2K");
    }
    let confirmation = confirmation?;
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
        "at {} accuracy {} of {} distinct solutions hold; {} lists them, and `plaus export --confirmed` keeps to \
         those",
        list.accuracy.name(),
        grouped(list.held),
        grouped(list.solutions.len() as u64),
        quoted(&run.folder().confirmed()),
    )
}

//! `plaus merge`

use crate::clock::{Stopwatch, in_words};
use crate::console::{self, quoted};
use crate::failure::{Failure, Outcome};
use crate::interrupt;
use crate::table::{counted, grouped};
use plaus_run::Folder;
use plaus_run::disk::RealDisk;
use plaus_run::merge::{MergePulse, Merging, merge};
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::Duration;

/// Time between two checks whether there is something to show, or a reason to stop.
const TICK: Duration = Duration::from_millis(20);
/// Seconds between two lines of progress.
const EVERY: f64 = 2.0;

/// Which pieces, and to which folder or file.
#[derive(clap::Args)]
pub(crate) struct Args {
    /// Pieces of a run, or files that `plaus chance --shard` wrote, or folders that hold them; they are left unchanged
    #[arg(required = true, value_name = "PIECES")]
    pieces: Vec<PathBuf>,
    /// Folder to make for the whole run, or file for the whole estimate of `plaus chance`; must not exist
    #[arg(long, alias = "output", value_name = "RUN")]
    out: PathBuf,
    /// Number of threads; 0: one per core. Results do not depend on it
    #[arg(long, value_name = "T", default_value_t = 0)]
    threads: usize,
    /// Show no progress
    #[arg(short, long)]
    quiet: bool,
}

impl Args {
    pub(super) fn run(self) -> Result<Outcome, Failure> {
        interrupt::listen()?;
        if let Some(files) = plaus_run::chance::files_at(&self.pieces)? {
            return self.chances(&files);
        }
        let (clock, pulse, over) = (Stopwatch::start(), MergePulse::default(), AtomicBool::new(false));
        let merged = thread::scope(|scope| {
            scope.spawn(|| self.look_on(&pulse, &over));
            let merging = Merging { threads: self.threads, disk: &RealDisk, pulse: &pulse };
            let merged = merge(&self.pieces, &Folder::new(&self.out), merging);
            over.store(true, Ordering::Relaxed);
            merged
        });
        if merged.is_err() && interrupt::asked() {
            console::note_line("interrupted: nothing was made, and the pieces are as they were");
            return Ok(Outcome::Interrupted);
        }
        let merged = merged?;
        if !self.quiet {
            let (pieces, chains, took) = (merged.pieces, merged.chains, in_words(clock.seconds()));
            let megabytes = merged.bytes.div_ceil(1_000_000);
            let out = quoted(&self.out);
            console::note_line(&format!(
                "merged {}: {}, {} MB of records, in {took}\n\nnext:\n  plaus diagnose {out}",
                counted(pieces as u64, "piece"),
                counted(chains as u64, "chain"),
                grouped(megabytes)
            ));
        }
        Ok(Outcome::Done)
    }

    /// Pieces that are files were written by `plaus chance`.
    fn chances(&self, files: &[PathBuf]) -> Result<Outcome, Failure> {
        let whole = plaus_run::chance::merge(files, &self.out, &RealDisk)?;
        if !self.quiet {
            let (pieces, batches) = (counted(files.len() as u64, "piece"), counted(whole.done().0 as u64, "batch"));
            let out = quoted(&self.out);
            console::note_line(&format!("merged {pieces}: {batches}\n\nnext:\n  plaus chance {out}"));
        }
        Ok(Outcome::Done)
    }

    fn look_on(&self, pulse: &MergePulse, over: &AtomicBool) {
        let mut shown = Stopwatch::start();
        while !over.load(Ordering::Relaxed) {
            if interrupt::asked() {
                pulse.stop();
            }
            if !self.quiet && shown.seconds() >= EVERY {
                shown = Stopwatch::start();
                let (bytes, written) = pulse.bytes();
                let (written, bytes) = (grouped(written / 1_000_000), grouped(bytes / 1_000_000));
                console::note_line(&format!("{}  {written} of {bytes} MB", counted(pulse.pieces(), "piece")));
            }
            thread::sleep(TICK);
        }
    }
}

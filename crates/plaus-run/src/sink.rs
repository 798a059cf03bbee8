//! Writes what the chains produce: records after every round, checkpoints when they are due.

use crate::checkpoint::{self, Checkpoint};
use crate::disk::{Disk, MANY, for_each};
use crate::error::RunFileError;
use crate::folder::Folder;
use crate::gauge::Gauge;
use crate::records;
use crate::siblings::Siblings;
use crate::trail;
use crate::watch::Watch;
use crate::{Draw, Outcome};
use plaus_mcmc::{Block, Control, Progress, Sink, Snapshot, parallel};
use rayon::ThreadPool;
use std::path::PathBuf;

/// Where a run is written, and by whom.
pub(crate) struct Place<'a> {
    pub(crate) folder: &'a Folder,
    pub(crate) disk: &'a dyn Disk,
    /// The number that the run's files carry.
    pub(crate) run: u64,
    /// Number of the first chain.
    pub(crate) first: u32,
    /// Threads that encode.
    pub(crate) pool: ThreadPool,
}

impl Hunt {
    /// Whether a piece is past the end of the run. It has done the iterations `0 .. done`.
    pub(crate) fn is_over(&mut self, done: u64) -> bool {
        self.over = self.siblings.end(self.wanted).is_some_and(|end| end < done);
        self.over
    }
}

/// The sink that writes a run folder.
pub(crate) struct FolderSink<'a> {
    place: Place<'a>,
    watch: &'a mut dyn Watch,
    /// Set if somebody watches the mixing.
    gauge: Option<Gauge<'a>>,
    /// Bytes in each chain's records.
    lengths: Vec<u64>,
    /// Blocks of this round, to be written at its end.
    blocks: Vec<(u32, Block<Draw, Outcome>)>,
    /// Each chain as of the last round.
    snapshots: Vec<Snapshot<Draw, Outcome>>,
    /// Iterations that the last checkpoint covers.
    safe: u64,
    hunt: Option<Hunt>,
}

/// A search for distinct solutions together with other pieces.
pub(crate) struct Hunt {
    pub(crate) siblings: Siblings,
    pub(crate) wanted: u64,
    /// Whether the piece is past the end of the run.
    pub(crate) over: bool,
}

impl<'a> FolderSink<'a> {
    /// A sink for chains whose records have `lengths` bytes each and cover `safe` iterations.
    pub(crate) fn new(
        place: Place<'a>,
        watch: &'a mut dyn Watch,
        gauge: Option<Gauge<'a>>,
        lengths: Vec<u64>,
        safe: u64,
        hunt: Option<Hunt>,
    ) -> Self {
        let (blocks, snapshots) = (Vec::new(), Vec::new());
        Self { place, watch, gauge, lengths, blocks, snapshots, safe, hunt }
    }

    /// Whether other pieces have found so much that this one need not continue.
    pub(crate) fn is_past_the_end(&self) -> bool {
        self.hunt.as_ref().is_some_and(|hunt| hunt.over)
    }

    /// Iterations that a resumed run would keep.
    pub(crate) fn safe(&self) -> u64 {
        self.safe
    }

    /// Makes everything written so far the point to continue from.
    pub(crate) fn checkpoint(&mut self) -> Result<(), RunFileError> {
        let Some(end) = self.snapshots.first().map(|snapshot| snapshot.end_iteration).filter(|&end| end > self.safe)
        else {
            return Ok(());
        };
        let Place { folder, disk, first, .. } = self.place;
        let paths: Vec<PathBuf> = (first..).take(self.lengths.len()).map(|chain| folder.records(chain)).collect();
        if paths.len() > MANY {
            disk.sync_within(folder.path(), &paths).map_err(RunFileError::io(folder.path(), "write"))?;
        } else {
            for_each(&paths, |path| disk.sync(path).map_err(RunFileError::io(path, "write")))?;
        }
        if self.hunt.is_some() {
            disk.sync(&folder.trail()).map_err(RunFileError::io(&folder.trail(), "write"))?;
        }
        checkpoint::replace(folder, disk, &self.checkpoints())?;
        self.safe = end;
        self.watch.checkpoint_done();
        Ok(())
    }

    /// All chains as of the last round.
    fn checkpoints(&self) -> Vec<Checkpoint> {
        let run = self.place.run;
        let chains = (self.place.first..).zip(&self.lengths).zip(self.snapshots.iter().cloned());
        chains.map(|((chain, &records), snapshot)| Checkpoint { run, chain, records, snapshot }).collect()
    }

    fn write_trail(&self, progress: &Progress<'_>) -> Result<(), RunFileError> {
        trail::append(self.place.folder, self.place.disk, self.place.run, &progress.sightings, self.checkpoints())
    }

    fn write_blocks(&mut self) -> Result<(), RunFileError> {
        let Place { folder, disk, run, first, ref pool } = self.place;
        let blocks = std::mem::take(&mut self.blocks);
        let encode = |k: usize| {
            let (chain, block) = &blocks[k];
            let bytes = records::encode(run, *chain, block);
            bytes.map(|bytes| (*chain, bytes)).map_err(|error| RunFileError::new(folder.records(*chain), error.into()))
        };
        let frames = parallel::install(pool, || parallel::try_map(blocks.len(), encode))?;
        for (chain, frame) in frames {
            let path = folder.records(chain);
            disk.append(&path, &frame).map_err(RunFileError::io(&path, "write"))?;
            self.lengths[(chain - first) as usize] += frame.len() as u64;
        }
        Ok(())
    }
}

impl Sink<Draw, Outcome> for FolderSink<'_> {
    type Error = RunFileError;

    fn block(
        &mut self,
        chain: u32,
        block: Block<Draw, Outcome>,
        snapshot: &Snapshot<Draw, Outcome>,
    ) -> Result<(), RunFileError> {
        match self.snapshots.get_mut((chain - self.place.first) as usize) {
            Some(last) => last.clone_from(snapshot),
            None => self.snapshots.push(snapshot.clone()),
        }
        if let Some(gauge) = &mut self.gauge {
            gauge.note(chain, &block);
        }
        self.blocks.push((chain, block));
        Ok(())
    }

    fn round(&mut self, progress: &Progress<'_>) -> Result<Control, RunFileError> {
        self.write_blocks()?;
        if self.hunt.is_some() {
            self.write_trail(progress)?;
        }
        if let Some(hunt) = &mut self.hunt {
            let own = self.place.first..self.place.first + progress.chains.len() as u32;
            hunt.siblings.note(progress.sightings.iter().cloned(), own, progress.end_iteration);
        }
        if self.watch.checkpoint_due() {
            self.checkpoint()?;
            if let Some(hunt) = &mut self.hunt {
                hunt.is_over(progress.end_iteration);
            }
        }
        if let Some(gauge) = &mut self.gauge {
            gauge.thin_out();
            if self.watch.mixing_due() {
                let mixing = parallel::install(&self.place.pool, || gauge.mixing());
                self.watch.mixing(mixing);
            }
        }
        let control = self.watch.round(progress);
        Ok(if self.is_past_the_end() { Control::Stop } else { control })
    }
}

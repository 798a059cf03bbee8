//! Writes what the chains leave behind: records after every round, checkpoints when they are due.

use crate::checkpoint::{self, Checkpoint};
use crate::disk::Disk;
use crate::error::RunFileError;
use crate::folder::Folder;
use crate::gauge::Gauge;
use crate::records;
use crate::sample::Watch;
use plaus_mcmc::{Block, Control, Progress, Sink, Snapshot, Target};
use plaus_scenes::Scene;
use rayon::ThreadPool;
use rayon::prelude::*;

/// Where a run is written, and by whom.
pub(crate) struct Place<'a> {
    pub(crate) folder: &'a Folder,
    pub(crate) disk: &'a dyn Disk,
    /// The number that the run's files bear.
    pub(crate) run: u64,
    /// Threads that encode.
    pub(crate) pool: ThreadPool,
}

type BlockOf<S> = Block<<S as Target>::Draw, <S as Target>::Outcome>;
type SnapshotOf<S> = Snapshot<<S as Target>::Draw, <S as Target>::Outcome>;

/// The sink that writes a run folder.
pub(crate) struct FolderSink<'a, S: Scene> {
    place: Place<'a>,
    watch: &'a mut dyn Watch,
    /// Where somebody looks at it.
    gauge: Option<Gauge<'a, S>>,
    /// Bytes in each chain's records.
    lengths: Vec<u64>,
    /// Blocks of this round, to be written at its end.
    blocks: Vec<(u32, BlockOf<S>)>,
    /// Each chain as of the last round.
    snapshots: Vec<SnapshotOf<S>>,
    /// Iterations the last checkpoint covers.
    safe: u64,
}

impl<'a, S: Scene> FolderSink<'a, S> {
    /// A sink for chains that have `lengths` bytes of records each, of `safe` iterations.
    pub(crate) fn new(
        place: Place<'a>,
        watch: &'a mut dyn Watch,
        gauge: Option<Gauge<'a, S>>,
        lengths: Vec<u64>,
        safe: u64,
    ) -> Self {
        Self { place, watch, gauge, lengths, blocks: Vec::new(), snapshots: Vec::new(), safe }
    }

    /// Iterations that a resumed run would keep.
    pub(crate) fn safe(&self) -> u64 {
        self.safe
    }

    /// Makes everything written so far the point to go on from.
    pub(crate) fn checkpoint(&mut self) -> Result<(), RunFileError> {
        let Some(end) = self.snapshots.first().map(|snapshot| snapshot.end_iteration).filter(|&end| end > self.safe)
        else {
            return Ok(());
        };
        let Place { folder, disk, run, .. } = self.place;
        let chains = || (0..).zip(&self.lengths);
        for (chain, _) in chains() {
            let path = folder.records(chain);
            disk.sync(&path).map_err(RunFileError::io(&path, "write"))?;
        }
        let snapshots = self.snapshots.iter().cloned();
        let checkpoints: Vec<_> = chains()
            .zip(snapshots)
            .map(|((chain, &records), snapshot)| Checkpoint { run, chain, records, snapshot })
            .collect();
        checkpoint::replace(folder, disk, &checkpoints)?;
        self.safe = end;
        self.watch.checkpoint_done();
        Ok(())
    }

    fn write_blocks(&mut self) -> Result<(), RunFileError> {
        let Place { folder, disk, run, ref pool } = self.place;
        let encode = |(chain, block): (u32, BlockOf<S>)| {
            let bytes = records::encode(run, chain, &block);
            bytes.map(|bytes| (chain, bytes)).map_err(|error| RunFileError::new(folder.records(chain), error.into()))
        };
        let blocks = std::mem::take(&mut self.blocks);
        let frames: Vec<_> = pool.install(|| blocks.into_par_iter().map(encode).collect::<Result<_, _>>())?;
        for (chain, frame) in frames {
            let path = folder.records(chain);
            disk.append(&path, &frame).map_err(RunFileError::io(&path, "write"))?;
            self.lengths[chain as usize] += frame.len() as u64;
        }
        Ok(())
    }
}

impl<S: Scene> Sink<S::Draw, S::Outcome> for FolderSink<'_, S> {
    type Error = RunFileError;

    fn block(&mut self, chain: u32, block: BlockOf<S>, snapshot: &SnapshotOf<S>) -> Result<(), RunFileError> {
        match self.snapshots.get_mut(chain as usize) {
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
        if self.watch.checkpoint_due() {
            self.checkpoint()?;
        }
        if let Some(gauge) = &mut self.gauge {
            gauge.thin_out();
            if self.watch.mixing_due() {
                let mixing = self.place.pool.install(|| gauge.mixing());
                self.watch.mixing(mixing);
            }
        }
        Ok(self.watch.round(progress))
    }
}

//! What a chain has recorded: one frame for each block of iterations, only ever appended.

use crate::codec::{self, EncodeError, FrameError, FrameProblem, Frames, Kind};
use crate::error::{RunFileError, RunFileProblem};
use crate::noted;
use crate::{Draw, Outcome};
use plaus_mcmc::{Block, Distinct, FirstOfClass, Plan};
use plaus_scenes::Stage;
use serde::{Deserialize, Serialize};
use std::fs::File;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

const KIND: Kind = Kind::new(*b"recs", 2, "records of a chain");

/// A block with the run and the chain it belongs to.
#[derive(Serialize, Deserialize)]
struct Stored<B> {
    run: u64,
    chain: u32,
    block: B,
}

/// A block as it is stored.
///
/// # Errors
/// [`EncodeError`] if it is too long.
pub(crate) fn encode(run: u64, chain: u32, block: &Block<Draw, Outcome>) -> Result<Vec<u8>, EncodeError> {
    let mut out = Vec::with_capacity(128 + 96 * block.entries.len());
    codec::append(KIND, &Stored { run, chain, block }, &mut out)?;
    Ok(out)
}

/// Whose records they are, and how much of them is valid.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Extent {
    pub(crate) run: u64,
    pub(crate) chain: u32,
    pub(crate) thin: u64,
    /// Valid bytes, from the checkpoint.
    pub(crate) bytes: u64,
    /// One past the last iteration they cover.
    pub(crate) end_iteration: u64,
}

/// The blocks of one chain, read one after the other. After an error it ends.
pub struct Blocks {
    frames: Frames<Stored<Block<Draw, Outcome>>, File>,
    path: PathBuf,
    extent: Extent,
    next_iteration: u64,
    draws: u64,
    over: bool,
}

impl Blocks {
    pub(crate) fn open(path: &Path, extent: Extent) -> Result<Self, RunFileError> {
        let file = File::open(path).map_err(RunFileError::io(path, "read"))?;
        let present = file.metadata().map_err(RunFileError::io(path, "read"))?.len();
        let frames = Frames::new(KIND, file, extent.bytes.min(present));
        let over = extent.bytes == 0;
        Ok(Self { frames, path: path.to_owned(), extent, next_iteration: 0, draws: 0, over })
    }

    fn damage(&self, offset: u64, problem: FrameProblem) -> RunFileError {
        let source = FrameError { offset, problem };
        RunFileError::new(&self.path, RunFileProblem::Records { source, intact: self.draws })
    }

    /// Bytes and iterations before the first damage.
    pub(crate) fn intact(mut self) -> (u64, u64) {
        let mut intact = (0, 0);
        while let Some(Ok(block)) = self.next() {
            intact = (self.frames.offset(), block.end_iteration);
        }
        intact
    }

    /// The end of the file, which must be where the checkpoint says.
    fn end(&self) -> Option<RunFileError> {
        let present = self.frames.offset();
        let missing = present < self.extent.bytes || self.next_iteration != self.extent.end_iteration;
        missing.then(|| self.damage(present, FrameProblem::Truncated { needed: self.extent.bytes, present }))
    }

    fn check(&self, offset: u64, stored: &Stored<Block<Draw, Outcome>>) -> Result<u64, RunFileError> {
        let Stored { run, chain, block } = stored;
        if (*run, *chain) != (self.extent.run, self.extent.chain) {
            let message = format!("the frame at byte {offset} belongs to chain {chain} of run {run:016x}");
            return Err(RunFileError::new(&self.path, RunFileProblem::Mixed(message)));
        }
        let (first, end, thin) = (block.first_iteration, block.end_iteration, self.extent.thin);
        let held = block.entries.iter().try_fold(0_u64, |sum, entry| sum.checked_add(entry.draws));
        let due = end.div_ceil(thin).checked_sub(first.div_ceil(thin));
        let whole = block.entries.iter().all(|entry| entry.draws > 0) && held.is_some() && held == due;
        if first != self.next_iteration || end <= first || end > self.extent.end_iteration || !whole {
            let reason = format!(
                "it covers iterations {first} to {end}, which do not follow the previous ones, or do not match its draws"
            );
            return Err(self.damage(offset, FrameProblem::Payload { name: "block", reason }));
        }
        Ok(due.unwrap_or(0))
    }
}

impl Iterator for Blocks {
    type Item = Result<Block<Draw, Outcome>, RunFileError>;

    fn next(&mut self) -> Option<Self::Item> {
        if self.over {
            return None;
        }
        let offset = self.frames.offset();
        let item = match self.frames.next() {
            None => {
                self.over = true;
                return self.end().map(Err);
            }
            Some(Err(FrameError { offset, problem })) => Err(self.damage(offset, problem)),
            Some(Ok(stored)) => self.check(offset, &stored).map(|draws| {
                self.draws += draws;
                self.next_iteration = stored.block.end_iteration;
                stored.block
            }),
        };
        self.over = item.is_err();
        Some(item)
    }
}

/// The beginning of a stored block: run, chain, first iteration and one past the last.
type Head = (u64, u32, u64, u64);

/// Passes on the bytes of a chain's records in large parts: whole frames with verified checksums, places and numbers of
/// iterations. Their contents are not read.
///
/// # Errors
/// [`RunFileError`] if they are damaged or belong elsewhere, or as `take`.
pub(crate) fn copy<E: From<RunFileError>>(
    path: &Path,
    extent: Extent,
    mut take: impl FnMut(&[u8]) -> Result<(), E>,
) -> Result<(), E> {
    let Extent { run, chain, thin, bytes, end_iteration } = extent;
    if bytes == 0 {
        return Ok(());
    }
    let file = File::open(path).map_err(RunFileError::io(path, "read"))?;
    let present = file.metadata().map_err(RunFileError::io(path, "read"))?.len();
    let mut frames = Frames::<(), _>::new(KIND, file, bytes.min(present));
    let mut next_iteration = 0;
    let damage = |next_iteration: u64, source| {
        RunFileError::new(path, RunFileProblem::Records { source, intact: next_iteration.div_ceil(thin) })
    };
    loop {
        let offset = frames.offset();
        let Some(frame) = frames.next_raw() else { break };
        let frame = frame.map_err(|source| damage(next_iteration, source))?;
        let head = codec::head::<Head>(KIND, frame);
        let head = head.map_err(|problem| damage(next_iteration, FrameError { offset, problem }))?;
        if (head.0, head.1, head.2) != (run, chain, next_iteration) || head.3 <= next_iteration {
            let message = format!("the frame at byte {offset} does not follow the previous one");
            return Err(RunFileError::new(path, RunFileProblem::Mixed(message)).into());
        }
        next_iteration = head.3;
        frames.passed().map_or(Ok(()), &mut take)?;
    }
    let offset = frames.offset();
    if offset < bytes || next_iteration != end_iteration {
        let problem = FrameProblem::Truncated { needed: bytes, present: offset };
        return Err(damage(next_iteration, FrameError { offset, problem }).into());
    }
    Ok(())
}

/// Rebuilds when a chain first recorded each class of solutions, from the first iteration that counts on.
pub(crate) fn distinct(path: &Path, extent: Extent, plan: Plan, scene: &Stage) -> Result<Distinct, RunFileError> {
    let from = plan.counts_from();
    let mut distinct = Distinct::apart(1.0);
    let first_counted = from.next_multiple_of(extent.thin);
    for block in Blocks::open(path, extent)? {
        let block = block?;
        let mut iteration = block.first_iteration.next_multiple_of(extent.thin);
        for entry in &block.entries {
            let end = iteration + entry.draws * extent.thin;
            if let Some(class) = entry.class.filter(|_| end > first_counted) {
                let iteration = iteration.max(first_counted);
                let first = FirstOfClass { iteration, chain: extent.chain, class };
                noted::note(&mut distinct, first, &entry.state, plan, scene);
            }
            iteration = end;
        }
    }
    Ok(distinct)
}

/// Length of a file; 0 if there is none.
pub(crate) fn length(path: &Path) -> Result<u64, RunFileError> {
    match std::fs::metadata(path) {
        Ok(meta) => Ok(meta.len()),
        Err(error) if error.kind() == ErrorKind::NotFound => Ok(0),
        Err(error) => Err(RunFileError::io(path, "read")(error)),
    }
}

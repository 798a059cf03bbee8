//! Checkpoints: one for each chain, all replaced together.
//!
//! A run is resumed with all chains at one iteration, but files can only be replaced one by one. So all new checkpoints
//! are first written beside the valid ones. Only when all are on the disk does each take its place. If the process dies
//! during that, some new checkpoints are in place, and the others are beside the old ones: [`read_all`] finishes the
//! replacement.

use crate::codec::{self, FrameError, FrameProblem, Frames, Kind};
use crate::disk::{Disk, MANY, for_each};
use crate::error::{RunFileError, RunFileProblem};
use crate::folder::Folder;
use crate::{Draw, Outcome};
use plaus_mcmc::Snapshot;
use serde::{Deserialize, Serialize};
use std::fs::File;
use std::io::ErrorKind;
use std::ops::Range;
use std::path::{Path, PathBuf};

const KIND: Kind = Kind::new(*b"chkp", 7, "a checkpoint of a chain");

/// The state from which a chain can continue.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct Checkpoint {
    /// The run: see the records.
    pub run: u64,
    /// The chain.
    pub chain: u32,
    /// Length of the chain's records, in bytes, at this checkpoint: anything after it is not valid.
    pub records: u64,
    /// Everything that determines the chain's future.
    pub snapshot: Snapshot<Draw, Outcome>,
}

impl Checkpoint {
    /// Reads a chain's checkpoint; `None` if it has none yet.
    ///
    /// # Errors
    /// [`RunFileError`] if it is damaged or belongs elsewhere.
    pub(crate) fn read(path: &Path, run: u64, chain: u32) -> Result<Option<Self>, RunFileError> {
        let file = match File::open(path) {
            Err(error) if error.kind() == ErrorKind::NotFound => return Ok(None),
            file => file.map_err(RunFileError::io(path, "read"))?,
        };
        let found: Self = codec::decode_file(KIND, file)
            .map_err(|source| RunFileError::new(path, RunFileProblem::Checkpoint { source }))?;
        let mixed = |what: String| RunFileError::new(path, RunFileProblem::Mixed(what));
        if found.run != run {
            return Err(mixed("this checkpoint belongs to another run".into()));
        }
        if found.chain != chain {
            return Err(mixed(format!("this checkpoint belongs to chain {}", found.chain)));
        }
        if found.snapshot.end_iteration == 0 {
            return Err(mixed("this checkpoint covers no iteration".into()));
        }
        Ok(Some(found))
    }
}

/// The beginning of a stored checkpoint: run, chain, bytes of records, and one past the last iteration.
type Head = (u64, u32, u64, u64);

/// A chain's checkpoint in stored form; only its beginning is read.
pub(crate) struct Stored {
    /// Length of the chain's records, in bytes.
    pub(crate) records: u64,
    /// One past the last iteration.
    pub(crate) end_iteration: u64,
    /// The file.
    pub(crate) bytes: Vec<u8>,
}

impl Stored {
    /// Reads a chain's checkpoint; `None` if it has none yet.
    ///
    /// # Errors
    /// [`RunFileError`] if it is damaged or belongs elsewhere.
    pub(crate) fn read(path: &Path, run: u64, chain: u32) -> Result<Option<Self>, RunFileError> {
        let bytes = match std::fs::read(path) {
            Err(error) if error.kind() == ErrorKind::NotFound => return Ok(None),
            bytes => bytes.map_err(RunFileError::io(path, "read"))?,
        };
        let damage = |source| RunFileError::new(path, RunFileProblem::Checkpoint { source });
        let length = bytes.len() as u64;
        let mut frames = Frames::<(), _>::new(KIND, bytes.as_slice(), length);
        let truncated = FrameError { offset: 0, problem: FrameProblem::Truncated { needed: 1, present: 0 } };
        let frame = frames.next_raw().unwrap_or(Err(truncated)).map_err(damage)?;
        let whole = frame.len() as u64 == length;
        let head = codec::head::<Head>(KIND, frame);
        let (of, its_chain, records, end_iteration) =
            head.map_err(|problem| damage(FrameError { offset: 0, problem }))?;
        if (of, its_chain, whole) != (run, chain, true) {
            let message = format!("this is not a checkpoint of chain {chain} of this run");
            return Err(RunFileError::new(path, RunFileProblem::Mixed(message)));
        }
        Ok(Some(Self { records, end_iteration, bytes }))
    }
}

/// A checkpoint in stored form.
///
/// # Errors
/// [`RunFileError`] if it is too long.
pub(crate) fn encode(path: &Path, checkpoint: &Checkpoint) -> Result<Vec<u8>, RunFileError> {
    codec::encode(KIND, checkpoint).map_err(|error| RunFileError::new(path, error.into()))
}

/// Replaces the checkpoints of all chains, so that at any moment either all old or all new ones can be read.
///
/// # Errors
/// [`RunFileError`] if the disk refuses; what was valid before then still is.
pub(crate) fn replace(folder: &Folder, disk: &dyn Disk, checkpoints: &[Checkpoint]) -> Result<(), RunFileError> {
    let are_many = checkpoints.len() > MANY;
    let written = for_each(checkpoints, |checkpoint| {
        let path = folder.next_checkpoint(checkpoint.chain);
        let bytes = encode(&path, checkpoint)?;
        let written = if are_many { disk.put(&path, &bytes) } else { disk.write(&path, &bytes) };
        written.map_err(RunFileError::io(&path, "write"))
    });
    let written = written.and_then(|()| {
        let chains = checkpoints.iter().filter(|_| are_many);
        let paths: Vec<PathBuf> = chains.map(|checkpoint| folder.next_checkpoint(checkpoint.chain)).collect();
        disk.sync_within(folder.path(), &paths).map_err(RunFileError::io(folder.path(), "write"))
    });
    let sync = |()| disk.sync(folder.path()).map_err(RunFileError::io(folder.path(), "write"));
    if let Err(error) = written.and_then(sync) {
        for checkpoint in checkpoints {
            let _ = disk.remove(&folder.next_checkpoint(checkpoint.chain)); // frees what it can on a full disk
        }
        return Err(error);
    }
    checkpoints.iter().try_for_each(|checkpoint| promote(folder, disk, checkpoint.chain)).and_then(sync)
}

/// Reads the checkpoints of all chains, all of one iteration, and finishes a replacement that was cut short. Empty if
/// there are none yet.
///
/// # Errors
/// [`RunFileError`] if a checkpoint is damaged, or they do not fit each other.
pub(crate) fn read_all(
    folder: &Folder,
    disk: &dyn Disk,
    run: u64,
    chains: Range<u32>,
) -> Result<Vec<Checkpoint>, RunFileError> {
    let read = |chain| Checkpoint::read(&folder.checkpoint(chain), run, chain);
    let valid: Vec<Option<_>> = chains.clone().map(read).collect::<Result<_, _>>()?;
    let end = |checkpoint: &Checkpoint| checkpoint.snapshot.end_iteration;
    let Some(newest) = valid.iter().flatten().map(end).max() else {
        return clear(folder, disk, chains).map(|()| Vec::new());
    };
    let mut all = Vec::new();
    for (chain, old) in chains.clone().zip(valid) {
        if let Some(checkpoint) = old.filter(|old| end(old) == newest) {
            all.push(checkpoint);
            continue;
        }
        let next = Checkpoint::read(&folder.next_checkpoint(chain), run, chain)?.filter(|next| end(next) == newest);
        all.push(next.ok_or_else(|| {
            let path = folder.checkpoint(chain);
            let problem = match path.exists() {
                true => RunFileProblem::Mixed(format!("other chains have checkpoints of iteration {newest}")),
                false => RunFileProblem::Gone { newest },
            };
            RunFileError::new(path, problem)
        })?);
        promote(folder, disk, chain)?;
    }
    clear(folder, disk, chains)?;
    disk.sync(folder.path()).map_err(RunFileError::io(folder.path(), "write"))?;
    Ok(all)
}

fn promote(folder: &Folder, disk: &dyn Disk, chain: u32) -> Result<(), RunFileError> {
    let path = folder.checkpoint(chain);
    disk.rename(&folder.next_checkpoint(chain), &path).map_err(RunFileError::io(&path, "replace"))
}

/// Removes next checkpoints that never became valid.
fn clear(folder: &Folder, disk: &dyn Disk, chains: Range<u32>) -> Result<(), RunFileError> {
    for path in chains.map(|chain| folder.next_checkpoint(chain)) {
        match disk.remove(&path) {
            Err(error) if error.kind() != ErrorKind::NotFound => return Err(RunFileError::io(&path, "remove")(error)),
            _ => {}
        }
    }
    Ok(())
}

//! Checkpoints: where all chains of a run can continue from, in one file, which is replaced in one step.
//!
//! The file has a frame for each chain, in order; before the first checkpoint, one that says so.

use crate::codec::{self, FrameError, FrameProblem, Frames, Kind};
use crate::disk::Disk;
use crate::error::{RunFileError, RunFileProblem};
use crate::folder::{Folder, no_checkpoints};
use crate::{Draw, Outcome};
use plaus_mcmc::Snapshot;
use serde::{Deserialize, Serialize};
use std::fs::File;
use std::io::ErrorKind;
use std::ops::Range;

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

/// The beginning of a stored checkpoint: run, chain, bytes of records, and one past the last iteration.
type Head = (u64, u32, u64, u64);

/// A chain's checkpoint in stored form, of which only the beginning is read.
#[derive(Debug, Clone)]
pub(crate) struct Stored {
    pub(crate) chain: u32,
    /// Length of the chain's records, in bytes.
    pub(crate) records: u64,
    /// One past the last iteration.
    pub(crate) end_iteration: u64,
    /// Its frame.
    pub(crate) frame: Vec<u8>,
}

/// The file of a run whose chains are `chains`, frame by frame. Empty if there is no checkpoint yet.
///
/// # Errors
/// [`RunFileError`] if it is missing or damaged, belongs elsewhere, or its chains are not all at one iteration.
pub(crate) fn stored(folder: &Folder, run: u64, chains: Range<u32>) -> Result<Vec<Stored>, RunFileError> {
    let whole = |frame: &[u8]| Ok(frame.to_vec());
    let frames = each(folder, run, chains, whole)?;
    let stored = |((_, chain, records, end_iteration), frame)| Stored { chain, records, end_iteration, frame };
    Ok(frames.into_iter().map(stored).collect())
}

/// The checkpoints of all chains. Empty if there are none yet.
///
/// # Errors
/// As [`stored`].
pub(crate) fn read_all(folder: &Folder, run: u64, chains: Range<u32>) -> Result<Vec<Checkpoint>, RunFileError> {
    let read = |frame: &[u8]| codec::decode::<Checkpoint>(KIND, frame).map_err(|error| error.problem);
    Ok(each(folder, run, chains, read)?.into_iter().map(|(_, checkpoint)| checkpoint).collect())
}

/// Reads the file, and gives what `read` makes of each frame, with the frame's beginning.
fn each<T>(
    folder: &Folder,
    run: u64,
    chains: Range<u32>,
    read: impl Fn(&[u8]) -> Result<T, FrameProblem>,
) -> Result<Vec<(Head, T)>, RunFileError> {
    let path = folder.checkpoints();
    let file = File::open(&path).map_err(|error| match error.kind() {
        ErrorKind::NotFound => RunFileError::new(&path, RunFileProblem::Gone),
        _ => RunFileError::io(&path, "read")(error),
    })?;
    let length = file.metadata().map_err(RunFileError::io(&path, "read"))?.len();
    let damaged = |offset, problem| {
        let source = FrameError { offset, problem };
        RunFileError::new(&path, RunFileProblem::Checkpoint { source })
    };
    let mixed = |what: String| RunFileError::new(&path, RunFileProblem::Mixed(what));
    let none = no_checkpoints();
    if length == none.len() as u64 && std::fs::read(&path).is_ok_and(|bytes| bytes == none) {
        return Ok(Vec::new());
    }
    let (mut frames, mut found) = (Frames::<(), _>::new(KIND, file, length), Vec::<(Head, T)>::new());
    for expected in chains.clone() {
        let offset = frames.offset();
        let held = || format!("it holds {} of {} checkpoints", expected - chains.start, chains.len());
        let Some(frame) = frames.next_raw() else { return Err(mixed(held())) };
        let frame = frame.map_err(|error| damaged(error.offset, error.problem))?;
        let head = codec::head::<Head>(KIND, frame).map_err(|problem| damaged(offset, problem))?;
        if head.0 != run {
            return Err(mixed(format!("the checkpoint at byte {offset} belongs to another run")));
        }
        if head.1 != expected {
            return Err(mixed(format!("the checkpoint at byte {offset} is of chain {}, not {expected}", head.1)));
        }
        let first = found.first().map_or(head.3, |(first, _)| first.3);
        if head.3 == 0 || first != head.3 {
            let end = head.3;
            return Err(mixed(format!(
                "the checkpoint of chain {expected} is of iteration {end}, the first of {first}"
            )));
        }
        found.push((head, read(frame).map_err(|problem| damaged(offset, problem))?));
    }
    if frames.offset() < length {
        return Err(mixed(format!("it holds more than {} checkpoints", chains.len())));
    }
    Ok(found)
}

/// Checkpoints in stored form.
///
/// # Errors
/// [`RunFileError`] if one is too long.
pub(crate) fn encode(folder: &Folder, checkpoints: &[Checkpoint]) -> Result<Vec<u8>, RunFileError> {
    let mut bytes = Vec::new();
    for checkpoint in checkpoints {
        let added = codec::append(KIND, checkpoint, &mut bytes);
        added.map_err(|error| RunFileError::new(folder.checkpoints(), error.into()))?;
    }
    Ok(bytes)
}

/// Replaces the checkpoints of all chains in one step.
///
/// # Errors
/// [`RunFileError`] if the disk refuses; what was valid before then still is.
pub(crate) fn replace(folder: &Folder, disk: &dyn Disk, checkpoints: &[Checkpoint]) -> Result<(), RunFileError> {
    let (path, next) = (folder.checkpoints(), folder.next_checkpoints());
    let bytes = encode(folder, checkpoints)?;
    if let Err(error) = disk.write(&next, &bytes) {
        let _ = disk.remove(&next); // frees what it can on a full disk
        return Err(RunFileError::io(&next, "write")(error));
    }
    disk.rename(&next, &path).map_err(RunFileError::io(&path, "replace"))?;
    disk.sync(folder.path()).map_err(RunFileError::io(folder.path(), "write"))
}

/// Removes a file that never became valid.
///
/// # Errors
/// [`RunFileError`] if the disk refuses.
pub(crate) fn clear(folder: &Folder, disk: &dyn Disk) -> Result<(), RunFileError> {
    let path = folder.next_checkpoints();
    match disk.remove(&path) {
        Err(error) if error.kind() != ErrorKind::NotFound => Err(RunFileError::io(&path, "remove")(error)),
        _ => Ok(()),
    }
}

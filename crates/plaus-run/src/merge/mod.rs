//! Makes the run that one machine would have made, from pieces that several made.
//!
//! A chain's records and checkpoint have the same bytes in a piece and in the whole, so they are copied, with each
//! frame's checksum verified; memory holds no more than a checkpoint of each chain. Pieces that look for distinct
//! solutions are cut where the run ends: see `hunt`.

mod hunt;
mod pieces;

use crate::checkpoint::Stored;
use crate::disk::Disk;
use crate::error::{Error, RunFileError, RunFileProblem};
use crate::folder::Folder;
use crate::records::{self, Extent};
pub use pieces::folders_at;
use pieces::{Piece, Pieces};
use rayon::prelude::*;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering::Relaxed};

/// How far a merge is, for other threads, and a request to stop it.
#[derive(Debug, Default)]
pub struct MergePulse {
    pieces: AtomicU64,
    bytes: AtomicU64,
    written: AtomicU64,
    stopped: AtomicBool,
}

impl MergePulse {
    /// Number of pieces found.
    pub fn pieces(&self) -> u64 {
        self.pieces.load(Relaxed)
    }

    /// Bytes of records to copy, and those already copied.
    pub fn bytes(&self) -> (u64, u64) {
        (self.bytes.load(Relaxed), self.written.load(Relaxed))
    }

    /// Asks the merge to give up. It then leaves nothing behind.
    pub fn stop(&self) {
        self.stopped.store(true, Relaxed);
    }

    fn go_on(&self) -> Result<(), Error> {
        if self.stopped.load(Relaxed) {
            return Err(Error::Request("interrupted: nothing was made, and the pieces are unchanged".to_owned()));
        }
        Ok(())
    }
}

/// How to merge.
pub struct Merging<'a> {
    /// Threads; 0 means one per core. Never changes results.
    pub threads: usize,
    /// Where to write.
    pub disk: &'a dyn Disk,
    /// Shows progress to others, who may stop it.
    pub pulse: &'a MergePulse,
}

/// What was merged.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Merged {
    /// Pieces.
    pub pieces: usize,
    /// Chains.
    pub chains: u32,
    /// Bytes of records.
    pub bytes: u64,
}

/// Makes the run `out` from pieces: each path is a piece, or a folder of pieces. The pieces do not change.
///
/// # Errors
///
/// [`Error`], naming the piece, if one is missing, there twice, unfinished, damaged, being written, or of another run;
/// if `out` exists; or if the disk refuses. In these cases nothing is made.
pub fn merge(paths: &[PathBuf], out: &Folder, merging: Merging<'_>) -> Result<Merged, Error> {
    out.refuse_to_replace()?;
    let pool = rayon::ThreadPoolBuilder::new().num_threads(merging.threads).build();
    let pool = pool.map_err(|error| Error::Sampling(format!("cannot start worker threads: {error}")))?;
    let pieces = pool.install(|| Pieces::find(paths, &merging))?;
    let bytes = match hunt::end(&pieces, &pool)? {
        Some(last) => hunt::merge(&pieces, last, out, &merging, &pool)?,
        None => pool.install(|| copy(&pieces, out, &merging))?,
    };
    Ok(Merged { pieces: pieces.all.len(), chains: pieces.manifest.plan.chains, bytes })
}

/// Puts finished pieces side by side; gives the number of bytes of records.
fn copy(pieces: &Pieces, out: &Folder, merging: &Merging<'_>) -> Result<u64, Error> {
    let (end, pulse) = (pieces.manifest.plan.end(), merging.pulse);
    let found = pieces.all.par_iter().map(|piece| Ok((piece, pieces.finished(piece, end)?)));
    let found = found.collect::<Result<Vec<(&Piece, Vec<Stored>)>, Error>>()?;
    let chains: Vec<(&Piece, &Stored)> =
        found.iter().flat_map(|(piece, stored)| stored.iter().map(|one| (*piece, one))).collect();
    let total = chains.iter().map(|(_, one)| one.records).sum();
    pulse.bytes.store(total, Relaxed);
    out.make(merging.disk, |draft| -> Result<(), Error> {
        chains.par_iter().try_for_each(|&(piece, one)| {
            pulse.go_on()?;
            copy_chain(pieces, piece, one.chain, (one.records, one.end_iteration), draft, merging)
        })?;
        // Waits for all files at once: there may be many chains.
        let files: Vec<PathBuf> = chains.iter().map(|(_, one)| draft.records(one.chain)).collect();
        let synced = merging.disk.sync_within(draft.path(), &files);
        synced.map_err(RunFileError::io(draft.path(), "write"))?;
        let checkpoints: Vec<u8> = chains.iter().flat_map(|(_, one)| one.frame.iter().copied()).collect();
        seal(pieces, draft, &checkpoints, merging.disk)
    })?;
    Ok(total)
}

/// Copies the first bytes of a chain's records, which end at that iteration.
fn copy_chain(
    pieces: &Pieces,
    piece: &Piece,
    chain: u32,
    (bytes, end_iteration): (u64, u64),
    draft: &Folder,
    merging: &Merging<'_>,
) -> Result<(), Error> {
    let (from, to) = (piece.folder.records(chain), draft.records(chain));
    let extent = Extent { run: pieces.run, chain, thin: pieces.manifest.plan.thin, bytes, end_iteration };
    records::copy(&from, extent, |frames| {
        merging.disk.append(&to, frames).map_err(RunFileError::io(&to, "write"))?;
        merging.pulse.written.fetch_add(frames.len() as u64, Relaxed);
        merging.pulse.go_on()
    })
}

/// Writes checkpoints and manifest, which make the folder a run.
fn seal(pieces: &Pieces, draft: &Folder, checkpoints: &[u8], disk: &dyn Disk) -> Result<(), Error> {
    let json = pieces.manifest.to_json().map_err(|problem| RunFileError::new(draft.manifest(), problem))?;
    Ok(draft.fill(disk, &json, &pieces.manifest.contents, checkpoints)?)
}

/// The error for a piece that is not part of the run.
fn refuse(piece: &Folder, what: String) -> Error {
    RunFileError::new(piece.path(), RunFileProblem::Pieces(what)).into()
}

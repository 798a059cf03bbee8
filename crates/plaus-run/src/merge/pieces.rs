//! Which pieces exist, and whether they make a whole.

use super::{Merging, refuse};
use crate::checkpoint::{self, Stored};
use crate::error::{Error, RunFileError, RunFileProblem};
use crate::folder::Folder;
use crate::manifest::Manifest;
use crate::sample::is_undecided;
use crate::shard::Shard;
use rayon::prelude::*;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::atomic::Ordering::Relaxed;

/// A piece on the disk.
pub(super) struct Piece {
    pub(super) folder: Folder,
    pub(super) chains: Range<u32>,
    shard: Option<Shard>,
}

/// Pieces that hold each chain of a run once.
pub(super) struct Pieces {
    /// The manifest of the whole run.
    pub(super) manifest: Manifest,
    /// The number that its files carry.
    pub(super) run: u64,
    /// The pieces in order of their chains.
    pub(super) all: Vec<Piece>,
}

impl Pieces {
    /// Looks for the pieces at `paths`, each of which is a piece or a folder of pieces.
    pub(super) fn find(paths: &[PathBuf], merging: &Merging<'_>) -> Result<Self, Error> {
        let mut folders = Vec::new();
        for path in paths {
            folders.extend(folders_at(path)?);
        }
        let Some(first) = folders.first() else {
            return Err(Error::Request("there are no pieces to merge".to_owned()));
        };
        merging.pulse.pieces.store(folders.len() as u64, Relaxed);
        let manifest = Manifest { shard: None, ..Manifest::read(first)? };
        manifest.scenario()?; // later code trusts its plan
        let read = |folder: &Folder| read(folder, first, &manifest);
        let mut all = folders.par_iter().map(read).collect::<Result<Vec<Piece>, Error>>()?;
        all.sort_by(|a, b| (a.chains.start, a.folder.path()).cmp(&(b.chains.start, b.folder.path())));
        make_a_whole(&all, manifest.plan.chains)?;
        Ok(Self { run: manifest.run_id(), manifest, all })
    }

    /// The checkpoints of a piece, as they are stored.
    pub(super) fn checkpoints(&self, piece: &Piece) -> Result<Vec<Stored>, Error> {
        Ok(checkpoint::stored(&piece.folder, self.run, piece.chains.clone())?)
    }

    /// The same, where the piece must have done the iterations `0 .. end`.
    pub(super) fn finished(&self, piece: &Piece, end: u64) -> Result<Vec<Stored>, Error> {
        let stored = self.checkpoints(piece)?;
        let done = stored.first().map_or(0, |one| one.end_iteration);
        if done == end { Ok(stored) } else { Err(self.unfinished(piece, done, end)) }
    }

    /// The error for a piece that has to be continued.
    pub(super) fn unfinished(&self, piece: &Piece, done: u64, end: u64) -> Error {
        let what = format!(
            "{} has done {done} of {end} iterations: continue it with `plaus resume`",
            piece.shard.map_or("the run".to_owned(), |shard| format!("piece {shard}"))
        );
        refuse(&piece.folder, what)
    }
}

/// The runs at a path: itself, or those in it, in order of their names.
///
/// # Errors
/// [`Error`] if the path is a folder that is no run and holds none.
pub fn folders_at(path: &Path) -> Result<Vec<Folder>, Error> {
    let folder = Folder::new(path);
    if folder.manifest().exists() || !path.is_dir() {
        return Ok(vec![folder]); // reading the manifest fails if it is not a run
    }
    let mut found = Vec::new();
    for entry in std::fs::read_dir(path).map_err(RunFileError::io(path, "read"))? {
        let entry = entry.map_err(RunFileError::io(path, "read"))?;
        let hidden = entry.file_name().to_string_lossy().starts_with('.');
        let folder = Folder::new(entry.path());
        if !hidden && folder.manifest().exists() {
            found.push(folder);
        }
    }
    if found.is_empty() {
        let what = "is not a piece of a run and holds none: there is no manifest.json in it or in its folders";
        return Err(refuse(&folder, what.to_owned()));
    }
    found.sort_by(|a, b| a.path().cmp(b.path()));
    Ok(found)
}

/// Reads what a piece is, and compares it with the run of the first piece.
fn read(folder: &Folder, first: &Folder, whole: &Manifest) -> Result<Piece, Error> {
    let manifest = Manifest::read(folder)?;
    if is_undecided(&manifest, &manifest.scenario()?) {
        let shown = manifest.shard.map_or("the run".to_owned(), |shard| format!("piece {shard}"));
        return Err(refuse(folder, format!("{shown} has not begun: continue it with `plaus resume`")));
    }
    if let Some(difference) = (Manifest { shard: None, ..manifest.clone() }).differs_from(whole) {
        let what = format!("does not belong to the same run as {}: {difference}", first.path().display());
        return Err(refuse(folder, what));
    }
    if folder.is_being_written() {
        return Err(RunFileError::new(folder.path(), RunFileProblem::Locked).into());
    }
    let shard = manifest.shard;
    if let Some(shard) = shard {
        shard.range(manifest.plan.chains).map_err(|error| refuse(folder, error.to_string()))?;
    }
    Ok(Piece { folder: folder.clone(), chains: manifest.chains(), shard })
}

/// Whether pieces, in order of their chains, hold each of `chains` once.
fn make_a_whole(pieces: &[Piece], chains: u32) -> Result<(), Error> {
    let mut next = 0;
    for (index, piece) in pieces.iter().enumerate() {
        let Range { start, end } = piece.chains;
        if let Some(before) = index.checked_sub(1).map(|index| &pieces[index]).filter(|_| start < next) {
            let shown = piece.shard.map_or("the whole run".to_owned(), |shard| format!("piece {shard}"));
            let what = format!("is {shown}: its chain {start} is also in {}", before.folder.path().display());
            return Err(refuse(&piece.folder, what));
        }
        missing(pieces, next..start, chains)?;
        next = end;
    }
    missing(pieces, next..chains, chains)
}

/// Says which piece is missing, if any chains are.
fn missing(pieces: &[Piece], chains: Range<u32>, total: u32) -> Result<(), Error> {
    if chains.is_empty() {
        return Ok(());
    }
    // If all pieces were cut from the same number, the missing ones have names.
    let of = pieces[0].shard.map(Shard::of).filter(|of| pieces.iter().all(|p| p.shard.map(Shard::of) == Some(*of)));
    let inside =
        |shard: &Shard| shard.range(total).is_ok_and(|range| range.start >= chains.start && range.end <= chains.end);
    let names: Vec<String> =
        of.map(|of| Shard::all(of).filter(inside).take(8).map(|shard| shard.to_string()).collect()).unwrap_or_default();
    let which = match names.as_slice() {
        [] => "a piece is missing".to_owned(),
        [one] => format!("piece {one} is missing"),
        some => format!("pieces {} are missing", some.join(", ")),
    };
    let held = match chains.len() {
        1 => format!("chain {}", chains.start),
        _ => format!("chains {} to {}", chains.start, chains.end - 1),
    };
    Err(Error::Request(format!("{which}: none of the {} pieces found has {held}", pieces.len())))
}

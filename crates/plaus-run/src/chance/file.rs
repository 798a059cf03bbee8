//! The file of a chance: JSON, replaced as a whole, with a checksum.

use super::Chance;
use crate::disk::Disk;
use crate::error::{Error, RunFileError, RunFileProblem};
use crate::folder::parent_of;
use crate::shard::Shard;
use serde::{Deserialize, Serialize};
use std::fs::File;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

/// Version of the format.
const FORMAT: u32 = 1;
/// Longest file that is read, in bytes.
const LONGEST: u64 = 256 << 20;

/// The file: the chance, between a version, which is checked first, and a checksum.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Envelope {
    format: u32,
    chance: Chance,
    checksum: String,
}

#[derive(Deserialize)]
struct Probe {
    format: u32,
}

fn broken(path: &Path, why: impl std::fmt::Display) -> Error {
    let message = format!("{}: not an estimate of a chance, or changed since: {why}", path.display());
    Error::Request(message)
}

fn checksum(chance: &Chance) -> Result<String, serde_json::Error> {
    Ok(blake3::hash(&serde_json::to_vec(chance)?).to_hex().to_string())
}

/// Puts the file in place of an older one.
pub(super) fn write(path: &Path, disk: &dyn Disk, chance: &Chance) -> Result<(), Error> {
    let checksum = checksum(chance).map_err(|error| broken(path, error))?;
    let envelope = Envelope { format: FORMAT, chance: chance.clone(), checksum };
    let mut json = serde_json::to_vec_pretty(&envelope).map_err(|error| broken(path, error))?;
    json.push(b'\n');
    let next = beside(path, "next");
    let written = disk.write(&next, &json).and_then(|()| disk.rename(&next, path));
    written.map_err(RunFileError::io(path, "write"))?;
    Ok(())
}

/// Reads a file; `None` if there is none.
///
/// # Errors
/// [`Error`] if the file is of another kind, or damaged.
pub fn read(path: &Path) -> Result<Option<Chance>, Error> {
    let length = match std::fs::metadata(path) {
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(None),
        metadata => metadata.map_err(RunFileError::io(path, "read"))?.len(),
    };
    if length > LONGEST {
        return Err(broken(path, "it is too long"));
    }
    let json = std::fs::read(path).map_err(RunFileError::io(path, "read"))?;
    let Probe { format } = serde_json::from_slice(&json).map_err(|error| broken(path, error))?;
    if format != FORMAT {
        return Err(broken(path, format!("it has format {format}, but this plaus reads format {FORMAT}")));
    }
    let Envelope { chance, checksum: stored, .. } =
        serde_json::from_slice(&json).map_err(|error| broken(path, error))?;
    if checksum(&chance).map_err(|error| broken(path, error))? != stored {
        return Err(broken(path, "its checksum does not match"));
    }
    Ok(Some(chance))
}

/// The same question without answers, for all batches.
fn question(chance: &Chance) -> Chance {
    let (counted, split, stones, weighted) = Default::default();
    Chance { shard: None, counted, split, stones, weighted, ..chance.clone() }
}

/// How two questions differ, if they do.
fn difference(found: &Chance, wanted: &Chance) -> Option<String> {
    if question(found) == question(wanted) {
        return None;
    }
    Some(if found.plaus != wanted.plaus {
        format!("it was made by plaus {}, not {}", found.plaus, wanted.plaus)
    } else if found.asking.seed != wanted.asking.seed {
        // The scenario's own seed may be the one that differs.
        "it has another seed".to_owned()
    } else if found.scenario.hash != wanted.scenario.hash {
        "it is for another scenario".to_owned()
    } else if found.asking != wanted.asking {
        "it has other batches".to_owned()
    } else {
        "it uses other methods".to_owned()
    })
}

/// A hidden file beside the one at `path`.
fn beside(path: &Path, what: &str) -> PathBuf {
    let name = path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
    parent_of(path).join(format!(".{name}.{what}"))
}

/// Always empty; the process that writes the file at `path` holds a lock on it.
fn lock_of(path: &Path) -> PathBuf {
    beside(path, "lock")
}

/// Claims the file at `path` for writing, until the returned file is dropped or the process ends.
pub(super) fn claim(path: &Path) -> Result<File, Error> {
    let folder = parent_of(path);
    std::fs::create_dir_all(&folder).map_err(RunFileError::io(&folder, "make the folder"))?;
    Ok(crate::folder::claim(&lock_of(path), path)?)
}

/// Whether another process is writing the file at `path` now, as far as is known.
#[must_use]
pub fn is_being_written(path: &Path) -> bool {
    crate::folder::is_claimed(&lock_of(path))
}

/// What the file already holds of the question in `begun`. The methods of `begun` may be unknown; then the file's
/// methods are used.
pub(super) fn go_on(path: &Path, mut begun: Chance, knows_methods: bool) -> Result<Chance, Error> {
    let Some(found) = read(path)? else { return Ok(begun) };
    if !knows_methods {
        begun.methods.clone_from(&found.methods);
        begun.why.clone_from(&found.why);
    }
    let other = difference(&found, &begun);
    let other = other.or_else(|| (found.shard != begun.shard).then(|| "it has other batches".to_owned()));
    match other {
        Some(difference) => Err(RunFileError::new(path, RunFileProblem::OtherRun(difference)).into()),
        None => Ok(found),
    }
}

/// The files at these paths, each of which is a file or a folder of files; `None` if one of them is neither, such as a
/// run.
///
/// # Errors
/// [`Error`] if a folder cannot be read.
pub fn files_at(paths: &[PathBuf]) -> Result<Option<Vec<PathBuf>>, Error> {
    let mut found = Vec::new();
    for path in paths {
        if path.is_file() {
            found.push(path.clone());
            continue;
        }
        if !path.is_dir() || path.join("manifest.json").exists() {
            return Ok(None);
        }
        let mut within = Vec::new();
        for entry in std::fs::read_dir(path).map_err(RunFileError::io(path, "read"))? {
            let entry = entry.map_err(RunFileError::io(path, "read"))?;
            if !entry.file_name().to_string_lossy().starts_with('.') {
                within.push(entry.path());
            }
        }
        if within.is_empty() || !within.iter().all(|file| file.is_file()) {
            return Ok(None);
        }
        within.sort();
        found.extend(within);
    }
    Ok(Some(found))
}

/// Merges pieces into `out`, byte for byte what one machine would have written.
///
/// # Errors
///
/// [`Error`], naming the piece, if one is unfinished, being written, missing, there twice, or for another question; or
/// if `out` exists.
pub fn merge(pieces: &[PathBuf], out: &Path, disk: &dyn Disk) -> Result<Chance, Error> {
    if std::fs::symlink_metadata(out).is_ok() {
        return Err(RunFileError::new(out, RunFileProblem::Exists).into());
    }
    let (mut whole, mut there): (Option<Chance>, Vec<Option<Shard>>) = (None, Vec::new());
    let pieces: Vec<(&PathBuf, Chance)> =
        pieces.iter().map(|path| Ok((path, finished(path)?))).collect::<Result<_, Error>>()?;
    // The question of most pieces: one that asks another does not belong to them, be it the first.
    let alike = |of: &Chance| pieces.iter().filter(|(_, piece)| difference(piece, of).is_none()).count();
    let usual = pieces.iter().rev().max_by_key(|(_, piece)| alike(piece)).map(|(_, piece)| question(piece));
    for (path, piece) in &pieces {
        let difference = usual.as_ref().and_then(|usual| difference(piece, usual));
        if let Some(difference) = difference {
            return Err(refuse(path, format!("does not belong to the other pieces: {difference}")));
        }
    }
    for (path, piece) in pieces {
        let all = whole.get_or_insert_with(|| question(&piece));
        let twice = piece.batches().find(|batch| {
            all.counted.contains_key(batch)
                || all.split.contains_key(batch)
                || all.stones.contains_key(batch)
                || all.weighted.contains_key(batch)
        });
        if let Some(twice) = twice {
            let shown = piece.shard.map_or("all of it".to_owned(), |shard| format!("piece {shard}"));
            return Err(refuse(path, format!("is {shown}: batch {twice} is in two pieces")));
        }
        there.push(piece.shard);
        all.counted.extend(piece.counted);
        all.split.extend(piece.split);
        all.stones.extend(piece.stones);
        all.weighted.extend(piece.weighted);
    }
    let Some(whole) = whole else { return Err(Error::Request("there are no pieces to merge".to_owned())) };
    if let Some(&(_, batch)) = whole.missing().first() {
        return Err(Error::Request(format!("{}: batch {batch} is in none of them", missing(&there, batch, &whole))));
    }
    let folder = parent_of(out);
    std::fs::create_dir_all(&folder).map_err(RunFileError::io(&folder, "make the folder"))?;
    write(out, disk, &whole)?;
    Ok(whole)
}

fn refuse(path: &Path, what: String) -> Error {
    RunFileError::new(path, RunFileProblem::Pieces(what)).into()
}

/// A piece with all its batches.
fn finished(path: &Path) -> Result<Chance, Error> {
    let Some(piece) = read(path)? else { return Err(refuse(path, "there is no such file".to_owned())) };
    if is_being_written(path) {
        return Err(RunFileError::new(path, RunFileProblem::Locked).into());
    }
    let (done, due) = piece.done();
    if done < due {
        return Err(refuse(
            path,
            format!("only {done} of its {due} batches are made: run the same command again to continue"),
        ));
    }
    Ok(piece)
}

/// Says which piece is missing, by its name if all were cut into equally many.
fn missing(there: &[Option<Shard>], batch: u32, whole: &Chance) -> String {
    let of = there.first().copied().flatten().map(Shard::of);
    let of = of.filter(|&of| there.iter().all(|shard| shard.is_some_and(|shard| shard.of() == of)));
    let holds = |shard: &Shard| shard.range(whole.asking.batches).is_ok_and(|range| range.contains(&batch));
    let named = of.and_then(|of| Shard::all(of).find(holds));
    named.map_or("a piece is missing".to_owned(), |shard| format!("piece {shard} is missing"))
}

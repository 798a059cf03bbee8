//! The file of an asking: JSON, replaced as a whole, with a checksum.

use super::Chance;
use crate::disk::Disk;
use crate::error::{Error, RunFileError, RunFileProblem};
use serde::{Deserialize, Serialize};
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

/// Version of the format.
const FORMAT: u32 = 1;
/// Longest file that is read, in bytes.
const LONGEST: u64 = 256 << 20;

/// The file: what is asked between a version, which is looked at first, and a checksum.
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
    let message = format!("{}: is no file that `plaus chance --out` wrote, or was changed: {why}", path.display());
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
    let folder = crate::folder::parent_of(path);
    std::fs::create_dir_all(&folder).map_err(RunFileError::io(&folder, "make the folder"))?;
    let next = path.with_extension(format!("{}.next", std::process::id()));
    let written = disk.write(&next, &json).and_then(|()| disk.rename(&next, path));
    written.map_err(RunFileError::io(path, "write"))?;
    Ok(())
}

/// Reads a file; `None` where there is none.
///
/// # Errors
/// [`Error`] where it is no such file, or damaged.
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
        return Err(broken(path, format!("it has format {format}, this plaus reads format {FORMAT}")));
    }
    let Envelope { chance, checksum: stored, .. } =
        serde_json::from_slice(&json).map_err(|error| broken(path, error))?;
    if checksum(&chance).map_err(|error| broken(path, error))? != stored {
        return Err(broken(path, "its checksum does not match"));
    }
    Ok(Some(chance))
}

/// The same asking with nothing answered, of all batches.
fn question(chance: &Chance) -> Chance {
    let (counted, split, stones) = Default::default();
    Chance { shard: None, counted, split, stones, ..chance.clone() }
}

/// How two askings differ, where they do.
fn difference(found: &Chance, wanted: &Chance) -> Option<String> {
    if question(found) == question(wanted) {
        return None;
    }
    Some(if found.plaus != wanted.plaus {
        format!("it was made by plaus {}, not {}", found.plaus, wanted.plaus)
    } else if found.scenario.hash != wanted.scenario.hash {
        "it is of another scenario".to_owned()
    } else if found.asking != wanted.asking {
        "it asks with another seed, or for other batches".to_owned()
    } else {
        "it uses other methods".to_owned()
    })
}

/// What the file holds already of what is to be asked.
pub(super) fn go_on(path: &Path, begun: Chance) -> Result<Chance, Error> {
    let Some(found) = read(path)? else { return Ok(begun) };
    let other = difference(&found, &begun);
    let other = other.or_else(|| (found.shard != begun.shard).then(|| "it is of other batches".to_owned()));
    match other {
        Some(difference) => Err(RunFileError::new(path, RunFileProblem::OtherRun(difference)).into()),
        None => Ok(found),
    }
}

/// Puts pieces together into `out`, byte for byte what one machine would have written.
///
/// # Errors
/// [`Error`] where a piece is unfinished, missing, there twice, or of another asking; or where `out` exists.
pub fn merge(pieces: &[PathBuf], out: &Path, disk: &dyn Disk) -> Result<Chance, Error> {
    if std::fs::symlink_metadata(out).is_ok() {
        return Err(RunFileError::new(out, RunFileProblem::Exists).into());
    }
    let refuse = |path: &Path, what: String| Error::from(RunFileError::new(path, RunFileProblem::Pieces(what)));
    let mut whole: Option<Chance> = None;
    for path in pieces {
        let Some(piece) = read(path)? else { return Err(refuse(path, "there is no such file".to_owned())) };
        let all = whole.get_or_insert_with(|| question(&piece));
        if let Some(difference) = difference(&piece, all) {
            return Err(refuse(path, format!("is no piece of the same: {difference}")));
        }
        let (done, due) = piece.done();
        if done < due {
            return Err(refuse(
                path,
                format!("only {done} of its {due} batches are made: the same command goes on with it"),
            ));
        }
        let numbers = piece.batches();
        let there = |batch: u32| {
            all.counted.contains_key(&batch) || all.split.contains_key(&batch) || all.stones.contains_key(&batch)
        };
        if let Some(twice) = numbers.clone().find(|&batch| there(batch)) {
            return Err(refuse(path, format!("batch {twice} is there twice")));
        }
        all.counted.extend(piece.counted);
        all.split.extend(piece.split);
        all.stones.extend(piece.stones);
    }
    let Some(whole) = whole else { return Err(Error::Request("there are no pieces to merge".to_owned())) };
    if let Some((method, batch)) = whole.missing().first() {
        let message = format!("batch {batch} of {method:?} is in none of the pieces");
        return Err(refuse(out, message));
    }
    write(out, disk, &whole)?;
    Ok(whole)
}

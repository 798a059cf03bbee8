//! Where the files of a run lie, and who may write them.

use crate::codec::{self, Kind};
use crate::disk::Disk;
use crate::error::{RunFileError, RunFileProblem};
use plaus_scenes::files::{Assets, hash_of};
use std::fs::{self, File, TryLockError};
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};

const NONE: Kind = Kind::new(*b"none", 1, "no checkpoint yet");

/// The file of checkpoints of a run that has none yet.
pub(crate) fn no_checkpoints() -> Vec<u8> {
    codec::encode(NONE, &()).unwrap_or_default()
}

/// The files of one run.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Folder {
    path: PathBuf,
    replaces: bool,
}

impl Folder {
    /// The run at `path`.
    pub fn new(path: impl Into<PathBuf>) -> Self {
        // Without a slash at the end, which a shell completes: what is named after the run lies beside it.
        Self { path: path.into().components().collect(), replaces: false }
    }

    /// The same, where a new run takes the place of one that is there already.
    #[must_use]
    pub fn replacing(self) -> Self {
        Self { replaces: true, ..self }
    }

    /// The folder itself.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// What the run is: scenario, seed, plan.
    #[must_use]
    pub fn manifest(&self) -> PathBuf {
        self.path.join("manifest.json")
    }

    /// The manifest's file, opened.
    ///
    /// # Errors
    /// [`RunFileError`] that says whether the folder is missing, or is not a run.
    pub(crate) fn open_manifest(&self) -> Result<File, RunFileError> {
        let path = self.manifest();
        File::open(&path).map_err(|error| match error.kind() {
            ErrorKind::NotFound if self.path.is_dir() => RunFileError::new(&self.path, RunFileProblem::NoRun),
            ErrorKind::NotFound => RunFileError::new(&self.path, RunFileProblem::Missing),
            ErrorKind::NotADirectory => RunFileError::new(&self.path, RunFileProblem::NoRun),
            _ => RunFileError::io(&path, "read")(error),
        })
    }

    /// What a chain has recorded: one frame for each block.
    #[must_use]
    pub fn records(&self, chain: u32) -> PathBuf {
        self.path.join(format!("chain-{chain:05}.records"))
    }

    /// The point from which the chains can continue: one frame for each.
    #[must_use]
    pub fn checkpoints(&self) -> PathBuf {
        self.path.join("checkpoints")
    }

    /// The next checkpoints, written but not yet valid.
    pub(crate) fn next_checkpoints(&self) -> PathBuf {
        self.path.join("checkpoints.next")
    }

    /// Which solutions hold at another accuracy, if that was asked for.
    #[must_use]
    pub fn confirmed(&self) -> PathBuf {
        self.path.join("confirmed.json")
    }

    /// How far a piece is, for observers; nothing that reads the run needs or trusts it.
    #[must_use]
    pub fn progress(&self) -> PathBuf {
        self.path.join("progress.json")
    }

    /// Where a piece that looks for solutions could be cut: one frame for each round.
    pub(crate) fn trail(&self) -> PathBuf {
        self.path.join("trail")
    }

    /// The run's copy of a file that the scenario names, by its hash.
    #[must_use]
    pub fn asset(&self, hash: &str) -> PathBuf {
        self.path.join(format!("asset-{}", hash.get(..16).unwrap_or(hash)))
    }

    /// Always there and always empty; the process that writes the run holds a lock on it.
    #[must_use]
    pub fn lock(&self) -> PathBuf {
        self.path.join("lock")
    }

    /// Makes a run that holds `manifest`, and the files that its scenario names, in one step: it exists wholly or not
    /// at all.
    ///
    /// # Errors
    /// [`RunFileError`] if something of that name exists, or the disk refuses.
    pub fn create(&self, disk: &dyn Disk, manifest: &[u8], assets: &Assets) -> Result<(), RunFileError> {
        let fill = |draft: &Self| draft.fill(disk, manifest, assets, &no_checkpoints());
        self.make(disk, |draft| fill(draft).map_err(|error| RunFileError::new(&self.path, error.problem)))
    }

    /// Makes a run that `fill` fills under another name, in one step: it exists wholly or not at all.
    ///
    /// # Errors
    /// As [`Folder::create`], and as `fill`.
    pub(crate) fn make<E: From<RunFileError>>(
        &self,
        disk: &dyn Disk,
        fill: impl FnOnce(&Self) -> Result<(), E>,
    ) -> Result<(), E> {
        self.refuse_to_replace()?;
        let parent = parent_of(&self.path);
        fs::create_dir_all(&parent).map_err(RunFileError::io(&parent, "make the folder"))?;
        clear_drafts(&self.path);
        let draft = Self::new(draft_of(&self.path));
        // If a draft exists already, it belongs to another process: it must neither be filled nor removed.
        disk.create_folder(&draft.path).map_err(RunFileError::io(&draft.path, "make the folder"))?;
        let made = fill(&draft).and_then(|()| {
            let done = self.put_aside(|| disk.rename(&draft.path, &self.path));
            done.and_then(|()| disk.sync(&parent)).map_err(|error| match error.kind() {
                // Another process was faster.
                ErrorKind::DirectoryNotEmpty | ErrorKind::AlreadyExists => {
                    RunFileError::new(&self.path, RunFileProblem::Taken)
                }
                _ => RunFileError::io(&self.path, "make the run")(error),
            })?;
            Ok(())
        });
        if made.is_err() {
            let _ = fs::remove_dir_all(&draft.path); // best effort: the first error is the one to report
        }
        made
    }

    /// Refuses to overwrite anything but a run that this one replaces.
    ///
    /// # Errors
    /// [`RunFileProblem::Exists`] if something of that name exists; [`RunFileProblem::Foreign`] or
    /// [`RunFileProblem::Locked`] if it is to be replaced, and holds other things than a run, or is being written.
    pub fn refuse_to_replace(&self) -> Result<(), RunFileError> {
        let refuse = |problem| Err(RunFileError::new(&self.path, problem));
        if fs::symlink_metadata(&self.path).is_err() {
            return Ok(());
        }
        match self.replaces {
            false => refuse(RunFileProblem::Exists),
            true if !self.manifest().is_file() || !has_only_files_of_runs(&self.path) => {
                refuse(RunFileProblem::Foreign)
            }
            true if self.is_being_written() => refuse(RunFileProblem::Locked),
            true => Ok(()),
        }
    }

    /// Gives a run the name of this one, in one step: where one is to be replaced, it stays if that fails.
    ///
    /// # Errors
    /// As [`Folder::refuse_to_replace`]; [`RunFileError`] too if the disk refuses.
    pub fn replace_by(&self, run: &Self) -> Result<(), RunFileError> {
        self.refuse_to_replace()?;
        let named = self.put_aside(|| fs::rename(&run.path, &self.path));
        named.map_err(RunFileError::io(&self.path, "rename a run to"))
    }

    /// Removes the run that this one replaces, if there is one.
    ///
    /// # Errors
    /// As [`Folder::replace_by`].
    pub fn remove(&self) -> Result<(), RunFileError> {
        self.refuse_to_replace()?;
        match fs::remove_dir_all(&self.path) {
            Err(error) if error.kind() != ErrorKind::NotFound => Err(RunFileError::io(&self.path, "remove")(error)),
            _ => Ok(()),
        }
    }

    /// Does `make` while a run that stands in its way has another name; removes that run if it succeeds.
    fn put_aside(&self, make: impl FnOnce() -> io::Result<()>) -> io::Result<()> {
        let old = draft_of(&self.path).with_extension("old");
        let stands = self.replaces && self.path.exists();
        if stands {
            fs::rename(&self.path, &old)?;
        }
        let made = make();
        if stands && made.is_ok() {
            fs::remove_dir_all(&old)?;
        } else if stands {
            let _ = fs::rename(&old, &self.path); // best effort: the first error is the one to report
        }
        made
    }

    /// Writes the files that every run has.
    pub(crate) fn fill(
        &self,
        disk: &dyn Disk,
        manifest: &[u8],
        assets: &Assets,
        checkpoints: &[u8],
    ) -> Result<(), RunFileError> {
        let write = |path: PathBuf, bytes: &[u8]| disk.write(&path, bytes).map_err(RunFileError::io(&path, "write"));
        for (_, bytes) in assets.iter() {
            write(self.asset(&hash_of(bytes)), bytes)?;
        }
        write(self.lock(), b"")?;
        write(self.checkpoints(), checkpoints)?;
        write(self.manifest(), manifest)?;
        disk.sync(&self.path).map_err(RunFileError::io(&self.path, "write"))
    }

    /// Claims the run for writing, until the returned file is dropped or the process ends.
    ///
    /// # Errors
    /// [`RunFileProblem::Locked`] if another process writes it.
    pub fn claim(&self) -> Result<File, RunFileError> {
        claim(&self.lock(), &self.path)
    }

    /// Whether another process is writing the run now, as far as is known.
    #[must_use]
    pub fn is_being_written(&self) -> bool {
        is_claimed(&self.lock())
    }
}

/// Claims `what` for writing by a lock on the file `lock`, until the returned file is dropped or the process ends.
pub(crate) fn claim(lock: &Path, what: &Path) -> Result<File, RunFileError> {
    let file = File::options().append(true).create(true).open(lock).map_err(RunFileError::io(lock, "open"))?;
    match file.try_lock() {
        Ok(()) => Ok(file),
        Err(TryLockError::WouldBlock) => Err(RunFileError::new(what, RunFileProblem::Locked)),
        Err(TryLockError::Error(source)) => Err(RunFileError::io(lock, "lock")(source)),
    }
}

/// Whether another process holds a lock on the file `lock`, as far as is known.
pub(crate) fn is_claimed(lock: &Path) -> bool {
    File::open(lock).is_ok_and(|file| matches!(file.try_lock_shared(), Err(TryLockError::WouldBlock)))
}

/// The folder a path lies in.
pub(crate) fn parent_of(path: &Path) -> PathBuf {
    match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent.to_owned(),
        _ => PathBuf::from("."),
    }
}

/// Removes drafts left by processes that were killed while making the run or file `path`, if the system shows which
/// processes exist.
pub(crate) fn clear_drafts(path: &Path) {
    let processes = Path::new("/proc/self");
    let Some(name) = path.file_name().map(|name| name.to_string_lossy().into_owned()) else { return };
    let Ok(beside) = fs::read_dir(parent_of(path)) else { return };
    if !processes.exists() {
        return;
    }
    for entry in beside.flatten() {
        let draft = entry.file_name().to_string_lossy().into_owned();
        let process = draft.strip_prefix(&format!(".{name}.")).and_then(|rest| rest.strip_suffix(".draft"));
        let Some(process) = process.and_then(|text| text.parse::<u32>().ok()) else { continue };
        if Path::new("/proc").join(process.to_string()).exists() {
            continue;
        }
        // Best effort: it does no harm.
        let _ = match entry.path() {
            file if file.is_file() => fs::remove_file(file),
            folder if has_only_files_of_runs(&folder) => fs::remove_dir_all(folder),
            _ => Ok(()),
        };
    }
}

/// Whether a folder holds no other files than those of runs.
fn has_only_files_of_runs(path: &Path) -> bool {
    const NAMES: [&str; 5] = ["lock", "manifest.json", "confirmed.json", "progress.json", "trail"];
    let is_ours = |name: &str| {
        NAMES.contains(&name)
            || name.starts_with("chain-")
            || name.starts_with("asset-")
            || name.starts_with("checkpoints")
            || name.starts_with("progress.")
    };
    fs::read_dir(path)
        .is_ok_and(|mut files| files.all(|file| file.is_ok_and(|file| is_ours(&file.file_name().to_string_lossy()))))
}

/// The name beside `path` under which something is made before it gets its own.
pub(crate) fn draft_of(path: &Path) -> PathBuf {
    let name = path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
    parent_of(path).join(format!(".{name}.{}.draft", std::process::id()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::disk::RealDisk;

    #[test]
    #[cfg(target_os = "linux")]
    fn drafts_of_dead_processes_are_cleared_and_no_others() {
        let place = tempfile::tempdir().unwrap();
        let make = |name: &str, file: &str| {
            fs::create_dir(place.path().join(name)).unwrap();
            fs::write(place.path().join(name).join(file), "").unwrap();
        };
        // Linux never gives a process so large a number.
        make(".run.4194305.draft", "lock");
        make(".run.4194306.draft", "mine.txt");
        make(".other.4194305.draft", "lock");
        make(".run.1.draft", "lock");
        fs::write(place.path().join(".run.4194307.draft"), "").unwrap();
        Folder::new(place.path().join("run")).create(&RealDisk, b"{}", &Assets::default()).unwrap();
        let left = |name: &str| place.path().join(name).exists();
        assert!(!left(".run.4194305.draft") && left(".run.4194306.draft") && left(".other.4194305.draft"));
        assert!(!left(".run.4194307.draft"), "of an export to the same name");
        assert!(left(".run.1.draft") && left("run/manifest.json"));
    }

    #[test]
    fn a_place_that_another_process_took_is_told() {
        let place = tempfile::tempdir().unwrap();
        let folder = Folder::new(place.path().join("run"));
        let taken = folder.make(&RealDisk, |_| -> Result<(), RunFileError> {
            fs::create_dir_all(folder.path().join("theirs")).map_err(RunFileError::io(folder.path(), "take"))
        });
        assert!(matches!(taken.unwrap_err().problem, RunFileProblem::Taken));
        assert_eq!(fs::read_dir(place.path()).unwrap().count(), 1, "the draft is gone");
    }
}

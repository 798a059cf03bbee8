//! Where the files of a run lie, and who may write them.

use crate::disk::Disk;
use crate::error::{RunFileError, RunFileProblem};
use plaus_scenes::files::{Assets, hash_of};
use std::fs::{self, File, TryLockError};
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

/// The files of one run.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Folder(PathBuf);

impl Folder {
    /// The run at `path`.
    pub fn new(path: impl Into<PathBuf>) -> Self {
        // Without a slash at the end, which a shell completes: what is named after the run lies beside it.
        Self(path.into().components().collect())
    }

    /// The folder itself.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.0
    }

    /// What the run is: scenario, seed, plan.
    #[must_use]
    pub fn manifest(&self) -> PathBuf {
        self.0.join("manifest.json")
    }

    /// The manifest's file, opened.
    ///
    /// # Errors
    /// [`RunFileError`] that says whether the folder is missing, or is not a run.
    pub(crate) fn open_manifest(&self) -> Result<File, RunFileError> {
        let path = self.manifest();
        File::open(&path).map_err(|error| match error.kind() {
            ErrorKind::NotFound if self.0.is_dir() => RunFileError::new(&self.0, RunFileProblem::NoRun),
            ErrorKind::NotFound => RunFileError::new(&self.0, RunFileProblem::Missing),
            ErrorKind::NotADirectory => RunFileError::new(&self.0, RunFileProblem::NoRun),
            _ => RunFileError::io(&path, "read")(error),
        })
    }

    /// What a chain has recorded: one frame for each block.
    #[must_use]
    pub fn records(&self, chain: u32) -> PathBuf {
        self.0.join(format!("chain-{chain:05}.records"))
    }

    /// The point from which a chain can continue.
    #[must_use]
    pub fn checkpoint(&self, chain: u32) -> PathBuf {
        self.0.join(format!("chain-{chain:05}.checkpoint"))
    }

    /// A chain's next checkpoint, written but not yet valid.
    pub(crate) fn next_checkpoint(&self, chain: u32) -> PathBuf {
        self.0.join(format!("chain-{chain:05}.checkpoint.next"))
    }

    /// Which solutions hold at another accuracy, if that was asked for.
    #[must_use]
    pub fn confirmed(&self) -> PathBuf {
        self.0.join("confirmed.json")
    }

    /// How far a piece is, for observers; nothing that reads the run needs or trusts it.
    #[must_use]
    pub fn progress(&self) -> PathBuf {
        self.0.join("progress.json")
    }

    /// Where a piece that looks for solutions could be cut: one frame for each round.
    pub(crate) fn trail(&self) -> PathBuf {
        self.0.join("trail")
    }

    /// The run's copy of a file that the scenario names, by its hash.
    #[must_use]
    pub fn asset(&self, hash: &str) -> PathBuf {
        self.0.join(format!("asset-{}", hash.get(..16).unwrap_or(hash)))
    }

    /// Always there and always empty; the process that writes the run holds a lock on it.
    #[must_use]
    pub fn lock(&self) -> PathBuf {
        self.0.join("lock")
    }

    /// Makes a run that holds `manifest`, and the files that its scenario names, in one step: it exists wholly or not
    /// at all.
    ///
    /// # Errors
    /// [`RunFileError`] if something of that name exists, or the disk refuses.
    pub fn create(&self, disk: &dyn Disk, manifest: &[u8], assets: &Assets) -> Result<(), RunFileError> {
        let fill = |draft: &Self| draft.fill(disk, manifest, assets);
        self.make(disk, |draft| fill(draft).map_err(|error| RunFileError::new(&self.0, error.problem)))
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
        let parent = parent_of(&self.0);
        fs::create_dir_all(&parent).map_err(RunFileError::io(&parent, "make the folder"))?;
        clear_drafts(&self.0);
        let draft = Self(draft_of(&self.0));
        // If a draft exists already, it belongs to another process: it must neither be filled nor removed.
        disk.create_folder(&draft.0).map_err(RunFileError::io(&draft.0, "make the folder"))?;
        let made = fill(&draft).and_then(|()| {
            let done = disk.rename(&draft.0, &self.0);
            Ok(done.and_then(|()| disk.sync(&parent)).map_err(RunFileError::io(&self.0, "make the run"))?)
        });
        if made.is_err() {
            let _ = fs::remove_dir_all(&draft.0); // best effort: the first error is the one to report
        }
        made
    }

    /// Refuses to overwrite anything.
    ///
    /// # Errors
    /// [`RunFileProblem::Exists`] if something of that name exists.
    pub(crate) fn refuse_to_replace(&self) -> Result<(), RunFileError> {
        match fs::symlink_metadata(&self.0) {
            Ok(_) => Err(RunFileError::new(&self.0, RunFileProblem::Exists)),
            Err(_) => Ok(()),
        }
    }

    /// Writes the files that every run has.
    pub(crate) fn fill(&self, disk: &dyn Disk, manifest: &[u8], assets: &Assets) -> Result<(), RunFileError> {
        let write = |path: PathBuf, bytes: &[u8]| disk.write(&path, bytes).map_err(RunFileError::io(&path, "write"));
        for (_, bytes) in assets.iter() {
            write(self.asset(&hash_of(bytes)), bytes)?;
        }
        write(self.lock(), b"")?;
        write(self.manifest(), manifest)?;
        disk.sync(&self.0).map_err(RunFileError::io(&self.0, "write"))
    }

    /// Claims the run for writing, until the returned file is dropped or the process ends.
    ///
    /// # Errors
    /// [`RunFileProblem::Locked`] if another process writes it.
    pub fn claim(&self) -> Result<File, RunFileError> {
        claim(&self.lock(), &self.0)
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

/// Removes drafts left by processes that were killed while making the run, if the system shows which processes exist.
fn clear_drafts(path: &Path) {
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
        let ours = |name: &std::ffi::OsStr| {
            let shown = name.to_string_lossy();
            name == "lock" || name == "manifest.json" || shown.starts_with("chain-") || shown.starts_with("asset-")
        };
        let files = fs::read_dir(entry.path()).map(|files| files.flatten().all(|file| ours(&file.file_name())));
        if !Path::new("/proc").join(process.to_string()).exists() && files.unwrap_or(false) {
            let _ = fs::remove_dir_all(entry.path()); // best effort: it does no harm
        }
    }
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
        Folder::new(place.path().join("run")).create(&RealDisk, b"{}", &Assets::default()).unwrap();
        let left = |name: &str| place.path().join(name).exists();
        assert!(!left(".run.4194305.draft") && left(".run.4194306.draft") && left(".other.4194305.draft"));
        assert!(left(".run.1.draft") && left("run/manifest.json"));
    }
}

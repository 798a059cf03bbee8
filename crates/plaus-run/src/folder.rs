//! Where the files of a run lie, and who may write them.

use crate::disk::Disk;
use crate::error::{RunFileError, RunFileProblem};
use std::fs::{self, File, TryLockError};
use std::path::{Path, PathBuf};

/// The files of one run.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Folder(PathBuf);

impl Folder {
    /// The run at `path`.
    pub fn new(path: impl Into<PathBuf>) -> Self {
        Self(path.into())
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

    /// What a chain has recorded: one frame a block.
    #[must_use]
    pub fn records(&self, chain: u32) -> PathBuf {
        self.0.join(format!("chain-{chain:05}.records"))
    }

    /// Where a chain can go on from.
    #[must_use]
    pub fn checkpoint(&self, chain: u32) -> PathBuf {
        self.0.join(format!("chain-{chain:05}.checkpoint"))
    }

    /// A chain's next checkpoint, written but not yet valid.
    pub(crate) fn next_checkpoint(&self, chain: u32) -> PathBuf {
        self.0.join(format!("chain-{chain:05}.checkpoint.next"))
    }

    /// Which solutions hold at another accuracy, where that was asked.
    #[must_use]
    pub fn confirmed(&self) -> PathBuf {
        self.0.join("confirmed.json")
    }

    /// Always there and always empty; whoever writes the run holds a lock on it.
    #[must_use]
    pub fn lock(&self) -> PathBuf {
        self.0.join("lock")
    }

    /// Makes a run that holds `manifest`, in one step: it exists wholly or not at all.
    ///
    /// # Errors
    /// [`RunFileError`] where something of that name exists, or the disk refuses.
    pub fn create(&self, disk: &dyn Disk, manifest: &[u8]) -> Result<(), RunFileError> {
        if fs::symlink_metadata(&self.0).is_ok() {
            return Err(RunFileError::new(&self.0, RunFileProblem::Exists));
        }
        let parent = parent_of(&self.0);
        fs::create_dir_all(&parent).map_err(RunFileError::io(&parent, "make the folder"))?;
        let draft = Self(draft_of(&self.0));
        // A draft that is there already is another process's: not ours to fill, nor to remove.
        disk.create_folder(&draft.0).map_err(RunFileError::io(&draft.0, "make the folder"))?;
        let filled = draft.fill(disk, manifest).map_err(|error| RunFileError::new(&self.0, error.problem));
        let made = filled.and_then(|()| {
            let done = disk.rename(&draft.0, &self.0);
            done.and_then(|()| disk.sync(&parent)).map_err(RunFileError::io(&self.0, "make the run"))
        });
        if made.is_err() {
            let _ = fs::remove_dir_all(&draft.0); // best effort: the first error is the one to report
        }
        made
    }

    fn fill(&self, disk: &dyn Disk, manifest: &[u8]) -> Result<(), RunFileError> {
        for (path, bytes) in [(self.lock(), &b""[..]), (self.manifest(), manifest)] {
            disk.write(&path, bytes).map_err(RunFileError::io(&path, "write"))?;
        }
        disk.sync(&self.0).map_err(RunFileError::io(&self.0, "write"))
    }

    /// Claims the run for writing, until the returned file is dropped or the process ends.
    ///
    /// # Errors
    /// [`RunFileProblem::Locked`] where another process writes it.
    pub fn claim(&self) -> Result<File, RunFileError> {
        let path = self.lock();
        let file = File::options().append(true).create(true).open(&path).map_err(RunFileError::io(&path, "open"))?;
        match file.try_lock() {
            Ok(()) => Ok(file),
            Err(TryLockError::WouldBlock) => Err(RunFileError::new(&self.0, RunFileProblem::Locked)),
            Err(TryLockError::Error(source)) => Err(RunFileError::io(&path, "lock")(source)),
        }
    }

    /// Whether another process is writing the run now, as far as can be told.
    #[must_use]
    pub fn is_being_written(&self) -> bool {
        File::open(self.lock()).is_ok_and(|file| matches!(file.try_lock_shared(), Err(TryLockError::WouldBlock)))
    }
}

/// The folder a path lies in.
pub(crate) fn parent_of(path: &Path) -> PathBuf {
    match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent.to_owned(),
        _ => PathBuf::from("."),
    }
}

/// A name beside `path` under which it is made before it gets its own.
pub(crate) fn draft_of(path: &Path) -> PathBuf {
    let name = path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
    parent_of(path).join(format!(".{name}.{}.draft", std::process::id()))
}

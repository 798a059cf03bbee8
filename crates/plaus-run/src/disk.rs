//! The few file operations with which a run is written, behind a trait, so that tests can fill the disk or stop at any
//! byte.

use crate::error::RunFileError;
use std::fs::{self, File, OpenOptions};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};
use std::thread;

/// The operations that writing a run needs from a disk. Each may fail half done, as real ones do.
pub trait Disk: Sync {
    /// Adds `bytes` at the end of a file, which is created if necessary.
    ///
    /// # Errors
    /// As the operating system says; part of the bytes may have been written.
    fn append(&self, path: &Path, bytes: &[u8]) -> io::Result<()>;

    /// Makes a file that holds exactly `bytes`, in place of any there was, and waits until they are on the disk.
    ///
    /// # Errors
    /// As the operating system says; the file may hold part of the bytes.
    fn write(&self, path: &Path, bytes: &[u8]) -> io::Result<()>;

    /// Waits until everything written to a file, or the names in a folder, are on the disk.
    ///
    /// # Errors
    /// As the operating system says.
    fn sync(&self, path: &Path) -> io::Result<()>;

    /// Waits until everything written to files that lie in `folder` is on the disk.
    ///
    /// # Errors
    /// As the operating system says.
    fn sync_within(&self, folder: &Path, files: &[PathBuf]) -> io::Result<()> {
        let _ = folder;
        files.iter().try_for_each(|file| self.sync(file))
    }

    /// Renames a file or a folder in one step, in place of any file of the new name.
    ///
    /// # Errors
    /// As the operating system says.
    fn rename(&self, from: &Path, to: &Path) -> io::Result<()>;

    /// Cuts a file to its first `length` bytes.
    ///
    /// # Errors
    /// As the operating system says.
    fn truncate(&self, path: &Path, length: u64) -> io::Result<()>;

    /// Removes a file.
    ///
    /// # Errors
    /// As the operating system says.
    fn remove(&self, path: &Path) -> io::Result<()>;

    /// Makes a folder that must not exist.
    ///
    /// # Errors
    /// As the operating system says.
    fn create_folder(&self, path: &Path) -> io::Result<()>;
}

/// If more files than this are waited for, wait for everything written to that disk at once: one file at a time takes
/// milliseconds each. Only Linux can.
pub(crate) const MANY: usize = if cfg!(target_os = "linux") { 64 } else { usize::MAX };

/// Number of files waited for at a time: this many take a disk hardly longer than one.
const AT_A_TIME: usize = 16;

/// Does `work` for each of `items`, several at a time if there are many.
///
/// # Errors
///
/// The error of the first item, in order, whose `work` failed. Items that had not begun by then are skipped.
pub(crate) fn for_each<T: Sync>(
    items: &[T],
    work: impl Fn(&T) -> Result<(), RunFileError> + Sync,
) -> Result<(), RunFileError> {
    if items.len() <= AT_A_TIME {
        return items.iter().try_for_each(work);
    }
    let (next, failed) = (AtomicUsize::new(0), Mutex::new(None::<(usize, RunFileError)>));
    thread::scope(|scope| {
        for _ in 0..AT_A_TIME {
            scope.spawn(|| {
                loop {
                    let index = next.fetch_add(1, Relaxed);
                    let Some(item) = items.get(index) else { break };
                    let Err(error) = work(item) else { continue };
                    next.store(items.len(), Relaxed);
                    if let Ok(mut first) = failed.lock()
                        && first.as_ref().is_none_or(|(before, _)| index < *before)
                    {
                        *first = Some((index, error));
                    }
                }
            });
        }
    });
    match failed.into_inner() {
        Ok(Some((_, error))) => Err(error),
        _ => Ok(()),
    }
}

/// The operating system's disk.
#[derive(Debug, Clone, Copy, Default)]
pub struct RealDisk;

impl Disk for RealDisk {
    fn append(&self, path: &Path, bytes: &[u8]) -> io::Result<()> {
        OpenOptions::new().append(true).create(true).open(path)?.write_all(bytes)
    }

    fn write(&self, path: &Path, bytes: &[u8]) -> io::Result<()> {
        let mut file = File::create(path)?;
        file.write_all(bytes)?;
        file.sync_all()
    }

    fn sync(&self, path: &Path) -> io::Result<()> {
        match path.is_dir() {
            true if cfg!(unix) => File::open(path)?.sync_all(),
            true => Ok(()), // on such systems a folder cannot be opened as a file
            false => OpenOptions::new().append(true).open(path)?.sync_all(),
        }
    }

    #[cfg(target_os = "linux")]
    fn sync_within(&self, folder: &Path, files: &[PathBuf]) -> io::Result<()> {
        if files.len() > MANY {
            return Ok(rustix::fs::syncfs(File::open(folder)?)?);
        }
        files.iter().try_for_each(|file| self.sync(file))
    }

    fn rename(&self, from: &Path, to: &Path) -> io::Result<()> {
        fs::rename(from, to)
    }

    fn truncate(&self, path: &Path, length: u64) -> io::Result<()> {
        OpenOptions::new().write(true).open(path)?.set_len(length)
    }

    fn remove(&self, path: &Path) -> io::Result<()> {
        fs::remove_file(path)
    }

    fn create_folder(&self, path: &Path) -> io::Result<()> {
        fs::create_dir(path)
    }
}

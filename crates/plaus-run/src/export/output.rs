//! Where an export is written: first under another name, so that it exists wholly or not at all, and nothing is
//! overwritten unasked.

use crate::error::{RunFileError, RunFileProblem};
use crate::folder::{clear_drafts, draft_of, parent_of};
use std::fs::{self, File};
use std::io::{BufWriter, Write};
use std::path::Path;

/// Makes the file `out`, and its folder, with `write`. Replaces an existing file only with `force`, and only if
/// `is_ours` says that it was made here.
///
/// # Errors
/// As `write`, or [`RunFileError`] if something stands in the way or the disk refuses.
pub fn file<E: From<RunFileError>>(
    out: &Path,
    force: bool,
    is_ours: impl Fn(&Path) -> bool,
    write: impl FnOnce(&mut dyn Write) -> Result<(), E>,
) -> Result<(), E> {
    prepare(out, force, is_ours)?;
    clear_drafts(out);
    let draft = draft_of(out);
    let made = File::create_new(&draft).map_err(RunFileError::io(out, "write")).map_err(E::from).and_then(|file| {
        let mut writer = BufWriter::with_capacity(1 << 16, file);
        write(&mut writer)?;
        let file = writer.into_inner().map_err(|error| RunFileError::io(out, "write")(error.into_error()))?;
        file.sync_all().map_err(RunFileError::io(out, "write"))?;
        Ok(fs::rename(&draft, out).map_err(RunFileError::io(out, "write"))?)
    });
    if made.is_err() {
        let _ = fs::remove_file(&draft); // best effort: the first error is the one to report
    }
    made
}

/// Makes the folder `out`, and those around it, and fills it with `fill`. Replaces an existing folder only with
/// `force`, and only if `is_ours` says that it was made here.
///
/// # Errors
/// As `fill`, or [`RunFileError`] if something stands in the way or the disk refuses.
pub fn folder<E: From<RunFileError>>(
    out: &Path,
    force: bool,
    is_ours: impl Fn(&Path) -> bool,
    fill: impl FnOnce(&Path) -> Result<(), E>,
) -> Result<(), E> {
    prepare(out, force, is_ours)?;
    let draft = draft_of(out);
    let made = fs::create_dir(&draft).map_err(RunFileError::io(out, "make")).map_err(E::from).and_then(|()| {
        fill(&draft)?;
        Ok(swap(&draft, out)?)
    });
    if made.is_err() {
        let _ = fs::remove_dir_all(&draft);
    }
    made
}

/// Makes sure that `out` can be made: nothing stands there that may not be replaced, and its folder exists or is made.
fn prepare(out: &Path, force: bool, may_replace: impl Fn(&Path) -> bool) -> Result<(), RunFileError> {
    if fs::symlink_metadata(out).is_err() || (force && may_replace(out)) {
        let parent = parent_of(out);
        return fs::create_dir_all(&parent).map_err(RunFileError::io(&parent, "make the folder"));
    }
    let problem = if force { RunFileProblem::NotOurs } else { RunFileProblem::OutputExists };
    Err(RunFileError::new(out, problem))
}

/// Gives the draft its name. The previous one is removed only once the new one is in place.
fn swap(draft: &Path, out: &Path) -> Result<(), RunFileError> {
    let old = draft.with_extension("old");
    let replaced = out.exists();
    if replaced {
        fs::rename(out, &old).map_err(RunFileError::io(out, "replace"))?;
    }
    if let Err(error) = fs::rename(draft, out) {
        if replaced {
            let _ = fs::rename(&old, out); // best effort: the first error is the one to report
        }
        return Err(RunFileError::io(out, "write")(error));
    }
    if replaced {
        fs::remove_dir_all(&old).map_err(RunFileError::io(&old, "remove"))?;
    }
    Ok(())
}

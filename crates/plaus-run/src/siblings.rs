//! What the other pieces have found so far, so that a piece that looks for solutions need not find all of them by
//! itself.
//!
//! The end known here is never too early: another solution can only bring it forward. So a piece that is past that end
//! is past the end of the run, and has made everything that a merge takes from it. How far it goes beyond depends on
//! which piece was faster; the merged run does not.

use crate::error::RunFileError;
use crate::folder::{Folder, parent_of};
use crate::trail;
use plaus_mcmc::{Distinct, Sighting};
use std::collections::BTreeMap;
use std::path::PathBuf;

/// The other pieces in the same folder.
pub(crate) struct Siblings {
    own: Folder,
    run: u64,
    /// How much of each trail has been read.
    read: BTreeMap<PathBuf, u64>,
    /// What chains of this piece and of the others saw, as far as is known.
    found: Vec<Sighting>,
}

impl Siblings {
    pub(crate) fn new(own: &Folder, run: u64) -> Self {
        Self { own: own.clone(), run, read: BTreeMap::new(), found: Vec::new() }
    }

    /// Notes what this piece saw.
    pub(crate) fn note(&mut self, news: impl IntoIterator<Item = Sighting>) {
        self.found.extend(news);
    }

    /// An iteration by which `wanted` solutions are found, as far as this piece and the others know; `None` if there
    /// are not enough yet. Those counted are twice as far apart as they must be, see [`Distinct`].
    pub(crate) fn end(&mut self, wanted: u64) -> Option<u64> {
        self.look();
        self.found.sort_by_key(|one| one.first);
        let mut wide = Distinct::apart(2.0);
        for one in &self.found {
            wide.note_seen(one.first, one.look.clone());
        }
        let last = usize::try_from(wanted).ok()?.checked_sub(1)?;
        wide.firsts().get(last).map(|first| first.iteration)
    }

    /// Reads anything new. A trail that cannot be read, or is of another run, is ignored.
    fn look(&mut self) {
        let Ok(beside) = std::fs::read_dir(parent_of(self.own.path())) else { return };
        for entry in beside.flatten() {
            if Some(entry.file_name().as_os_str()) == self.own.path().file_name() {
                continue;
            }
            let path = Folder::new(entry.path()).trail();
            let from = self.read.get(&path).copied().unwrap_or(0);
            let news: Result<_, RunFileError> = trail::news_from(&path, self.run, from);
            if let Ok((seen, until)) = news {
                self.found.extend(seen);
                self.read.insert(path, until);
            }
        }
    }
}

//! What the other pieces have found so far, so that a piece that looks for solutions need not find all of them by
//! itself.
//!
//! The end known here is never too early: another solution can only bring it forward. So a piece that is past that end
//! is past the end of the run, and has made everything that a merge takes from it. How far it goes beyond depends on
//! which piece was faster; the merged run does not.

use crate::error::RunFileError;
use crate::folder::{Folder, parent_of};
use crate::trail;
use plaus_mcmc::{FirstOfClass, SolutionClass};
use std::collections::BTreeMap;
use std::path::PathBuf;

/// The other pieces in the same folder.
pub(crate) struct Siblings {
    own: Folder,
    run: u64,
    /// How much of each trail has been read.
    read: BTreeMap<PathBuf, u64>,
    /// The first iteration, as far as is known, that recorded each class.
    found: BTreeMap<SolutionClass, u64>,
}

impl Siblings {
    pub(crate) fn new(own: &Folder, run: u64) -> Self {
        Self { own: own.clone(), run, read: BTreeMap::new(), found: BTreeMap::new() }
    }

    /// The iteration that completes `wanted` solutions, as far as this piece and the others know; `None` if there are
    /// not enough yet.
    pub(crate) fn end(&mut self, ours: &[FirstOfClass], wanted: u64) -> Option<u64> {
        self.look();
        ours.iter().for_each(|first| self.note(first));
        let last = usize::try_from(wanted).ok()?.checked_sub(1)?;
        let mut iterations: Vec<u64> = self.found.values().copied().collect();
        (last < iterations.len()).then(|| *iterations.select_nth_unstable(last).1)
    }

    fn note(&mut self, first: &FirstOfClass) {
        let iteration = self.found.entry(first.class).or_insert(first.iteration);
        *iteration = first.iteration.min(*iteration);
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
            let news: Result<_, RunFileError> = trail::firsts_from(&path, self.run, from);
            if let Ok((firsts, until)) = news {
                firsts.iter().for_each(|first| self.note(first));
                self.read.insert(path, until);
            }
        }
    }
}

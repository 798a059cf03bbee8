//! What the pieces beside this one have found so far: so that a piece that looks for solutions need not find all of
//! them by itself.
//!
//! What is known is never too early: another solution can only bring the end forward. So a piece that is past the end
//! that it knows of is past the end of the run, and has made everything that a merge takes of it. How far it goes
//! beyond depends on who was faster; what is merged does not.

use crate::error::RunFileError;
use crate::folder::{Folder, parent_of};
use crate::trail;
use plaus_mcmc::{FirstOfClass, SolutionClass};
use std::collections::BTreeMap;
use std::path::PathBuf;

/// The other pieces in the folder that a piece lies in.
pub(crate) struct Siblings {
    own: Folder,
    run: u64,
    /// How much of each one's trail was read.
    read: BTreeMap<PathBuf, u64>,
    /// The first iteration, as far as is known, that recorded each class.
    found: BTreeMap<SolutionClass, u64>,
}

impl Siblings {
    pub(crate) fn new(own: &Folder, run: u64) -> Self {
        Self { own: own.clone(), run, read: BTreeMap::new(), found: BTreeMap::new() }
    }

    /// The iteration that completes `wanted` solutions, as far as is known here and to those beside; `None` where there
    /// are not so many yet.
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

    /// Reads what is new. What cannot be read, or is of another run, is of no use, and no harm.
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

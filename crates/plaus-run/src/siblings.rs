//! What the other pieces have found so far, so that a piece that looks for solutions need not find all of them by
//! itself.
//!
//! The end known here is never too early: another solution can only bring it forward. So a piece that is past that end
//! is past the end of the run, and has made everything that a merge takes from it. How far it goes beyond depends on
//! which piece was faster; the merged run does not.

use crate::folder::{Folder, parent_of};
use crate::trail;
use plaus_mcmc::{Distinct, Sighting};
use std::collections::BTreeMap;
use std::ops::Range;
use std::path::PathBuf;

/// The other pieces in the same folder.
pub(crate) struct Siblings {
    own: Folder,
    run: u64,
    /// How much of each trail has been read.
    read: BTreeMap<PathBuf, u64>,
    /// What chains of this piece and of the others saw, as far as is known.
    found: Vec<Sighting>,
    /// Number of chains of the run.
    chains: u32,
    /// Of each chain of which it is known: one past the last iteration known.
    reached: BTreeMap<u32, u64>,
}

impl Siblings {
    /// For a piece of a run that has `chains` chains in all.
    pub(crate) fn new(own: &Folder, run: u64, chains: u32) -> Self {
        let (read, reached) = (BTreeMap::new(), BTreeMap::new());
        Self { own: own.clone(), run, read, found: Vec::new(), chains, reached }
    }

    /// Notes what this piece's chains saw in the iterations up to `end`, exclusive.
    pub(crate) fn note(&mut self, news: impl IntoIterator<Item = Sighting>, own: Range<u32>, end: u64) {
        self.found.extend(news);
        self.reach(own, end);
    }

    fn reach(&mut self, chains: Range<u32>, end: u64) {
        for chain in chains {
            let reached = self.reached.entry(chain).or_default();
            *reached = end.max(*reached);
        }
    }

    /// An iteration by which `wanted` solutions are found, as far as this piece and the others know; `None` if there
    /// are not enough yet. Up to the iteration that all chains have reached, everything is known, so this is the end of
    /// the run. Beyond it, only solutions that are twice as far apart as they must be are counted, see [`Distinct`].
    pub(crate) fn end(&mut self, wanted: u64) -> Option<u64> {
        self.look();
        self.found.sort_by_key(|one| one.first);
        let last = usize::try_from(wanted).ok()?.checked_sub(1)?;
        let known = self.reached.values().copied().min().filter(|_| self.reached.len() == self.chains as usize);
        let by = |apart: f64, before: u64| {
            let mut taken = Distinct::apart(apart);
            for one in self.found.iter().take_while(|one| one.first.iteration < before) {
                taken.note_seen(one.first, one.look.clone());
            }
            taken.firsts().get(last).map(|first| first.iteration)
        };
        by(1.0, known.unwrap_or(0)).or_else(|| by(2.0, u64::MAX))
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
            if let Ok(news) = trail::news_from(&path, self.run, from) {
                self.found.extend(news.seen);
                if let Some((chains, end)) = news.reached {
                    self.reach(chains, end);
                }
                self.read.insert(path, news.until);
            }
        }
    }
}

//! Time to first hit, share of satisfying iterations, count of distinct solutions.

use crate::target::SolutionClass;
use rustc_hash::FxBuildHasher;
use serde::{Deserialize, Serialize};

/// A set asked only for membership, never iterated, with a fixed hash: cheap and deterministic.
#[allow(clippy::disallowed_types)]
type ClassSet = std::collections::HashSet<SolutionClass, FxBuildHasher>;

/// Satisfying iterations of one chain.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct Hits {
    /// The first iteration whose state satisfies the constraint.
    pub first: Option<u64>,
    /// Number of iterations with such a state, including the start.
    pub count: u64,
}

impl Hits {
    /// Counts the state of `iteration`.
    #[inline]
    pub(crate) fn count(&mut self, iteration: u64, satisfied: bool) {
        if satisfied {
            self.count += 1;
            self.first.get_or_insert(iteration);
        }
    }
}

/// A solution of a class that its chain, or the run, had not recorded before.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct FirstOfClass {
    /// The iteration that recorded it.
    pub iteration: u64,
    /// The chain.
    pub chain: u32,
    /// The class.
    pub class: SolutionClass,
}

/// Distinct classes of solutions seen so far, with the first sighting of each.
#[derive(Debug, Clone, Default)]
pub struct Distinct {
    seen: ClassSet,
    firsts: Vec<FirstOfClass>,
}

impl Distinct {
    /// Notes a recorded solution; true if its class is new.
    #[inline]
    pub fn note(&mut self, first: FirstOfClass) -> bool {
        let new = self.seen.insert(first.class);
        if new {
            self.firsts.push(first);
        }
        new
    }

    /// Whether a class was noted.
    pub(crate) fn contains(&self, class: SolutionClass) -> bool {
        self.seen.contains(&class)
    }

    /// Forgets classes first noted after `iteration`.
    pub(crate) fn truncate(&mut self, iteration: u64) {
        for gone in self.firsts.iter().filter(|first| first.iteration > iteration) {
            self.seen.remove(&gone.class);
        }
        self.firsts.retain(|first| first.iteration <= iteration);
    }

    /// How many classes there are.
    #[must_use]
    pub fn count(&self) -> u64 {
        self.firsts.len() as u64
    }

    /// The first recorded solution of each class, in the order they were noted.
    #[must_use]
    pub fn firsts(&self) -> &[FirstOfClass] {
        &self.firsts
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_class_counts_once() {
        let mut distinct = Distinct::default();
        let first =
            |iteration, features: [i64; 2]| FirstOfClass { iteration, chain: 0, class: SolutionClass::of(features) };
        assert!(distinct.note(first(3, [1, 2])));
        assert!(!distinct.note(first(4, [1, 2])));
        assert!(distinct.note(first(5, [2, 1])));
        assert_eq!(distinct.firsts(), [first(3, [1, 2]), first(5, [2, 1])]);
    }

    #[test]
    fn the_first_hit_stays_the_first() {
        let mut hits = Hits::default();
        for (iteration, satisfied) in [(0, false), (1, true), (2, true)] {
            hits.count(iteration, satisfied);
        }
        assert_eq!(hits, Hits { first: Some(1), count: 2 });
    }
}

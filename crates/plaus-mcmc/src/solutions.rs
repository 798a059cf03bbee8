//! Time to first hit, share of satisfying iterations, count of distinct solutions.

use crate::look::Look;
use crate::target::SolutionClass;
use rustc_hash::FxBuildHasher;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

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

/// A recorded solution that is new to its chain, and how it looks.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Sighting {
    /// When, where, and its class.
    pub first: FirstOfClass,
    /// How it looks; empty where nobody asks.
    pub look: Look,
}

/// Distinct solutions seen so far: the first sighting of each.
///
/// A chain tells its solutions by class. A run that looks for a number of them tells them by how they look: a chain
/// looks at each of a new class, and otherwise at one in ten iterations. Of those, in the order of iteration and
/// chain, the run takes each that differs [clearly](Look::distance) from all that it has taken.
///
/// How many it has taken by some iteration is not known before all chains have got there: another solution may stand in
/// the way of two. But it is at least the number in any set of solutions seen until then that are all twice as far
/// apart, since each of these is near one that was taken, and no two of them are near the same.
#[derive(Debug, Clone, Default)]
pub struct Distinct {
    /// The least distance between any two.
    apart: f64,
    seen: ClassSet,
    releases: ClassSet,
    firsts: Vec<FirstOfClass>,
    looks: Vec<Arc<Look>>,
    /// From this iteration on, a solution of a known class is looked at.
    next: u64,
}

/// Iterations between two looks at solutions of classes that their chain has recorded before. A look costs a
/// simulation, an iteration about one.
const EVERY: u64 = 10;

impl Distinct {
    /// None yet; any two are to be so far apart.
    #[must_use]
    pub fn apart(apart: f64) -> Self {
        Self { apart, ..Self::default() }
    }

    /// Notes a recorded solution that nobody looks at; true if its class is new.
    #[inline]
    pub fn note(&mut self, first: FirstOfClass) -> bool {
        !self.contains(first.class) && self.note_seen(first, Look::default())
    }

    /// Notes a recorded solution; its look if it counts. Classes tell solutions that have no look.
    pub fn note_with(&mut self, first: FirstOfClass, look: Option<impl FnOnce() -> Look>) -> Option<Arc<Look>> {
        if self.contains(first.class) && (look.is_none() || first.iteration < self.next) {
            return None;
        }
        self.next = first.iteration.saturating_add(EVERY);
        let look = Arc::new(look.map_or_else(Look::default, |look| look()));
        self.note_seen(first, Arc::clone(&look)).then_some(look)
    }

    /// Notes a recorded solution; true if it counts.
    pub fn note_seen(&mut self, first: FirstOfClass, look: impl Into<Arc<Look>>) -> bool {
        let look = look.into();
        if !self.is_new(first, &look) {
            return false;
        }
        self.seen.insert(first.class);
        self.releases.extend(look.release.map(SolutionClass));
        self.firsts.push(first);
        self.looks.push(look);
        true
    }

    /// Whether a solution would count: its look differs clearly from all others; without looks, its class is new.
    #[must_use]
    pub fn is_new(&self, first: FirstOfClass, look: &Look) -> bool {
        if look.release.is_some_and(|release| self.releases.contains(&SolutionClass(release))) {
            return false;
        }
        match self.apart > 0.0 && !look.seen.is_empty() {
            true => self.looks.iter().all(|other| other.distance(look) >= self.apart),
            false => !self.contains(first.class),
        }
    }

    /// Whether a class was noted.
    #[must_use]
    pub fn contains(&self, class: SolutionClass) -> bool {
        self.seen.contains(&class)
    }

    /// Forgets what was first seen after `iteration`. What was noted in order of iteration is then as if it had ended
    /// there.
    pub(crate) fn truncate(&mut self, iteration: u64) {
        let all = std::mem::replace(self, Self::apart(self.apart));
        for (first, look) in all.firsts.into_iter().zip(all.looks) {
            if first.iteration <= iteration {
                self.note_seen(first, look);
            }
        }
    }

    /// How many there are.
    #[must_use]
    pub fn count(&self) -> u64 {
        self.firsts.len() as u64
    }

    /// The first recorded solution of each class, in the order they were noted.
    #[must_use]
    pub fn firsts(&self) -> &[FirstOfClass] {
        &self.firsts
    }

    /// The same, each with its look.
    pub(crate) fn looks(&self) -> impl Iterator<Item = (FirstOfClass, Arc<Look>)> + '_ {
        self.firsts.iter().copied().zip(self.looks.iter().map(Arc::clone))
    }

    /// The same.
    pub fn sightings(&self) -> impl Iterator<Item = Sighting> + '_ {
        self.firsts.iter().zip(&self.looks).map(|(&first, look)| Sighting { first, look: Look::clone(look) })
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

    /// Where solutions are looked at, one of a known class counts if it looks different, is looked at once in ten
    /// iterations, and restored from what is kept of it counts no less.
    #[test]
    fn looks_tell_solutions_of_one_class() {
        let first = |iteration| FirstOfClass { iteration, chain: 0, class: SolutionClass::of([1]) };
        let at = |x: f32| move || Look { release: None, seen: vec![x], width: 1 };
        let mut distinct = Distinct::apart(1.0);
        let noted = [(0, 0.0), (9, 5.0), (10, 0.5), (20, 5.0), (30, 8.0)]
            .map(|(iteration, x)| distinct.note_with(first(iteration), Some(at(x))).is_some());
        assert_eq!(noted, [true, false, false, true, true]);
        distinct.truncate(25);
        assert_eq!(distinct.firsts(), [first(0), first(20)]);
        assert!(distinct.contains(first(0).class) && distinct.is_new(first(26), &at(8.0)()));
    }

    /// In random sequences of points on a line: the number taken is at least that of any part that lies twice as far
    /// apart, and cutting a sequence is the same as having seen only its beginning. With parts that are only as far
    /// apart as what is taken the first is false.
    #[test]
    fn parts_that_are_twice_as_far_apart_never_hold_more() {
        let mut state = 1_u64;
        let mut below = |limit: u64| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 33) % limit
        };
        let mut is_caught = false;
        for _ in 0..300 {
            let all: Vec<Sighting> = (0..40)
                .map(|iteration| {
                    let first = FirstOfClass { iteration, chain: 0, class: SolutionClass::of([below(60) as i64]) };
                    let seen = vec![below(1000) as f32 / 100.0, 0.0, 0.0, below(1000) as f32 / 300.0];
                    Sighting { first, look: Look { release: None, seen, width: 2 } }
                })
                .collect();
            let taken = |apart: f64, some: &[&Sighting]| {
                let mut taken = Distinct::apart(apart);
                for one in some {
                    taken.note_seen(one.first, one.look.clone());
                }
                taken
            };
            let whole = taken(1.0, &all.iter().collect::<Vec<_>>());
            let mut shuffled: Vec<&Sighting> = all.iter().collect();
            (1..40).for_each(|k| shuffled.swap(k, below(k as u64 + 1) as usize));
            let part = &shuffled[..below(41) as usize];
            assert!(taken(2.0, part).count() <= whole.count());
            is_caught |= taken(1.0, part).count() > whole.count();
            let cut = below(40);
            let mut shorter = whole.clone();
            shorter.truncate(cut);
            let begun: Vec<&Sighting> = all.iter().filter(|one| one.first.iteration <= cut).collect();
            assert_eq!(shorter.firsts(), taken(1.0, &begun).firsts());
        }
        assert!(is_caught, "no part shows that the factor is needed");
    }

    #[test]
    fn twins_count_once() {
        let look = |release| Look { release: Some(release), ..Look::default() };
        let first = |iteration| FirstOfClass { iteration, chain: 0, class: SolutionClass::of([iteration as i64]) };
        let mut distinct = Distinct::default();
        assert!(distinct.note_seen(first(0), look(5)) && distinct.note_seen(first(1), look(6)));
        assert!(!distinct.note_seen(first(2), look(5)));
        distinct.truncate(0);
        assert!(distinct.note_seen(first(3), look(6)) && !distinct.note_seen(first(4), look(5)));
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

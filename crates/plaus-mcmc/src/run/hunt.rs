//! Solutions found within a round: chains tell each other, so that none goes far beyond the iteration that completes
//! the number asked for.
//!
//! That iteration follows from the chains alone. The value known while they run is never too early: another solution
//! can only bring it forward. So a chain that stops after it has made everything that the run will hold.

use super::pulse::Pulse;
use crate::solutions::{Distinct, FirstOfClass};
use crate::target::SolutionClass;
use std::collections::BTreeMap;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};
use std::sync::{Mutex, PoisonError};

/// What the chains of a round tell each other.
pub(super) struct Hunt<'a> {
    pub(super) pulse: &'a Pulse,
    /// Solutions of the rounds before.
    known: &'a Distinct,
    /// How many more are asked for, at least 1; `None` if any number is welcome.
    missing: Option<usize>,
    /// The first iteration known so far that recorded each class not known before.
    found: Mutex<BTreeMap<SolutionClass, u64>>,
    /// The iteration known so far that completes the solutions asked for.
    last: AtomicU64,
}

impl<'a> Hunt<'a> {
    /// A round that follows rounds that found `known`, and in which `missing` more solutions are looked for.
    pub(super) fn new(pulse: &'a Pulse, known: &'a Distinct, missing: Option<usize>) -> Self {
        Self { pulse, known, missing, found: Mutex::default(), last: AtomicU64::new(u64::MAX) }
    }

    /// Whether a chain that has done the iterations `0 .. done` should do the next one.
    #[inline]
    pub(super) fn goes_on(&self, done: u64) -> bool {
        done <= self.last.load(Relaxed) && !self.pulse.is_stopped()
    }

    /// Notes a class that is new to its chain.
    pub(super) fn note(&self, first: FirstOfClass) {
        if self.known.contains(first.class) {
            return;
        }
        // Nothing panics while it holds the lock.
        let mut found = self.found.lock().unwrap_or_else(PoisonError::into_inner);
        let iteration = found.entry(first.class).or_insert(first.iteration);
        *iteration = first.iteration.min(*iteration);
        self.pulse.set_distinct(self.known.count() + found.len() as u64);
        if let Some(missing) = self.missing.filter(|&missing| missing <= found.len()) {
            let mut iterations: Vec<u64> = found.values().copied().collect();
            let (_, &mut last, _) = iterations.select_nth_unstable(missing - 1);
            self.last.store(last, Relaxed);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_end_only_ever_comes_nearer() {
        let first = |iteration, class: i64| FirstOfClass { iteration, chain: 0, class: SolutionClass::of([class]) };
        let (pulse, mut known) = (Pulse::default(), Distinct::default());
        known.note(first(3, 0));
        let hunt = Hunt::new(&pulse, &known, Some(2));
        hunt.note(first(20, 0)); // known already
        hunt.note(first(20, 1));
        assert!(hunt.goes_on(u64::MAX - 1) && pulse.distinct() == 2);
        hunt.note(first(30, 2));
        assert!(hunt.goes_on(30) && !hunt.goes_on(31));
        hunt.note(first(25, 3));
        assert!(hunt.goes_on(25) && !hunt.goes_on(26));
        hunt.note(first(12, 2)); // another chain saw it earlier
        assert!(hunt.goes_on(20) && !hunt.goes_on(21) && pulse.distinct() == 4);
        pulse.stop();
        assert!(!hunt.goes_on(5));
    }
}

//! Solutions found within a round: chains tell each other, so that none goes far beyond the iteration that completes
//! the number asked for.
//!
//! That iteration follows from the chains alone. The value known while they run is never too early, see [`Distinct`]:
//! only solutions that are twice as far apart as they must be are counted. So a chain that stops after it has made
//! everything that the run will hold.

use super::pulse::Pulse;
use crate::look::Look;
use crate::solutions::{Distinct, FirstOfClass};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};
use std::sync::{Mutex, PoisonError};

/// What the chains of a round tell each other.
pub(super) struct Hunt<'a> {
    pub(super) pulse: &'a Pulse,
    /// Solutions of the rounds before.
    known: &'a Distinct,
    /// How many are asked for, with those of the rounds before; `None` if any number is welcome.
    wanted: Option<usize>,
    /// Solutions known so far that are twice as far apart, beginning with those of the rounds before.
    found: Mutex<Distinct>,
    /// How many these began with.
    before: u64,
    /// The iteration known so far that completes the solutions asked for.
    last: AtomicU64,
}

impl<'a> Hunt<'a> {
    /// A round that follows rounds that found `known`, of which `wide` lie twice as far apart. `wanted` are looked for.
    pub(super) fn new(pulse: &'a Pulse, known: &'a Distinct, wide: Distinct, wanted: Option<usize>) -> Self {
        let before = wide.count();
        Self { pulse, known, wanted, found: Mutex::new(wide), before, last: AtomicU64::new(u64::MAX) }
    }

    /// Whether a chain that has done the iterations `0 .. done` should do the next one.
    #[inline]
    pub(super) fn goes_on(&self, done: u64) -> bool {
        done <= self.last.load(Relaxed) && !self.pulse.is_stopped()
    }

    /// Notes a solution that is new to its chain.
    pub(super) fn note(&self, first: FirstOfClass, look: &Arc<Look>) {
        if !self.known.is_new(first, look) {
            return;
        }
        // Nothing panics while it holds the lock.
        let mut found = self.found.lock().unwrap_or_else(PoisonError::into_inner);
        if !found.note_seen(first, Arc::clone(look)) {
            return;
        }
        self.pulse.set_distinct(self.known.count() + found.count() - self.before);
        if let Some(wanted) = self.wanted.filter(|&wanted| (1..=found.firsts().len()).contains(&wanted)) {
            let mut iterations: Vec<u64> = found.firsts().iter().map(|first| first.iteration).collect();
            let (_, &mut last, _) = iterations.select_nth_unstable(wanted - 1);
            self.last.fetch_min(last, Relaxed);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::target::SolutionClass;

    #[test]
    fn the_end_only_ever_comes_nearer() {
        let first = |iteration, class: i64| FirstOfClass { iteration, chain: 0, class: SolutionClass::of([class]) };
        let (pulse, mut known) = (Pulse::default(), Distinct::default());
        known.note(first(3, 0));
        let hunt = Hunt::new(&pulse, &known, known.clone(), Some(3));
        let note = |first| hunt.note(first, &Arc::default());
        note(first(20, 0)); // known already
        note(first(20, 1));
        assert!(hunt.goes_on(u64::MAX - 1) && pulse.distinct() == 2);
        note(first(30, 2));
        assert!(hunt.goes_on(30) && !hunt.goes_on(31));
        note(first(25, 3));
        assert!(hunt.goes_on(25) && !hunt.goes_on(26));
        note(first(12, 4));
        assert!(hunt.goes_on(20) && !hunt.goes_on(21) && pulse.distinct() == 5);
        pulse.stop();
        assert!(!hunt.goes_on(5));
    }
}

//! How another thread ends simulations that have begun.

use std::cell::{Cell, RefCell};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};

thread_local! {
    /// Whether simulations on this thread look at the flag.
    static LOOKS: Cell<bool> = const { Cell::new(false) };
    /// Kept from call to call: to count the owners of a flag that many threads share would cost more than a short
    /// simulation.
    static FLAG: RefCell<Option<Arc<AtomicBool>>> = const { RefCell::new(None) };
}

/// Runs `job`. Once any thread has set `flag`, the simulations of `job` on this thread end after the event that they
/// are at, as [`Outcome::Stopped`](crate::Outcome). `None` if the flag is set when `job` returns: what it returned may
/// then follow from a motion that was cut short.
///
/// ```
/// use plaus_sim::interruptible;
/// use std::sync::{Arc, atomic::{AtomicBool, Ordering}};
///
/// let flag = Arc::new(AtomicBool::new(false));
/// assert_eq!(interruptible(&flag, || 1), Some(1));
/// flag.store(true, Ordering::Relaxed);
/// assert_eq!(interruptible(&flag, || 1), None);
/// ```
pub fn interruptible<T>(flag: &Arc<AtomicBool>, job: impl FnOnce() -> T) -> Option<T> {
    let _before = Before::watching(flag);
    let made = job();
    (!flag.load(Relaxed)).then_some(made)
}

/// What simulations on this thread looked at before; they do so again when this is dropped.
struct Before {
    looks: bool,
    flag: Option<Arc<AtomicBool>>,
}

impl Before {
    fn watching(flag: &Arc<AtomicBool>) -> Self {
        let looks = LOOKS.replace(true);
        let before = FLAG.with_borrow_mut(|known| match known {
            Some(same) if Arc::ptr_eq(same, flag) => None,
            _ => known.replace(Arc::clone(flag)),
        });
        Self { looks, flag: before.filter(|_| looks) }
    }
}

impl Drop for Before {
    fn drop(&mut self) {
        LOOKS.set(self.looks);
        if let Some(flag) = self.flag.take() {
            FLAG.set(Some(flag));
        }
    }
}

/// Whether what runs on this thread within [`interruptible`] should end, as its result will be dropped. Simulations ask
/// after each event; it takes a few nanoseconds.
#[must_use]
pub fn is_interrupted() -> bool {
    LOOKS.get() && FLAG.with_borrow(|flag| flag.as_ref().is_some_and(|flag| flag.load(Relaxed)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_flag_counts_only_for_the_job_that_it_was_given_to() {
        let [inner, outer] = [true, false].map(|set| Arc::new(AtomicBool::new(set)));
        let seen = interruptible(&outer, || {
            let before = is_interrupted();
            assert_eq!(interruptible(&inner, || assert!(is_interrupted())), None);
            (before, is_interrupted())
        });
        assert_eq!(seen, Some((false, false)));
        outer.store(true, Relaxed);
        assert!(!is_interrupted(), "outside of any job nothing is asked");
        assert_eq!(interruptible(&outer, || assert!(is_interrupted())), None);
    }
}

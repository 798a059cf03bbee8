//! What simulations cost, counted.

use std::cell::Cell;

thread_local! {
    static WORK: Cell<u64> = const { Cell::new(0) };
}

/// How many events have been taken on this thread so far, in all simulations. The cost of a piece of work is the growth
/// of this number, which is the same on every machine.
#[must_use]
pub fn work() -> u64 {
    WORK.get()
}

/// Counts this many more events.
pub(crate) fn add(events: u64) {
    WORK.set(WORK.get() + events);
}

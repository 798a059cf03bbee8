//! What simulations cost, counted.

use std::cell::Cell;

thread_local! {
    static WORK: Cell<u64> = const { Cell::new(0) };
}

/// How many events were taken on this thread so far, in all simulations: what a piece of work costs is by how much this
/// grows, the same on every machine.
#[must_use]
pub fn work() -> u64 {
    WORK.get()
}

/// Counts so many events more.
pub(crate) fn add(events: u64) {
    WORK.set(WORK.get() + events);
}

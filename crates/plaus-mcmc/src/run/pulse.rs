//! What other threads can see of a run while its chains are running, and how they can stop it.

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering::Relaxed};
use std::sync::{Arc, OnceLock};

/// Counters of one run that its chains update in every iteration, and a request to stop. Nothing that is recorded
/// depends on who reads them, or when; a request to stop only decides where the records end.
#[derive(Debug, Default)]
pub struct Pulse {
    chains: OnceLock<Box<[Beat]>>,
    distinct: AtomicU64,
    stopped: Arc<AtomicBool>,
}

/// Counters of one chain, on cache lines of their own, so that chains do not wait for each other's writes.
#[derive(Debug, Default)]
#[repr(align(128))]
struct Beat {
    iterations: AtomicU64,
    hits: AtomicU64,
}

/// How far a chain is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct ChainPulse {
    /// Iterations done.
    pub iterations: u64,
    /// Number of satisfying ones among them.
    pub hits: u64,
}

impl Pulse {
    /// Asks the chains to stop at once. Anything done since the last round is dropped, so that what was recorded before
    /// is the beginning of the whole run.
    pub fn stop(&self) {
        self.stopped.store(true, Relaxed);
    }

    /// Set once the chains should stop, for targets whose simulations take long: see [`Interrupted`](crate::Interrupted).
    #[must_use]
    pub fn flag(&self) -> Arc<AtomicBool> {
        Arc::clone(&self.stopped)
    }

    /// Whether the chains should stop.
    #[must_use]
    pub fn is_stopped(&self) -> bool {
        self.stopped.load(Relaxed)
    }

    /// How far each chain is; empty before the run has begun.
    #[must_use]
    pub fn chains(&self) -> Vec<ChainPulse> {
        let read =
            |beat: &Beat| ChainPulse { iterations: beat.iterations.load(Relaxed), hits: beat.hits.load(Relaxed) };
        self.chains.get().map(|beats| beats.iter().map(read).collect()).unwrap_or_default()
    }

    /// Distinct solutions recorded by all chains together, see [`Plan::counts_from`](super::Plan::counts_from). The
    /// number may fall at the end of a run, if a chain found solutions beyond that end.
    #[must_use]
    pub fn distinct(&self) -> u64 {
        self.distinct.load(Relaxed)
    }

    pub(super) fn begin(&self, chains: usize) {
        self.chains.get_or_init(|| (0..chains).map(|_| Beat::default()).collect());
    }

    #[inline]
    pub(super) fn set_chain(&self, chain: u32, iterations: u64, hits: u64) {
        if let Some(beat) = self.chains.get().and_then(|beats| beats.get(chain as usize)) {
            beat.iterations.store(iterations, Relaxed);
            beat.hits.store(hits, Relaxed);
        }
    }

    pub(super) fn set_distinct(&self, distinct: u64) {
        self.distinct.store(distinct, Relaxed);
    }
}

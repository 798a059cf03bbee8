//! How likely it is that a draw from the prior reaches the goal: estimators that check each other.
//!
//! | | for | error, relative |
//! | --- | --- | --- |
//! | [`count()`]: draws of the prior | goals that come up now and then | `1/√hits` |
//! | [`importance()`]: draws of a widened prior | rare goals in the tails of a few Gaussian numbers | from their weights |
//! | [`split()`]: particles climb the constraint, level by level | rare goals, also behind plateaus | about `√(ln(1/p)/particles)` |
//! | [`stones()`]: chains on a ladder between prior and target | rare goals of smooth constraints | by how chains mix |
//!
//! All draw from [`Target::start`], which must follow the law of the prior; draws of density 0 do not count. Each works
//! in batches, which are functions of target, seed and number alone, so that they can be made anywhere and in any
//! order. [`Estimate`] is their result, with an error from the differences between batches.
//!
//! Counting is right for every world, and importance sampling too. The other two rely on what their particles and
//! chains have seen: if none of them found a way to the goal, it is missing from both, and they are too low. A
//! [`Verdict`] says what all support together, and what speaks against it.

mod above;
mod count;
mod estimate;
mod importance;
mod split;
mod stones;
mod verdict;

pub use count::{Counted, count};
pub use estimate::{Disagreement, Estimate, Method, disagree, student};
pub use importance::{Weighted, importance, spreadable};
pub use split::{Split, Splitting, split};
pub use stones::{Stoned, Stones, stones};
pub use verdict::{Batches, Doubt, Verdict};

use crate::chain::ChainError;
use crate::target::{Goal, ModelError, State, StateOf, StateRefOf, Target};
use plaus_dist::{ChainStreams, Purpose, Seed, Stream};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering::Relaxed};

/// This many draws of density 0 in a row are too many.
const TRIES: u64 = 10_000_000;
/// Purpose of the random numbers for a draw from the prior.
const DRAW: Purpose = Purpose(4);
/// Purpose of the random numbers that choose the particle to copy.
const BRANCH: Purpose = Purpose(5);

/// Why there is no estimate.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ChanceError {
    /// The model failed.
    #[error("draw {draw} of batch {batch}: {source}")]
    Model {
        /// The batch.
        batch: u32,
        /// Number of the draw in it.
        draw: u64,
        /// The model's error.
        source: ModelError,
    },
    /// A chain failed.
    #[error("batch {batch}: {source}")]
    Chain {
        /// The batch.
        batch: u32,
        /// The chain's error.
        source: ChainError,
    },
    /// A number from which nothing can be estimated.
    #[error("`{name}` is {value}, but must be at least {least}")]
    Plan {
        /// The number.
        name: &'static str,
        /// Its value.
        value: u64,
        /// Its least allowed value.
        least: u64,
    },
    /// A stop was requested.
    #[error("stopped")]
    Stopped,
}

/// Number of simulations made so far, for other threads, and a request to stop.
#[derive(Debug, Default)]
pub struct ChancePulse {
    simulations: AtomicU64,
    stopped: Arc<AtomicBool>,
}

impl ChancePulse {
    /// Number of simulations, over all batches.
    #[must_use]
    pub fn simulations(&self) -> u64 {
        self.simulations.load(Relaxed)
    }

    /// Asks all batches to stop.
    pub fn stop(&self) {
        self.stopped.store(true, Relaxed);
    }

    /// Set once the batches should stop, for targets whose simulations take long: see
    /// [`Interrupted`](crate::Interrupted).
    #[must_use]
    pub fn flag(&self) -> Arc<AtomicBool> {
        Arc::clone(&self.stopped)
    }

    /// Whether batches should stop.
    #[must_use]
    pub fn is_stopped(&self) -> bool {
        self.stopped.load(Relaxed)
    }

    fn made(&self, simulations: u64) -> Result<(), ChanceError> {
        self.simulations.fetch_add(simulations, Relaxed);
        if self.is_stopped() { Err(ChanceError::Stopped) } else { Ok(()) }
    }
}

/// Streams of a batch, which differ from those of all chains of a run.
fn streams(seed: Seed, batch: u32) -> ChainStreams {
    seed.chain(1 << 63 | u64::from(batch))
}

/// A draw from the prior, fully evaluated.
pub(crate) fn prior<T: Target>(
    target: &T,
    stream: &mut Stream,
    scratch: &mut T::Scratch,
) -> Result<StateOf<T>, ModelError> {
    for _ in 0..TRIES {
        let draw = target.start(stream);
        if !target.log_prior(&draw)?.is_zero() {
            return State::evaluate(target, draw, scratch);
        }
    }
    Err(ModelError::new(format!("none of {TRIES} start draws has positive prior density")))
}

/// Sets, for each part of a goal, whether a state meets it; the slice has one place for each part.
pub type Met<'a, T> = &'a (dyn Fn(&T, StateRefOf<'_, T>, &mut [bool]) + Sync);

/// Parts of a goal that states may meet one by one. Each is an event of its own, besides the goal.
pub struct Parts<'a, T: Target> {
    /// Number of parts.
    pub count: usize,
    /// Sets which of them a state meets.
    pub met: Met<'a, T>,
}

impl<T: Target> Clone for Parts<'_, T> {
    fn clone(&self) -> Self {
        *self
    }
}
impl<T: Target> Copy for Parts<'_, T> {}

impl<T: Target> Parts<'_, T> {
    /// No parts: only the goal counts.
    pub const NONE: Self = Self { count: 0, met: &|_, _, _| {} };
}

impl<T: Goal> Parts<'_, T> {
    /// Sets whether a state reaches the goal, then whether it meets each part; `met` has one place more than there are
    /// parts.
    fn look(&self, target: &T, state: StateRefOf<'_, T>, met: &mut [bool]) {
        if let Some((all, parts)) = met.split_first_mut() {
            *all = target.class(state).is_some();
            (self.met)(target, state, parts);
        }
    }
}

fn at_least(name: &'static str, value: u64, least: u64) -> Result<(), ChanceError> {
    if value < least { Err(ChanceError::Plan { name, value, least }) } else { Ok(()) }
}

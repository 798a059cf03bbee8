//! How runs end.

use crate::mechanics::Other;

/// How a run ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum Outcome {
    /// The time asked for was reached.
    TimeReached,
    /// Every body is at rest: nothing will ever happen again.
    AllAtRest,
    /// The observer asked to stop, or another thread did, see [`interruptible`](crate::interruptible).
    Stopped,
    /// The event budget was spent: as many events for each body as the accuracy allows, of bodies alone or of groups
    /// whose members all take a new motion. The state is the one at that time.
    OutOfEvents,
    /// A body's motion is no longer finite, at the state's time. The state is kept as it is, for replay; the observer
    /// has not seen that motion.
    NotFinite {
        /// Index of the body.
        body: usize,
        /// What it touched last: what it met in that event, or is in lasting contact with, if anything.
        touched: Option<Other>,
    },
    /// A driven body left a body no way out and is in it (or their joint is open) by a hundredth of the smaller size.
    Crushed {
        /// Index of the body.
        body: usize,
        /// Index of the driven body.
        by: usize,
    },
}

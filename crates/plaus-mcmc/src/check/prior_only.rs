//! The prior as a target: the constraint switched off.

use crate::target::{ModelError, Target};
use crate::view::Reweighed;
use plaus_dist::LogPotential;

/// A target with its constraint switched off (λ = 1), so that a chain must leave the prior invariant. Draws, outcomes
/// and simulation are the target's own, and its moves can be used unchanged through [`crate::view::lend`].
#[derive(Debug)]
pub struct PriorOnly<'a, T> {
    target: &'a T,
}

impl<'a, T: Target> PriorOnly<'a, T> {
    /// The prior of `target`.
    #[must_use]
    pub fn new(target: &'a T) -> Self {
        Self { target }
    }
}

impl<T: Target> Reweighed for PriorOnly<'_, T> {
    type Seen = T;

    fn seen(&self) -> &T {
        self.target
    }

    fn floor_seen(&self, floor: LogPotential) -> Option<LogPotential> {
        (floor < LogPotential::ONE).then_some(LogPotential::ZERO)
    }

    fn weigh(&self, _outcome: &T::Outcome) -> Result<LogPotential, ModelError> {
        Ok(LogPotential::ONE)
    }
}

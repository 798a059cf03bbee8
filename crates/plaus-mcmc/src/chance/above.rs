//! The prior above a level of the constraint.

use crate::target::{ModelError, Target};
use crate::view::Reweighed;
use plaus_dist::LogPotential;

/// `p_w(draw)` restricted to outcomes with a log constraint above a level: 1 there, 0 elsewhere. A simulation that
/// cannot exceed the level may stop, as it does below the floor of a chain.
pub(super) struct Above<'a, T> {
    pub(super) target: &'a T,
    pub(super) level: LogPotential,
}

impl<T: Target> Reweighed for Above<'_, T> {
    type Seen = T;

    fn seen(&self) -> &T {
        self.target
    }

    fn floor_seen(&self, floor: LogPotential) -> Option<LogPotential> {
        (floor < LogPotential::ONE).then_some(self.level)
    }

    fn weigh(&self, outcome: &T::Outcome) -> Result<LogPotential, ModelError> {
        let is_above = self.target.log_constraint(outcome)? > self.level;
        Ok(if is_above { LogPotential::ONE } else { LogPotential::ZERO })
    }
}

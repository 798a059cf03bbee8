//! The independence move: a whole new draw, whatever the current one is.

use crate::moves::{Move, Path, Proposal};
use crate::target::{ModelError, StateRefOf, Target};
use plaus_dist::{LogRatio, Stream};

/// Proposes [`Target::start`]'s draw. This is correct for a target whose start has the law of its prior: then the prior
/// cancels, and the acceptance is the ratio of constraints. It is the move of tempering's first rung, where everything
/// is accepted.
#[derive(Debug, Clone, Copy, Default)]
pub struct Redraw;

impl<T: Target> Move<T> for Redraw {
    fn name(&self) -> &str {
        "redraw_all"
    }

    fn propose(
        &self,
        target: &T,
        current: StateRefOf<'_, T>,
        candidate: &mut T::Draw,
        stream: &mut Stream,
    ) -> Result<Proposal, ModelError> {
        *candidate = target.start(stream);
        let there = target.log_prior(candidate)?;
        if there.is_zero() {
            // The chain rejects it because of its prior; no ratio is needed.
            return Ok(Proposal::SYMMETRIC);
        }
        Ok(Proposal::with_ratio(LogRatio::new(current.log_prior.value() - there.value())?))
    }

    fn log_ratio(
        &self,
        _: &T,
        from: StateRefOf<'_, T>,
        to: StateRefOf<'_, T>,
        _: Path,
    ) -> Result<LogRatio, ModelError> {
        Ok(LogRatio::new(from.log_prior.value() - to.log_prior.value())?)
    }
}

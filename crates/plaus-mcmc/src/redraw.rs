//! The independence move: a whole new draw, whatever the current one is.

use crate::moves::{At, Move, Proposal, Transition};
use crate::target::{ModelError, Target};
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

    fn propose(&self, at: At<'_, T>, candidate: &mut T::Draw, stream: &mut Stream) -> Result<Proposal, ModelError> {
        *candidate = at.target.start(stream);
        let there = at.target.log_prior(candidate)?;
        if there.is_zero() {
            // The chain rejects it because of its prior; no ratio is needed.
            return Ok(Proposal::SYMMETRIC);
        }
        Ok(Proposal::with_ratio(LogRatio::new(at.state.log_prior.value() - there.value())?))
    }

    fn log_ratio(&self, step: Transition<'_, T>) -> Result<LogRatio, ModelError> {
        Ok(LogRatio::new(step.from.log_prior.value() - step.to.log_prior.value())?)
    }
}

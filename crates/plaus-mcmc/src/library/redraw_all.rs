//! A new draw of everything.

use crate::law::Recipe;
use crate::moves::{At, Move, Proposal, Transition};
use crate::target::ModelError;
use crate::vars::{Variables, log_density};
use plaus_dist::{LogRatio, Stream};

/// A fresh draw of the prior. The ratio is the old draw's prior density over the new one's, so that acceptance compares
/// the constraints alone.
#[derive(Debug, Clone, Copy)]
pub struct RedrawAll {
    /// The move's name.
    pub name: &'static str,
    /// Count as symmetric, as Chenney & Forsyth do (erratum; samples another law). Taken literally, the result would
    /// also depend on the units of variables that a draw may lack. For those variables the right ratio is kept.
    pub symmetric: bool,
    /// How offsets are drawn. With any recipe but the exact one they have another law.
    pub recipe: Recipe,
}

impl RedrawAll {
    /// The right move.
    #[must_use]
    pub fn exact(name: &'static str) -> Self {
        Self { name, symmetric: false, recipe: Recipe::Exact }
    }

    /// The part of the ratio that the printed version needs where the number of dimensions changes.
    fn printed<T: Variables>(target: &T, from: &T::Draw, to: &T::Draw) -> Result<LogRatio, ModelError> {
        let optional = (0..target.vars().len()).filter(|&var| target.vars().get(var).optional);
        optional.into_iter().try_fold(LogRatio::ONE, |ratio, var| {
            let of = LogRatio::of(log_density(target, from, var)?, log_density(target, to, var)?)?;
            Ok(ratio.times(of)?)
        })
    }
}

impl<T: Variables> Move<T> for RedrawAll {
    fn name(&self) -> &str {
        self.name
    }

    fn propose(&self, at: At<'_, T>, candidate: &mut T::Draw, stream: &mut Stream) -> Result<Proposal, ModelError> {
        at.target.renew_all(candidate, self.recipe, stream);
        if self.symmetric {
            return Ok(Proposal::with_ratio(Self::printed(at.target, at.state.draw, candidate)?));
        }
        let there = at.target.log_prior(candidate)?;
        if there.is_zero() {
            // The chain rejects it for its prior; no ratio is needed.
            return Ok(Proposal::SYMMETRIC);
        }
        // Not the log prior that the state holds: if a view lends this move, that is the view's prior.
        Ok(Proposal::with_ratio(LogRatio::of(at.target.log_prior(at.state.draw)?, there)?))
    }

    fn log_ratio(&self, step: Transition<'_, T>) -> Result<LogRatio, ModelError> {
        if self.symmetric {
            return Self::printed(step.target, step.from.draw, step.to.draw);
        }
        Ok(LogRatio::of(step.target.log_prior(step.from.draw)?, step.target.log_prior(step.to.draw)?)?)
    }
}

//! Everything anew.

use crate::bowling::{Bowling, Shot};
use plaus_dist::{LogRatio, Stream};
use plaus_mcmc::{ModelError, Move, Path, Proposal, StateOf, Target};

/// A fresh draw of the prior. The ratio is the old draw's prior density over the new one's, so that acceptance compares
/// the constraint alone.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct ChangeAll {
    /// Count as symmetric, as the paper does (erratum; samples another law).
    pub symmetric: bool,
    /// Set pins in a random direction at a Gaussian distance, as the paper prints it (erratum: not the prior).
    pub radial_offsets: bool,
}

impl ChangeAll {
    fn ratio(self, target: &Bowling, from: &Shot, to: &Shot) -> Result<LogRatio, ModelError> {
        if self.symmetric {
            return Ok(LogRatio::ONE);
        }
        Ok(LogRatio::of(target.log_prior(from)?, target.log_prior(to)?)?)
    }
}

impl Move<Bowling> for ChangeAll {
    fn name(&self) -> &'static str {
        "change_all"
    }

    fn propose(
        &self,
        target: &Bowling,
        current: &StateOf<Bowling>,
        candidate: &mut Shot,
        stream: &mut Stream,
    ) -> Result<Proposal, ModelError> {
        target.prior().sample(self.radial_offsets, candidate, stream);
        Ok(Proposal::with_ratio(self.ratio(target, &current.draw, candidate)?))
    }

    fn log_ratio(
        &self,
        target: &Bowling,
        from: &StateOf<Bowling>,
        to: &StateOf<Bowling>,
        _: Path,
    ) -> Result<LogRatio, ModelError> {
        self.ratio(target, &from.draw, &to.draw)
    }
}

//! Everything anew.

use crate::spelling::{Drops, Spelling};
use plaus_dist::{LogRatio, Stream, math};
use plaus_mcmc::{ModelError, Move, Path, Proposal, StateOf, Target};

/// A fresh draw of the prior: all vertices, which balls are dropped, and where. The ratio is the old draw's prior
/// density over the new one's, so that acceptance compares the constraint alone.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct ChangeAll {
    /// Count as symmetric, as the paper does (erratum; samples another law). Taken at its word that would also depend
    /// on the unit of area, by the number of balls: with mm² a chain finds the box emptied by every such move. So the
    /// area of the drop rectangle is the unit here; the vertices alone tell.
    pub symmetric: bool,
    /// Draw offsets in a random direction with a Gaussian length, as the paper prints it (erratum: not the prior).
    pub radial_offsets: bool,
}

impl ChangeAll {
    fn ratio(self, target: &Spelling, from: &Drops, to: &Drops) -> Result<LogRatio, ModelError> {
        if self.symmetric {
            // Each ball's 1/a cancels, as if the rectangle's area were the unit of area.
            let balls = to.active() as f64 - from.active() as f64;
            return Ok(LogRatio::new(balls * math::ln(target.prior().area()))?);
        }
        Ok(LogRatio::of(target.log_prior(from)?, target.log_prior(to)?)?)
    }
}

impl Move<Spelling> for ChangeAll {
    fn name(&self) -> &'static str {
        "change_all"
    }

    fn propose(
        &self,
        target: &Spelling,
        current: &StateOf<Spelling>,
        candidate: &mut Drops,
        stream: &mut Stream,
    ) -> Result<Proposal, ModelError> {
        target.prior().sample(self.radial_offsets, candidate, stream);
        Ok(Proposal::with_ratio(self.ratio(target, &current.draw, candidate)?))
    }

    fn log_ratio(
        &self,
        target: &Spelling,
        from: &StateOf<Spelling>,
        to: &StateOf<Spelling>,
        _: Path,
    ) -> Result<LogRatio, ModelError> {
        self.ratio(target, &from.draw, &to.draw)
    }
}

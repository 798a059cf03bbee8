//! Everything anew.

use crate::dice::{Dice, Draw};
use plaus_dist::{LogRatio, Stream};
use plaus_mcmc::{ModelError, Move, Path, Proposal, StateOf, Target};

/// A fresh draw of the prior: all throws, and all tables. The ratio is the old draw's prior density over the new one's,
/// so that acceptance compares the constraints alone.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Everything {
    /// Count as symmetric, as the paper does (erratum; samples another law). The throws alone tell: over all the
    /// tables' points the printed ratio has no value, and those that no die touches would decide it.
    pub symmetric: bool,
}

impl Everything {
    fn ratio(self, target: &Dice, from: &Draw, to: &Draw) -> Result<LogRatio, ModelError> {
        if self.symmetric {
            return Ok(LogRatio::ONE);
        }
        Ok(LogRatio::of(target.log_prior(from)?, target.log_prior(to)?)?)
    }
}

impl Move<Dice> for Everything {
    fn name(&self) -> &'static str {
        "everything"
    }

    fn propose(
        &self,
        target: &Dice,
        current: &StateOf<Dice>,
        candidate: &mut Draw,
        stream: &mut Stream,
    ) -> Result<Proposal, ModelError> {
        let (dice, tables) = (candidate.throws.len(), candidate.tables.len());
        for die in 0..dice {
            candidate.throws[die] = target.prior().throw(die, stream);
        }
        (0..tables).for_each(|table| candidate.tables[table].renew(stream));
        Ok(Proposal::with_ratio(self.ratio(target, &current.draw, candidate)?))
    }

    fn log_ratio(
        &self,
        target: &Dice,
        from: &StateOf<Dice>,
        to: &StateOf<Dice>,
        _: Path,
    ) -> Result<LogRatio, ModelError> {
        self.ratio(target, &from.draw, &to.draw)
    }
}

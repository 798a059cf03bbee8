//! Another face.

use crate::dice::{Dice, Draw};
use plaus_dist::stream::below;
use plaus_dist::{LogRatio, Stream};
use plaus_mcmc::{ModelError, Move, Path, Proposal, StateOf};

/// One die's pips are turned by another of the rotations that leave its body as it is, each as likely: the throw begins
/// in another orientation, the body moves as before bit by bit, and another face comes up. Symmetric. A cube has 24
/// such rotations, a cuboid with two equal edges 8, any other 4: a face of a cuboid comes up only in place of one of
/// its size.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Turn;

impl Move<Dice> for Turn {
    fn name(&self) -> &'static str {
        "turn"
    }

    fn propose(
        &self,
        target: &Dice,
        _: &StateOf<Dice>,
        candidate: &mut Draw,
        stream: &mut Stream,
    ) -> Result<Proposal, ModelError> {
        let die = below(stream, candidate.throws.len());
        let (turns, turn) = (target.plan.rotations.len(), &mut candidate.throws[die].turn);
        // Any but the current one.
        let other = 1 + below(stream, turns - 1);
        *turn = ((usize::from(*turn) + other) % turns) as u8;
        Ok(Proposal::SYMMETRIC)
    }

    fn log_ratio(&self, _: &Dice, _: &StateOf<Dice>, _: &StateOf<Dice>, _: Path) -> Result<LogRatio, ModelError> {
        Ok(LogRatio::ONE)
    }
}

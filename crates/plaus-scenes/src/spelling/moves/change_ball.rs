//! One ball shifted.

use super::shift;
use crate::spelling::{Drops, Spelling};
use plaus_dist::stream::below;
use plaus_dist::{LogRatio, Stream};
use plaus_mcmc::{ModelError, Move, Path, Proposal, StateOf};

/// One of the balls that are dropped, each as likely, is dropped elsewhere: shifted in a random direction by a length
/// N(0, `sd`) mm, leaving the rectangle on one side and entering it on the other. Symmetric. Without any such ball the
/// chain stays.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ChangeBall {
    /// Standard deviation of the length, mm.
    pub sd: f64,
}

impl Move<Spelling> for ChangeBall {
    fn name(&self) -> &'static str {
        "change_ball"
    }

    fn propose(
        &self,
        target: &Spelling,
        current: &StateOf<Spelling>,
        candidate: &mut Drops,
        stream: &mut Stream,
    ) -> Result<Proposal, ModelError> {
        let chosen = below(stream, current.draw.active());
        let Some(position) = candidate.balls.iter_mut().flatten().nth(chosen) else { return Ok(Proposal::Stay) };
        let step: [f64; 2] = shift(self.sd, stream);
        let ring = target.prior().wrapped();
        *position = std::array::from_fn(|axis| ring[axis].wrap(position[axis] + step[axis]));
        Ok(Proposal::SYMMETRIC)
    }

    fn log_ratio(
        &self,
        _: &Spelling,
        _: &StateOf<Spelling>,
        _: &StateOf<Spelling>,
        _: Path,
    ) -> Result<LogRatio, ModelError> {
        Ok(LogRatio::ONE)
    }
}

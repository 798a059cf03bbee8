//! Two balls exchanged.

use crate::spelling::{Drops, Spelling};
use plaus_dist::stream::below;
use plaus_dist::{LogRatio, Stream};
use plaus_mcmc::{ModelError, Move, Path, Proposal, StateOf};

/// Two balls, each pair as likely, exchange where they are dropped, or that they are not. Symmetric, and of equal prior
/// density: what changes is the order in which balls fall, so that they mostly land where the other did.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Swap;

impl Move<Spelling> for Swap {
    fn name(&self) -> &'static str {
        "swap"
    }

    fn propose(
        &self,
        _: &Spelling,
        _: &StateOf<Spelling>,
        candidate: &mut Drops,
        stream: &mut Stream,
    ) -> Result<Proposal, ModelError> {
        let count = candidate.balls.len();
        let (a, b) = (below(stream, count), below(stream, count));
        if candidate.balls[a] == candidate.balls[b] {
            return Ok(Proposal::Stay);
        }
        candidate.balls.swap(a, b);
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

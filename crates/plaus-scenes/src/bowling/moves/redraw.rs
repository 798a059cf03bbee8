//! One quantity of the ball anew.

use crate::bowling::{Bowling, Quantity, Shot};
use plaus_dist::stream::below;
use plaus_dist::{LogRatio, Stream};
use plaus_mcmc::{ModelError, Move, Path, Proposal, StateOf};

/// One uncertain quantity, each as likely, is drawn anew from its law. Ratio: density of the old value over that of the
/// new one. A new radius may leave the ball inside the lane; such a draw has density 0. Without any uncertain quantity
/// the chain stays.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Redraw {
    /// Count as symmetric, as the paper treats moves of this kind (erratum; samples another law).
    pub symmetric: bool,
}

impl Redraw {
    fn ratio(self, target: &Bowling, quantity: Quantity, from: &Shot, to: &Shot) -> Result<LogRatio, ModelError> {
        if self.symmetric {
            return Ok(LogRatio::ONE);
        }
        let laws = target.prior().laws();
        Ok(LogRatio::of(laws.log_density(quantity, &from.ball)?, laws.log_density(quantity, &to.ball)?)?)
    }
}

impl Move<Bowling> for Redraw {
    fn name(&self) -> &'static str {
        "redraw"
    }

    fn propose(
        &self,
        target: &Bowling,
        current: &StateOf<Bowling>,
        candidate: &mut Shot,
        stream: &mut Stream,
    ) -> Result<Proposal, ModelError> {
        let laws = target.prior().laws();
        let chosen = below(stream, laws.uncertain().count());
        let Some(quantity) = laws.uncertain().nth(chosen) else { return Ok(Proposal::Stay) };
        candidate.ball[quantity as usize] = laws.sample(quantity, &candidate.ball, stream);
        let log_ratio = self.ratio(target, quantity, &current.draw, candidate)?;
        Ok(Proposal::Candidate { log_ratio, path: Path(quantity as u64), later: None })
    }

    fn log_ratio(
        &self,
        target: &Bowling,
        from: &StateOf<Bowling>,
        to: &StateOf<Bowling>,
        path: Path,
    ) -> Result<LogRatio, ModelError> {
        self.ratio(target, Quantity::ALL[path.0 as usize], &from.draw, &to.draw)
    }
}

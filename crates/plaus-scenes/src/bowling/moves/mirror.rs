//! Left and right exchanged.

use crate::bowling::{Bowling, Quantity, Shot};
use plaus_dist::{LogRatio, Stream};
use plaus_mcmc::{ModelError, Move, Path, Proposal, StateOf};

/// The whole shot as seen in a mirror along the lane. It is its own reverse and keeps volumes, hence symmetric; where
/// the delivery's laws are not the same from both sides, the prior says so. Where the pins that are set up, or those to
/// be left, are not the same in the mirror, the chain stays: the mirrored shot is an answer to another question.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Mirror;

impl Move<Bowling> for Mirror {
    fn name(&self) -> &'static str {
        "mirror"
    }

    fn propose(
        &self,
        target: &Bowling,
        current: &StateOf<Bowling>,
        candidate: &mut Shot,
        _: &mut Stream,
    ) -> Result<Proposal, ModelError> {
        let Some(order) = target.rack().mirrored() else { return Ok(Proposal::Stay) };
        for quantity in Quantity::ALL {
            candidate.ball[quantity as usize] = quantity.mirrored(current.draw.get(quantity));
        }
        for (offset, &other) in candidate.pins.iter_mut().zip(order) {
            let [x, y] = current.draw.pins[other];
            *offset = [-x, y];
        }
        Ok(Proposal::SYMMETRIC)
    }

    fn log_ratio(
        &self,
        _: &Bowling,
        _: &StateOf<Bowling>,
        _: &StateOf<Bowling>,
        _: Path,
    ) -> Result<LogRatio, ModelError> {
        Ok(LogRatio::ONE)
    }
}

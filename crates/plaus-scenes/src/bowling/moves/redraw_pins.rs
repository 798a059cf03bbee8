//! Some pins set anew.

use crate::bowling::{Bowling, Shot};
use plaus_dist::{LogRatio, Stream, open_unit};
use plaus_mcmc::{ModelError, Move, Path, Proposal, StateOf};

/// Each pin, with probability `chance`, is set anew from its law. Ratio: density of the old offsets over that of the
/// new ones; pins that stay cancel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RedrawPins {
    /// Probability that a pin is set anew.
    pub chance: f64,
}

impl RedrawPins {
    fn ratio(target: &Bowling, from: &Shot, to: &Shot) -> Result<LogRatio, ModelError> {
        let mut ratio = LogRatio::ONE;
        for (old, new) in from.pins.iter().zip(&to.pins) {
            ratio = ratio.times(LogRatio::of(target.prior().log_offset(old)?, target.prior().log_offset(new)?)?)?;
        }
        Ok(ratio)
    }
}

impl Move<Bowling> for RedrawPins {
    fn name(&self) -> &'static str {
        "redraw_pins"
    }

    fn propose(
        &self,
        target: &Bowling,
        current: &StateOf<Bowling>,
        candidate: &mut Shot,
        stream: &mut Stream,
    ) -> Result<Proposal, ModelError> {
        for offset in &mut candidate.pins {
            if open_unit(stream) < self.chance {
                *offset = target.prior().offset(stream);
            }
        }
        if candidate.pins == current.draw.pins {
            return Ok(Proposal::Stay);
        }
        Ok(Proposal::with_ratio(Self::ratio(target, &current.draw, candidate)?))
    }

    fn log_ratio(
        &self,
        target: &Bowling,
        from: &StateOf<Bowling>,
        to: &StateOf<Bowling>,
        _: Path,
    ) -> Result<LogRatio, ModelError> {
        Self::ratio(target, &from.draw, &to.draw)
    }
}

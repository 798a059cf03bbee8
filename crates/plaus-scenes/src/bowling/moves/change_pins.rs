//! Some pins shifted.

use crate::bowling::{Bowling, Shot};
use crate::walk;
use plaus_dist::{LogRatio, Stream, open_unit};
use plaus_mcmc::{ModelError, Move, Path, Proposal, Scale, StateOf};

/// Each pin, with probability `chance`, is shifted in a random direction by a length N(0, `sd`) mm. Symmetric.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ChangePins {
    /// Probability that a pin is shifted.
    pub chance: f64,
    /// Standard deviation of the length, mm.
    pub sd: f64,
}

impl Move<Bowling> for ChangePins {
    fn name(&self) -> &'static str {
        "change_pins"
    }

    fn propose(
        &self,
        _: &Bowling,
        current: &StateOf<Bowling>,
        candidate: &mut Shot,
        stream: &mut Stream,
    ) -> Result<Proposal, ModelError> {
        for offset in &mut candidate.pins {
            if open_unit(stream) < self.chance {
                let by: [f64; 2] = walk::shift(self.sd, stream);
                *offset = [offset[0] + by[0], offset[1] + by[1]];
            }
        }
        Ok(if candidate.pins == current.draw.pins { Proposal::Stay } else { Proposal::SYMMETRIC })
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

    /// The standard deviation, mm.
    fn scales(&self) -> Vec<Scale> {
        vec![Scale { name: "step", start: self.sd, least: 1e-6 * self.sd, most: 1e3 * self.sd, target: Scale::MANY }]
    }

    fn at_scales(&self, values: &[Option<f64>]) -> Option<Box<dyn Move<Bowling>>> {
        Some(Box::new(Self { sd: values.first().copied().flatten().unwrap_or(self.sd), ..*self }))
    }
}

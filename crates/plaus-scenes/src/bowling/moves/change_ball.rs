//! Some quantities of the ball shifted.

use super::shift;
use crate::bowling::{Bowling, Quantity, Shot, Steps};
use plaus_dist::{LogRatio, Stream};
use plaus_mcmc::{ModelError, Move, Path, Proposal, Scale, StateOf};

/// Each of the quantities is shifted by a Gaussian step: by `steps.gaussian` of its law's standard deviation, or
/// `steps.uniform` of its interval, which it leaves on one side to enter it on the other. Symmetric. Where none of them
/// is uncertain the chain stays.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ChangeBall {
    /// The move's name.
    pub name: &'static str,
    /// What is shifted.
    pub quantities: &'static [Quantity],
    /// Sizes of the steps.
    pub steps: Steps,
    /// By how much they are longer.
    pub factor: f64,
}

impl Move<Bowling> for ChangeBall {
    fn name(&self) -> &str {
        self.name
    }

    fn propose(
        &self,
        target: &Bowling,
        current: &StateOf<Bowling>,
        candidate: &mut Shot,
        stream: &mut Stream,
    ) -> Result<Proposal, ModelError> {
        for &quantity in self.quantities {
            shift(target, quantity, &self.steps, self.factor, candidate, stream);
        }
        Ok(if candidate.ball == current.draw.ball { Proposal::Stay } else { Proposal::SYMMETRIC })
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

    fn scales(&self) -> Vec<Scale> {
        let target = if self.quantities.len() > 1 { Scale::MANY } else { Scale::ONE };
        vec![Scale { name: "step", start: 1.0, least: 1e-6, most: 1e3, target }]
    }

    fn at_scales(&self, values: &[Option<f64>]) -> Option<Box<dyn Move<Bowling>>> {
        Some(Box::new(Self { factor: values.first().copied().flatten().unwrap_or(1.0), ..*self }))
    }
}

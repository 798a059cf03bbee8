//! Everything shifted a little.

use super::shift;
use crate::bowling::{Bowling, Shot, Steps};
use crate::walk;
use plaus_dist::{LogRatio, Stream, math, open_unit};
use plaus_mcmc::{ModelError, Move, Path, Proposal, Scale, StateOf};

/// All quantities of the ball and all pins are shifted by their usual steps times one factor, whose logarithm is
/// uniform between that of `steps.finest` and 0. Symmetric, since the factor does not depend on the state. What pins do
/// after many collisions changes with the slightest change of the delivery: small factors find what stays.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Refine {
    /// Sizes of the steps.
    pub steps: Steps,
    /// A factor that was adapted: steps are mostly that long, within a factor e.
    pub about: Option<f64>,
}

/// Path of a step about the adapted factor.
const ADAPTED: Path = Path(1);

impl Move<Bowling> for Refine {
    fn name(&self) -> &'static str {
        "refine"
    }

    fn propose(
        &self,
        target: &Bowling,
        _: &StateOf<Bowling>,
        candidate: &mut Shot,
        stream: &mut Stream,
    ) -> Result<Proposal, ModelError> {
        let (factor, path) = match self.about {
            Some(about) if open_unit(stream) >= walk::WIDE_SHARE => {
                (about * math::exp(walk::NARROW * (2.0 * open_unit(stream) - 1.0)), ADAPTED)
            }
            _ => (math::exp(open_unit(stream) * math::ln(self.steps.finest)), Path(0)),
        };
        for quantity in target.prior().laws().uncertain() {
            shift(target, quantity, &self.steps, factor, candidate, stream);
        }
        for offset in &mut candidate.pins {
            let by: [f64; 2] = walk::shift(factor * self.steps.pin_mm, stream);
            *offset = [offset[0] + by[0], offset[1] + by[1]];
        }
        Ok(Proposal::Candidate { log_ratio: LogRatio::ONE, path, later: None })
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
        let least = self.steps.finest.min(1.0);
        vec![Scale { name: "factor", start: least.sqrt(), least, most: 1.0, target: Scale::MANY }]
    }

    fn at_scales(&self, values: &[Option<f64>]) -> Option<Box<dyn Move<Bowling>>> {
        Some(Box::new(Self { about: values.first().copied().flatten(), ..*self }))
    }

    fn scale_of(&self, path: Path) -> Option<usize> {
        (path == ADAPTED).then_some(0)
    }
}

//! Everything shifted a little.

use super::shift;
use crate::bowling::{Bowling, Shot, Steps};
use crate::walk;
use plaus_dist::{LogRatio, Stream, math, open_unit};
use plaus_mcmc::{ModelError, Move, Path, Proposal, StateOf};

/// All quantities of the ball and all pins are shifted by their usual steps times one factor, whose logarithm is uniform between that of `steps.finest` and 0. Symmetric, since
/// the factor does not depend on the state. What pins do after many collisions changes with the slightest change of the delivery: small factors find what stays.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Refine {
    /// Sizes of the steps.
    pub steps: Steps,
}

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
        let factor = math::exp(open_unit(stream) * math::ln(self.steps.finest));
        for quantity in target.prior().laws().uncertain() {
            shift(target, quantity, &self.steps, factor, candidate, stream);
        }
        for offset in &mut candidate.pins {
            let by: [f64; 2] = walk::shift(factor * self.steps.pin_mm, stream);
            *offset = [offset[0] + by[0], offset[1] + by[1]];
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

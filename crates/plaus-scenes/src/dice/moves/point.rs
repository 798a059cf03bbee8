//! One control point, anywhere.

use super::{Scale, change, path};
use crate::dice::{Dice, Draw, Site};
use plaus_dist::stream::below;
use plaus_dist::{LogRatio, Stream};
use plaus_mcmc::{ModelError, Move, Path, Proposal, StateOf};

/// The paper's move: one control point of one table, each as likely, makes a step that leaves its law as it is. Most points are far from any die.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Point {
    /// Sizes of the steps.
    pub scale: Scale,
}

impl Move<Dice> for Point {
    fn name(&self) -> &'static str {
        "point"
    }

    fn propose(
        &self,
        target: &Dice,
        _: &StateOf<Dice>,
        candidate: &mut Draw,
        stream: &mut Stream,
    ) -> Result<Proposal, ModelError> {
        let Some(&field) = target.fields().get(below(stream, target.fields().len())) else { return Ok(Proposal::Stay) };
        let table = below(stream, candidate.tables.len());
        let [i, j] = target.plan.reach().map(|far| below(stream, 2 * far as usize + 1) as i32 - far);
        let site = Site { field, i, j };
        if !change(candidate, table, site, self.scale, stream) {
            return Ok(Proposal::with_ratio(LogRatio::ZERO));
        }
        Ok(Proposal::Candidate { log_ratio: LogRatio::ONE, path: path(table, site), later: None })
    }

    /// The step leaves the law of the point as it is, with respect to which densities are taken.
    fn log_ratio(&self, _: &Dice, _: &StateOf<Dice>, _: &StateOf<Dice>, _: Path) -> Result<LogRatio, ModelError> {
        Ok(LogRatio::ONE)
    }
}

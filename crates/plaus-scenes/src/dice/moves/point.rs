//! One control point, anywhere.

use super::{about, change, declared, site};
use crate::dice::{Dice, Draw, Site};
use plaus_dist::stream::below;
use plaus_dist::{LogRatio, Stream};
use plaus_mcmc::library::{Sizes, is_adapted};
use plaus_mcmc::{At, ModelError, Move, Path, Proposal, Transition};

/// The paper's move: changes one control point of one table, all equally likely, by a step that preserves its law. Most
/// points are far from any die.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Point {
    /// Sizes of the steps, of heights, restitutions and frictions.
    pub scales: [Sizes; 3],
}

impl Point {
    /// The same sizes for all.
    #[must_use]
    pub fn new(sizes: Sizes) -> Self {
        Self { scales: [sizes; 3] }
    }
}

impl Move<Dice> for Point {
    fn name(&self) -> &'static str {
        "point"
    }

    fn propose(&self, at: At<'_, Dice>, candidate: &mut Draw, stream: &mut Stream) -> Result<Proposal, ModelError> {
        let Some(&field) = at.target.fields().get(below(stream, at.target.fields().len())) else {
            return Ok(Proposal::Stay);
        };
        let table = below(stream, candidate.tables.len());
        let [i, j] = at.target.plan.reach().map(|far| below(stream, 2 * far as usize + 1) as i32 - far);
        let site = Site { field, i, j };
        let (path, is_possible) = change(candidate, table, site, self.scales[field as usize], stream);
        if !is_possible {
            return Ok(Proposal::Candidate { log_ratio: LogRatio::ZERO, path, later: None });
        }
        Ok(Proposal::Candidate { log_ratio: LogRatio::ONE, path, later: None })
    }

    /// The step preserves the law of the point, with respect to which densities are taken.
    fn log_ratio(&self, _: Transition<'_, Dice>) -> Result<LogRatio, ModelError> {
        Ok(LogRatio::ONE)
    }

    fn scales(&self) -> Vec<plaus_mcmc::Scale> {
        declared(&self.scales)
    }

    fn at_scales(&self, values: &[Option<f64>]) -> Option<Box<dyn Move<Dice>>> {
        Some(Box::new(Self { scales: about(self.scales, values) }))
    }

    fn scale_of(&self, path: Path) -> Option<usize> {
        is_adapted(path).then(|| site(path).1.field as usize)
    }
}

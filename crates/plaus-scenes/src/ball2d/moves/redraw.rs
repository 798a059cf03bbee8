//! Redraw of one normal.

use crate::ball2d::{Ball2d, Normals};
use plaus_dist::stream::below;
use plaus_dist::{Density, LogRatio, Sample, Stream};
use plaus_mcmc::{ModelError, Move, Path, Proposal, StateOf};

/// One angle, each as likely, is drawn anew from its prior. Ratio: prior of the old angle over prior of the new one. It
/// frees chains from solutions with an unlikely normal that no small step improves.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Redraw {
    /// Count as symmetric, as the paper treats moves of this kind (erratum; samples another law).
    pub symmetric: bool,
}

impl Redraw {
    fn ratio(self, target: &Ball2d, old: f64, new: f64) -> Result<LogRatio, ModelError> {
        if self.symmetric {
            return Ok(LogRatio::ONE);
        }
        Ok(LogRatio::of(target.angle().log_density(&old)?, target.angle().log_density(&new)?)?)
    }
}

impl Move<Ball2d> for Redraw {
    fn name(&self) -> &'static str {
        "redraw"
    }

    fn propose(
        &self,
        target: &Ball2d,
        current: &StateOf<Ball2d>,
        candidate: &mut Normals,
        stream: &mut Stream,
    ) -> Result<Proposal, ModelError> {
        let index = below(stream, candidate.0.len());
        let new = target.angle().sample(stream);
        candidate.0[index] = new;
        let log_ratio = self.ratio(target, current.draw.0[index], new)?;
        Ok(Proposal::Candidate { log_ratio, path: Path(index as u64), later: None })
    }

    fn log_ratio(
        &self,
        target: &Ball2d,
        from: &StateOf<Ball2d>,
        to: &StateOf<Ball2d>,
        path: Path,
    ) -> Result<LogRatio, ModelError> {
        let index = path.0 as usize;
        self.ratio(target, from.draw.0[index], to.draw.0[index])
    }
}

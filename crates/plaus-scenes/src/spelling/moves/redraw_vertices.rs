//! Some vertices anew.

use super::happens;
use crate::spelling::{Drops, Spelling};
use plaus_dist::{LogRatio, Stream};
use plaus_mcmc::{ModelError, Move, Path, Proposal, StateOf, Target};

/// Each vertex, with probability `chance`, is drawn anew from its prior. The ratio is the old offsets' prior density
/// over the new ones', so that acceptance compares the constraint alone: most vertices matter to few balls, and forget
/// at once where small steps need thousands.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RedrawVertices {
    /// Probability that a vertex is drawn anew.
    pub chance: f64,
}

impl Move<Spelling> for RedrawVertices {
    fn name(&self) -> &'static str {
        "redraw_vertices"
    }

    fn propose(
        &self,
        target: &Spelling,
        current: &StateOf<Spelling>,
        candidate: &mut Drops,
        stream: &mut Stream,
    ) -> Result<Proposal, ModelError> {
        let mut any = false;
        for offset in &mut candidate.offsets {
            if happens(self.chance, stream) {
                *offset = target.prior().offset(stream);
                any = true;
            }
        }
        if !any {
            return Ok(Proposal::Stay);
        }
        Ok(Proposal::with_ratio(LogRatio::of(current.log_prior, target.log_prior(candidate)?)?))
    }

    fn log_ratio(
        &self,
        target: &Spelling,
        from: &StateOf<Spelling>,
        to: &StateOf<Spelling>,
        _: Path,
    ) -> Result<LogRatio, ModelError> {
        Ok(LogRatio::of(target.log_prior(&from.draw)?, target.log_prior(&to.draw)?)?)
    }
}

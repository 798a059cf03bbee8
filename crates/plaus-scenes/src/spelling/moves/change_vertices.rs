//! Some vertices shifted.

use super::{happens, shift};
use crate::spelling::{Drops, Spelling};
use plaus_dist::{LogRatio, Stream};
use plaus_mcmc::{ModelError, Move, Path, Proposal, StateOf};

/// Each vertex, with probability `chance`, is shifted in a random direction by a length N(0, `sd`) mm. Symmetric.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ChangeVertices {
    /// Probability that a vertex is shifted.
    pub chance: f64,
    /// Standard deviation of the length, mm.
    pub sd: f64,
}

impl Move<Spelling> for ChangeVertices {
    fn name(&self) -> &'static str {
        "change_vertices"
    }

    fn propose(
        &self,
        _: &Spelling,
        _: &StateOf<Spelling>,
        candidate: &mut Drops,
        stream: &mut Stream,
    ) -> Result<Proposal, ModelError> {
        let mut any = false;
        for offset in &mut candidate.offsets {
            if happens(self.chance, stream) {
                let step: [f64; 3] = shift(self.sd, stream);
                *offset = std::array::from_fn(|axis| offset[axis] + step[axis]);
                any = true;
            }
        }
        Ok(if any { Proposal::SYMMETRIC } else { Proposal::Stay })
    }

    fn log_ratio(
        &self,
        _: &Spelling,
        _: &StateOf<Spelling>,
        _: &StateOf<Spelling>,
        _: Path,
    ) -> Result<LogRatio, ModelError> {
        Ok(LogRatio::ONE)
    }
}

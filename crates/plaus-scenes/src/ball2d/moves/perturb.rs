//! The paper's move.

use crate::ball2d::{Ball2d, Normals};
use plaus_dist::{LogRatio, Stream, open_unit};
use plaus_mcmc::{ModelError, Move, Path, Proposal, Scale, StateOf};
use rand::Rng;

/// Every angle, with probability ½, gets a step uniform on (−`half_width`, `half_width`) degrees (paper, section
/// 5.1.2). Symmetric.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Perturb {
    half_width: f64,
}

impl Perturb {
    /// `half_width` in degrees.
    #[must_use]
    pub fn new(half_width: f64) -> Self {
        Self { half_width }
    }
}

impl Move<Ball2d> for Perturb {
    fn name(&self) -> &'static str {
        "perturb"
    }

    fn propose(
        &self,
        _: &Ball2d,
        _: &StateOf<Ball2d>,
        candidate: &mut Normals,
        stream: &mut Stream,
    ) -> Result<Proposal, ModelError> {
        let chosen = stream.next_u64();
        // One bit an angle says whether it moves; 64 bits are enough for the most collisions there are.
        for (bit, angle) in candidate.0.iter_mut().enumerate() {
            if (chosen >> bit) & 1 == 1 {
                *angle += self.half_width * (2.0 * open_unit(stream) - 1.0);
            }
        }
        Ok(if chosen.trailing_zeros() as usize >= candidate.0.len() { Proposal::Stay } else { Proposal::SYMMETRIC })
    }

    fn log_ratio(&self, _: &Ball2d, _: &StateOf<Ball2d>, _: &StateOf<Ball2d>, _: Path) -> Result<LogRatio, ModelError> {
        Ok(LogRatio::ONE)
    }

    /// The half-width in degrees. Half of the angles move at once.
    fn scales(&self) -> Vec<Scale> {
        let (start, least, most) = (self.half_width, 1e-3 * self.half_width, 1e3 * self.half_width);
        vec![Scale { name: "step", start, least, most, target: Scale::MANY }]
    }

    fn at_scales(&self, values: &[Option<f64>]) -> Option<Box<dyn Move<Ball2d>>> {
        Some(Box::new(Self::new(values.first().copied().flatten().unwrap_or(self.half_width))))
    }
}

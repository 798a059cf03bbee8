//! A shift of some variables.

use super::{happens, walk_var};
use crate::moves::{At, Move, Proposal, Transition};
use crate::scale::Scale;
use crate::target::ModelError;
use crate::vars::Variables;
use plaus_dist::{LogRatio, Stream};

/// Each variable of a set is shifted with probability `chance`, by a length N(0, `sd`) in a random direction.
/// Symmetric.
#[derive(Debug, Clone)]
pub struct ShiftSome {
    /// The move's name.
    pub name: &'static str,
    /// The set.
    pub among: Vec<usize>,
    /// Probability that a variable is shifted.
    pub chance: f64,
    /// Standard deviation of the length, in the variables' unit.
    pub sd: f64,
    /// Whether a chain may adapt the standard deviation.
    pub adapts: bool,
}

impl<T: Variables> Move<T> for ShiftSome {
    fn name(&self) -> &str {
        self.name
    }

    fn propose(&self, at: At<'_, T>, candidate: &mut T::Draw, stream: &mut Stream) -> Result<Proposal, ModelError> {
        let mut any = false;
        for &var in &self.among {
            if happens(self.chance, stream) {
                any |= walk_var(at.target, candidate, var, self.sd, stream);
            }
        }
        Ok(if any { Proposal::SYMMETRIC } else { Proposal::Stay })
    }

    fn log_ratio(&self, _: Transition<'_, T>) -> Result<LogRatio, ModelError> {
        Ok(LogRatio::ONE)
    }

    /// The standard deviation.
    fn scales(&self) -> Vec<Scale> {
        let (start, least, most) = (self.sd, 1e-6 * self.sd, 1e3 * self.sd);
        let scale = Scale { name: "step", start, least, most, target: Scale::MANY };
        self.adapts.then_some(scale).into_iter().collect()
    }

    fn at_scales(&self, values: &[Option<f64>]) -> Option<Box<dyn Move<T>>> {
        let sd = values.first().copied().flatten().unwrap_or(self.sd);
        Some(Box::new(Self { sd, ..self.clone() }))
    }
}

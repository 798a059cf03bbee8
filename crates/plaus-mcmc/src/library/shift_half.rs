//! A shift of about half of the variables.

use crate::moves::{At, Move, Proposal, Transition};
use crate::scale::Scale;
use crate::target::ModelError;
use crate::vars::Variables;
use plaus_dist::{LogRatio, Stream, open_unit};
use rand::Rng;

/// Every number of a set of at most 64 variables, with probability ½, gets a step uniform on (−`half_width`,
/// `half_width`). Symmetric (Chenney & Forsyth 2000, section 5.1.2).
#[derive(Debug, Clone)]
pub struct ShiftHalf {
    /// The move's name.
    pub name: &'static str,
    /// The set; each of its variables is one number.
    pub among: Vec<usize>,
    /// In the variables' unit.
    pub half_width: f64,
}

impl<T: Variables> Move<T> for ShiftHalf {
    fn name(&self) -> &str {
        self.name
    }

    fn propose(&self, at: At<'_, T>, candidate: &mut T::Draw, stream: &mut Stream) -> Result<Proposal, ModelError> {
        let chosen = stream.next_u64();
        // One random bit per variable says whether it moves.
        for (bit, &var) in self.among.iter().enumerate() {
            if (chosen >> bit) & 1 == 1 {
                let step = self.half_width * (2.0 * open_unit(stream) - 1.0);
                if let Some(values) = at.target.get_mut(candidate, var) {
                    at.target.vars().get(var).law.add(&[step], values);
                }
            }
        }
        Ok(if chosen.trailing_zeros() as usize >= self.among.len() { Proposal::Stay } else { Proposal::SYMMETRIC })
    }

    fn log_ratio(&self, _: Transition<'_, T>) -> Result<LogRatio, ModelError> {
        Ok(LogRatio::ONE)
    }

    /// The half-width; half of the variables move at once.
    fn scales(&self) -> Vec<Scale> {
        let (start, least, most) = (self.half_width, 1e-3 * self.half_width, 1e3 * self.half_width);
        vec![Scale { name: "step", start, least, most, target: Scale::MANY }]
    }

    fn at_scales(&self, values: &[Option<f64>]) -> Option<Box<dyn Move<T>>> {
        let half_width = values.first().copied().flatten().unwrap_or(self.half_width);
        Some(Box::new(Self { half_width, ..self.clone() }))
    }
}

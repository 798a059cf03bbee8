//! A shift of all variables of a set.

use super::{Sizes, is_adapted, marked, walk};
use crate::moves::{At, Move, Path, Proposal, Transition};
use crate::scale::Scale;
use crate::target::ModelError;
use crate::vars::Variables;
use plaus_dist::{LogRatio, Stream, standard_normal};

/// A variable that is shifted, and the standard deviation of its usual step, as a multiple of a length.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stride {
    /// The variable.
    pub var: usize,
    /// The multiple.
    pub part: f64,
    /// The length, in the variable's unit.
    pub of: f64,
}

/// The length of a move's steps, relative to their usual length.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Factor {
    /// Always the same.
    One(f64),
    /// Drawn anew each time, the same for all variables.
    Many(Sizes),
}

/// All variables of a set are shifted by Gaussian steps, offsets in a random direction by a Gaussian length; variables
/// with joined ends go around. Symmetric, because the sizes do not depend on the state. The chain stays if the set is
/// empty.
#[derive(Debug, Clone)]
pub struct ShiftAll {
    name: &'static str,
    strides: Vec<Stride>,
    factor: Factor,
}

impl ShiftAll {
    /// By each stride's usual step.
    #[must_use]
    pub fn by(name: &'static str, strides: Vec<Stride>) -> Self {
        Self { name, strides, factor: Factor::One(1.0) }
    }

    /// By steps of many sizes. Where the slightest change alters much, small steps find changes that keep the outcome.
    #[must_use]
    pub fn at_many_scales(name: &'static str, strides: Vec<Stride>, sizes: Sizes) -> Self {
        Self { name, strides, factor: Factor::Many(sizes) }
    }
}

impl<T: Variables> Move<T> for ShiftAll {
    fn name(&self) -> &str {
        self.name
    }

    fn propose(&self, at: At<'_, T>, candidate: &mut T::Draw, stream: &mut Stream) -> Result<Proposal, ModelError> {
        if self.strides.is_empty() {
            return Ok(Proposal::Stay);
        }
        let (factor, is_wide) = match self.factor {
            Factor::One(factor) => (factor, false),
            Factor::Many(sizes) => sizes.sample(stream),
        };
        for &Stride { var, part, of } in &self.strides {
            let Some(values) = at.target.get_mut(candidate, var) else { continue };
            let sd = factor * part * of;
            let law = &at.target.vars().get(var).law;
            match values {
                [_] => law.add(&[sd * standard_normal(stream)], values),
                _ => law.add(&walk(sd, values.len(), stream), values),
            }
        }
        Ok(Proposal::Candidate { log_ratio: LogRatio::ONE, path: marked(Path(0), is_wide), later: None })
    }

    fn log_ratio(&self, _: Transition<'_, T>) -> Result<LogRatio, ModelError> {
        Ok(LogRatio::ONE)
    }

    fn scales(&self) -> Vec<Scale> {
        let target = if self.strides.len() > 1 { Scale::MANY } else { Scale::ONE };
        vec![match self.factor {
            Factor::One(start) => Scale { name: "step", start, least: 1e-6, most: 1e3, target },
            Factor::Many(sizes) => sizes.declared("factor", target),
        }]
    }

    fn at_scales(&self, values: &[Option<f64>]) -> Option<Box<dyn Move<T>>> {
        let value = values.first().copied().flatten();
        let factor = match self.factor {
            Factor::One(factor) => Factor::One(value.unwrap_or(factor)),
            Factor::Many(sizes) => Factor::Many(sizes.about(value)),
        };
        Some(Box::new(Self { factor, ..self.clone() }))
    }

    fn scale_of(&self, path: Path) -> Option<usize> {
        is_adapted(path).then_some(0)
    }
}

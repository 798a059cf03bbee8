//! An exchange of two variables.

use super::MOST;
use crate::moves::{At, Move, Proposal, Transition};
use crate::target::ModelError;
use crate::vars::Variables;
use plaus_dist::stream::below;
use plaus_dist::{LogRatio, Stream};

/// Two variables of a set, each pair equally likely, exchange their values; if the draw lacks one of them, it lacks the
/// other afterwards. Symmetric, and the prior density stays the same: only which variable has which value changes.
#[derive(Debug, Clone)]
pub struct Swap {
    /// The move's name.
    pub name: &'static str,
    /// The set; all its variables have one law.
    pub among: Vec<usize>,
}

/// A variable's values; `None` where the draw lacks it.
fn values<T: Variables>(target: &T, draw: &T::Draw, var: usize) -> Option<([f64; MOST], usize)> {
    let values = target.get(draw, var)?;
    let mut copy = [0.0; MOST];
    copy[..values.len()].copy_from_slice(values);
    Some((copy, values.len()))
}

/// Gives a variable these values, or takes it away.
fn put<T: Variables>(target: &T, draw: &mut T::Draw, var: usize, values: Option<([f64; MOST], usize)>) {
    if target.vars().get(var).optional {
        target.set_present(draw, var, values.is_some());
    }
    if let (Some((values, count)), Some(places)) = (values, target.get_mut(draw, var)) {
        places.copy_from_slice(&values[..count]);
    }
}

impl<T: Variables> Move<T> for Swap {
    fn name(&self) -> &str {
        self.name
    }

    fn propose(&self, at: At<'_, T>, candidate: &mut T::Draw, stream: &mut Stream) -> Result<Proposal, ModelError> {
        let count = self.among.len();
        let (a, b) = (below(stream, count), below(stream, count));
        let (Some(&a), Some(&b)) = (self.among.get(a), self.among.get(b)) else { return Ok(Proposal::Stay) };
        let (first, second) = (values(at.target, at.state.draw, a), values(at.target, at.state.draw, b));
        if first == second {
            return Ok(Proposal::Stay);
        }
        put(at.target, candidate, a, second);
        put(at.target, candidate, b, first);
        Ok(Proposal::SYMMETRIC)
    }

    fn log_ratio(&self, _: Transition<'_, T>) -> Result<LogRatio, ModelError> {
        Ok(LogRatio::ONE)
    }
}

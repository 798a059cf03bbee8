//! A shift of one variable.

use super::walk_var;
use crate::moves::{At, Move, Proposal, Transition};
use crate::target::ModelError;
use crate::vars::Variables;
use plaus_dist::stream::below;
use plaus_dist::{LogRatio, Stream};

/// One variable of a set, each of those that the draw has equally likely, is shifted by a length N(0, `sd`) in a random
/// direction. Symmetric. The chain stays if the draw has none of them.
#[derive(Debug, Clone)]
pub struct ShiftOne {
    /// The move's name.
    pub name: &'static str,
    /// The set.
    pub among: Vec<usize>,
    /// Standard deviation of the length, in the variables' unit.
    pub sd: f64,
}

impl<T: Variables> Move<T> for ShiftOne {
    fn name(&self) -> &str {
        self.name
    }

    fn propose(&self, at: At<'_, T>, candidate: &mut T::Draw, stream: &mut Stream) -> Result<Proposal, ModelError> {
        let present = || self.among.iter().filter(|&&var| at.target.get(at.state.draw, var).is_some());
        let chosen = below(stream, present().count());
        let Some(&var) = present().nth(chosen) else { return Ok(Proposal::Stay) };
        walk_var(at.target, candidate, var, self.sd, stream);
        Ok(Proposal::SYMMETRIC)
    }

    fn log_ratio(&self, _: Transition<'_, T>) -> Result<LogRatio, ModelError> {
        Ok(LogRatio::ONE)
    }
}

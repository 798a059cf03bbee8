//! A new draw of one variable.

use super::old_over_new;
use crate::law::Recipe;
use crate::moves::{At, Move, Path, Proposal, Transition};
use crate::target::ModelError;
use crate::vars::{Variables, renew};
use plaus_dist::stream::below;
use plaus_dist::{LogRatio, Stream};

/// One variable of a set, each equally likely, is drawn anew from its law given the others. Ratio: density of the old
/// value over that of the new one. It frees chains from solutions with an unlikely value that no small step improves.
/// The chain stays if the set is empty.
#[derive(Debug, Clone)]
pub struct RedrawOne {
    /// The move's name.
    pub name: &'static str,
    /// The set.
    pub among: Vec<usize>,
    /// Count as symmetric, as Chenney & Forsyth treat moves of this kind (erratum; samples another law).
    pub symmetric: bool,
}

impl<T: Variables> Move<T> for RedrawOne {
    fn name(&self) -> &str {
        self.name
    }

    fn propose(&self, at: At<'_, T>, candidate: &mut T::Draw, stream: &mut Stream) -> Result<Proposal, ModelError> {
        let Some(&var) = self.among.get(below(stream, self.among.len())) else { return Ok(Proposal::Stay) };
        renew(at.target, candidate, var, Recipe::Exact, stream);
        let log_ratio =
            if self.symmetric { LogRatio::ONE } else { old_over_new(at.target, &[var], at.state.draw, candidate)? };
        Ok(Proposal::Candidate { log_ratio, path: Path(var as u64), later: None })
    }

    fn log_ratio(&self, step: Transition<'_, T>) -> Result<LogRatio, ModelError> {
        if self.symmetric {
            return Ok(LogRatio::ONE);
        }
        old_over_new(step.target, &[step.path.0 as usize], step.from.draw, step.to.draw)
    }
}

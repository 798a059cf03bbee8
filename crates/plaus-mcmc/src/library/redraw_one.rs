//! A new draw of one variable.

use super::old_over_new;
use crate::law::Recipe;
use crate::moves::{Move, Path, Proposal};
use crate::target::{ModelError, StateRefOf};
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

    fn propose(
        &self,
        target: &T,
        current: StateRefOf<'_, T>,
        candidate: &mut T::Draw,
        stream: &mut Stream,
    ) -> Result<Proposal, ModelError> {
        let Some(&var) = self.among.get(below(stream, self.among.len())) else { return Ok(Proposal::Stay) };
        renew(target, candidate, var, Recipe::Exact, stream);
        let log_ratio =
            if self.symmetric { LogRatio::ONE } else { old_over_new(target, &[var], current.draw, candidate)? };
        Ok(Proposal::Candidate { log_ratio, path: Path(var as u64), later: None })
    }

    fn log_ratio(
        &self,
        target: &T,
        from: StateRefOf<'_, T>,
        to: StateRefOf<'_, T>,
        path: Path,
    ) -> Result<LogRatio, ModelError> {
        if self.symmetric {
            return Ok(LogRatio::ONE);
        }
        old_over_new(target, &[path.0 as usize], from.draw, to.draw)
    }
}

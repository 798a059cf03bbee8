//! A new draw of one body or part.

use super::old_over_new;
use crate::moves::{Move, Path, Proposal};
use crate::target::{ModelError, StateRefOf};
use crate::vars::Variables;
use plaus_dist::stream::below;
use plaus_dist::{LogRatio, Stream};

/// All variables of one body or part are drawn anew from their laws; each body or part is equally likely. Ratio:
/// density of the old values over that of the new ones. The chain stays if there are no groups.
#[derive(Debug, Clone, Copy)]
pub struct RedrawGroup {
    /// The move's name.
    pub name: &'static str,
}

impl<T: Variables> Move<T> for RedrawGroup {
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
        let groups = target.vars().groups();
        let chosen = below(stream, groups.len());
        let Some(vars) = groups.get(chosen) else { return Ok(Proposal::Stay) };
        target.renew_group(candidate, chosen, stream);
        let log_ratio = old_over_new(target, vars, current.draw, candidate)?;
        Ok(Proposal::Candidate { log_ratio, path: Path(chosen as u64), later: None })
    }

    fn log_ratio(
        &self,
        target: &T,
        from: StateRefOf<'_, T>,
        to: StateRefOf<'_, T>,
        path: Path,
    ) -> Result<LogRatio, ModelError> {
        old_over_new(target, &target.vars().groups()[path.0 as usize], from.draw, to.draw)
    }
}

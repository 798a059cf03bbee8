//! A new draw of one body or part.

use super::old_over_new;
use crate::moves::{At, Move, Path, Proposal, Transition};
use crate::target::ModelError;
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

    fn propose(&self, at: At<'_, T>, candidate: &mut T::Draw, stream: &mut Stream) -> Result<Proposal, ModelError> {
        let groups = at.target.vars().groups();
        let chosen = below(stream, groups.len());
        let Some(vars) = groups.get(chosen) else { return Ok(Proposal::Stay) };
        at.target.renew_group(candidate, chosen, stream);
        let log_ratio = old_over_new(at.target, vars, at.state.draw, candidate)?;
        Ok(Proposal::Candidate { log_ratio, path: Path(chosen as u64), later: None })
    }

    fn log_ratio(&self, step: Transition<'_, T>) -> Result<LogRatio, ModelError> {
        old_over_new(step.target, &step.target.vars().groups()[step.path.0 as usize], step.from.draw, step.to.draw)
    }
}

//! Moves of one impact that scatters.

use super::Custom;
use super::ending::Ending;
use super::values::Drawn;
use crate::uneven::{Site, impact_of_path, path_of_impact};
use plaus_dist::stream::below;
use plaus_dist::{LogRatio, Stream, math};
use plaus_mcmc::library::{Sizes, is_adapted, marked};
use plaus_mcmc::{At, ModelError, Move, Path, Proposal, Scale, StateRefOf, Transition};

/// Chooses two things that had impacts that scattered in the current motion, one of these impacts, and changes its
/// scores: draws them anew, or by a step that preserves their law. (All impacts equally likely would seldom be one that
/// matters where something rattles.)
///
/// Up to that impact the motion stays, so it takes place in the new motion too, but there it is one of another number
/// of impacts, of other things. The ratio is its probability in the new motion over that in the old one.
#[derive(Debug, Clone, Copy)]
struct OneImpact {
    name: &'static str,
    /// Sizes of steps; none if scores are drawn anew.
    sizes: Option<Sizes>,
}

/// The moves, if impacts of the world scatter.
pub(super) fn all(world: &Custom) -> Vec<Box<dyn Move<Custom>>> {
    if world.plan.scatter.is_none() {
        return Vec::new();
    }
    let step = OneImpact { name: "step_impact", sizes: Some(Sizes::new(0.01, 1.0)) };
    vec![Box::new(OneImpact { name: "redraw_impact", sizes: None }), Box::new(step)]
}

/// An impact that scattered in a motion; `choose` chooses one of so many.
fn impact(state: StateRefOf<'_, Custom>, mut choose: impl FnMut(usize) -> usize) -> Option<[Site; 3]> {
    let Ending::Done(done) = state.outcome else { return None };
    if done.scattered.is_empty() {
        return None;
    }
    let (two, count) = done.scattered[choose(done.scattered.len())];
    Some(Site::of_impact(two, choose(count as usize) as u32))
}

/// Log probability of choosing an impact.
fn log_q(state: StateRefOf<'_, Custom>, sites: [Site; 3]) -> f64 {
    let Ending::Done(done) = state.outcome else { return f64::NEG_INFINITY };
    let is_of = |&(two, count): &([u32; 2], u32)| (0..count).any(|k| Site::of_impact(two, k) == sites);
    let of = done.scattered.iter().find(|one| is_of(one));
    of.map_or(f64::NEG_INFINITY, |(_, count)| -math::ln(done.scattered.len() as f64 * f64::from(*count)))
}

impl Move<Custom> for OneImpact {
    fn name(&self) -> &'static str {
        self.name
    }

    fn propose(&self, at: At<'_, Custom>, candidate: &mut Drawn, stream: &mut Stream) -> Result<Proposal, ModelError> {
        let Some(index) = at.target.plan.scatter else { return Ok(Proposal::Stay) };
        let Some(sites) = impact(at.state, |count| below(&mut *stream, count)) else { return Ok(Proposal::Stay) };
        let scores = &mut candidate.tables[index];
        let (is_wide, is_possible) = match self.sizes {
            Some(sizes) => scores.step_points(sites, sizes, stream),
            None => scores.renew_points(sites, stream),
        };
        let path = marked(path_of_impact(sites[0]), is_wide);
        if !is_possible {
            return Ok(Proposal::Candidate { log_ratio: LogRatio::ZERO, path, later: None });
        }
        let log_ratio = LogRatio::new(-log_q(at.state, sites))?;
        Ok(Proposal::Candidate { log_ratio, path, later: Some(LogRatio::ONE) })
    }

    fn log_ratio(&self, step: Transition<'_, Custom>) -> Result<LogRatio, ModelError> {
        let forth = LogRatio::new(log_q(step.from, impact_of_path(step.path)))?;
        Ok(self.log_ratio_after(step)?.times(forth.inverse())?)
    }

    fn log_ratio_after(&self, step: Transition<'_, Custom>) -> Result<LogRatio, ModelError> {
        Ok(LogRatio::new(log_q(step.to, impact_of_path(step.path)))?)
    }

    fn scales(&self) -> Vec<Scale> {
        self.sizes.iter().map(|sizes| sizes.declared("impact", Scale::ONE)).collect()
    }

    fn at_scales(&self, values: &[Option<f64>]) -> Option<Box<dyn Move<Custom>>> {
        let about = |sizes: Sizes| sizes.about(values.first().copied().flatten());
        Some(Box::new(Self { sizes: self.sizes.map(about), ..*self }))
    }

    fn scale_of(&self, path: Path) -> Option<usize> {
        (self.sizes.is_some() && is_adapted(path)).then_some(0)
    }
}

//! A control point near a collision.

use super::{about, change, declared, site};
use crate::dice::{Dice, Draw, Rest, Site};
use plaus_dist::stream::below;
use plaus_dist::{LogRatio, Stream, math, open_unit};
use plaus_mcmc::library::{Sizes, is_adapted};
use plaus_mcmc::{At, ModelError, Move, Path, Proposal, StateRefOf, Transition};

/// Chooses one of the places where a die touched its table or finally lies, the k-th of a die with weight 1/k: early
/// places steer, and there are many late ones. Then chooses one of the sixteen control points that a field there
/// depends on, and one of the random fields. Changes that point by a step that preserves its law.
///
/// After the step, the die touches elsewhere. The ratio is the point's share of the weights of the new animation's
/// places over its share in the old one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Near {
    /// Sizes of the steps, of heights, restitutions and frictions.
    pub scales: [Sizes; 3],
}

impl Near {
    /// The same sizes for all.
    #[must_use]
    pub fn new(sizes: Sizes) -> Self {
        Self { scales: [sizes; 3] }
    }
}

/// Places on a table, of the dice thrown onto it.
fn places<'a>(draw: &'a Draw, rest: &'a Rest, table: usize) -> impl Iterator<Item = ([f64; 2], f64)> + 'a {
    let of_table = rest.trips.iter().enumerate().filter(move |(die, _)| draw.table_of(*die) == table);
    of_table.flat_map(|(_, trip)| {
        let touched = trip.impacts.iter().map(|&[_, x, y]| [x, y]);
        let places = touched.chain(std::iter::once([trip.position.x, trip.position.y]));
        places.enumerate().map(|(k, place)| (place, 1.0 / (k + 1) as f64))
    })
}

/// Log probability of choosing a site of a table, up to a constant that is the same for all sites.
fn log_q(target: &Dice, state: StateRefOf<'_, Dice>, table: usize, site: Site) -> f64 {
    let (mut all, mut hits) = (0.0, 0.0);
    for ([x, y], weight) in places(state.draw, state.outcome, table) {
        all += weight;
        if target.plan.surface.support(x, y).any(|at| at == [site.i, site.j]) {
            hits += weight;
        }
    }
    math::ln(hits / all)
}

/// What a log probability can't exceed: rounding of the logarithm included.
const MOST: f64 = 1e-9;

impl Move<Dice> for Near {
    fn name(&self) -> &'static str {
        "near"
    }

    fn propose(&self, at: At<'_, Dice>, candidate: &mut Draw, stream: &mut Stream) -> Result<Proposal, ModelError> {
        let Some(&field) = at.target.fields().get(below(stream, at.target.fields().len())) else {
            return Ok(Proposal::Stay);
        };
        let table = below(stream, candidate.tables.len());
        let all = || places(at.state.draw, at.state.outcome, table);
        let mut left = all().map(|(_, weight)| weight).sum::<f64>() * open_unit(stream);
        let chosen = all().find(|(_, weight)| {
            left -= weight;
            left < 0.0
        });
        // Rounding may pass the last one.
        let Some(([x, y], _)) = chosen.or_else(|| all().last()) else { return Ok(Proposal::Stay) };
        let Some([i, j]) = at.target.plan.surface.support(x, y).nth(below(stream, 16)) else {
            return Ok(Proposal::Stay);
        };
        let site = Site { field, i, j };
        let (path, is_possible) = change(candidate, table, site, self.scales[field as usize], stream);
        if !is_possible {
            return Ok(Proposal::Candidate { log_ratio: LogRatio::ZERO, path, later: None });
        }
        let log_ratio = LogRatio::new(-log_q(at.target, at.state, table, site))?;
        Ok(Proposal::Candidate { log_ratio, path, later: Some(LogRatio::new(MOST)?) })
    }

    fn log_ratio(&self, step: Transition<'_, Dice>) -> Result<LogRatio, ModelError> {
        let (table, site) = site(step.path);
        let forth = LogRatio::new(log_q(step.target, step.from, table, site))?;
        Ok(LogRatio::new(log_q(step.target, step.to, table, site))?.times(forth.inverse())?)
    }

    fn log_ratio_after(&self, step: Transition<'_, Dice>) -> Result<LogRatio, ModelError> {
        let (table, site) = site(step.path);
        Ok(LogRatio::new(log_q(step.target, step.to, table, site))?)
    }

    fn scales(&self) -> Vec<plaus_mcmc::Scale> {
        declared(&self.scales)
    }

    fn at_scales(&self, values: &[Option<f64>]) -> Option<Box<dyn Move<Dice>>> {
        Some(Box::new(Self { scales: about(self.scales, values) }))
    }

    fn scale_of(&self, path: Path) -> Option<usize> {
        is_adapted(path).then(|| site(path).1.field as usize)
    }
}

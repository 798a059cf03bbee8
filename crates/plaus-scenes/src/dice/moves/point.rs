//! One control point, anywhere or near a collision.

use super::{about, change, declared, site};
use crate::dice::{Dice, Draw, Field, Rest, Site};
use plaus_dist::stream::below;
use plaus_dist::{LogRatio, Stream, math};
use plaus_mcmc::library::{Sizes, is_adapted, one_of};
use plaus_mcmc::{At, ModelError, Move, Path, Proposal, StateRefOf, Transition};

/// Changes one control point of one table by a step that preserves its law.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Point {
    is_near: bool,
    /// Sizes of the steps, of heights, restitutions and frictions.
    scales: [Sizes; 3],
}

impl Point {
    /// The paper's move: any point, all equally likely. Most are far from any die.
    #[must_use]
    pub fn anywhere(sizes: Sizes) -> Self {
        Self { is_near: false, scales: [sizes; 3] }
    }

    /// Chooses one of the places where a die touched its table or finally lies, the k-th of a die with weight 1/k:
    /// early places steer, and there are many late ones. Then chooses one of the sixteen control points that a field
    /// there depends on.
    ///
    /// After the step, the die touches elsewhere. The ratio is the point's share of the weights of the new animation's
    /// places over its share in the old one.
    #[must_use]
    pub fn near(sizes: Sizes) -> Self {
        Self { is_near: true, scales: [sizes; 3] }
    }

    /// A point of a table; `None` if there is no such place.
    fn choose(self, at: At<'_, Dice>, (table, field): (usize, Field), stream: &mut Stream) -> Option<Site> {
        let plan = &at.target.plan;
        if !self.is_near {
            let [i, j] = plan.reach().map(|far| below(stream, 2 * far as usize + 1) as i32 - far);
            return Some(Site { field, i, j });
        }
        let all = || places(at.state.draw, at.state.outcome, table);
        let chosen = one_of(all().map(|(_, weight)| weight), stream);
        // Rounding may pass the last one.
        let ([x, y], _) = chosen.map_or_else(|| all().last(), |place| all().nth(place))?;
        let [i, j] = plan.surface.support(x, y).nth(below(stream, 16))?;
        Some(Site { field, i, j })
    }

    /// Log probability of choosing a point of a table, up to a constant that is the same for all points.
    fn log_q(self, target: &Dice, state: StateRefOf<'_, Dice>, (table, site): (usize, Site)) -> f64 {
        if !self.is_near {
            return 0.0;
        }
        let (mut all, mut hits) = (0.0, 0.0);
        for ([x, y], weight) in places(state.draw, state.outcome, table) {
            all += weight;
            if target.plan.surface.support(x, y).any(|at| at == [site.i, site.j]) {
                hits += weight;
            }
        }
        math::ln(hits / all)
    }
}

/// Places on a table, of the dice thrown onto it, with their weights.
fn places<'a>(draw: &'a Draw, rest: &'a Rest, table: usize) -> impl Iterator<Item = ([f64; 2], f64)> + Clone + 'a {
    let of_table = rest.trips.iter().enumerate().filter(move |(die, _)| draw.table_of(*die) == table);
    of_table.flat_map(|(_, trip)| {
        let touched = trip.impacts.iter().map(|&[_, x, y]| [x, y]);
        let places = touched.chain(std::iter::once([trip.position.x, trip.position.y]));
        places.enumerate().map(|(k, place)| (place, 1.0 / (k + 1) as f64))
    })
}

/// What a log probability can't exceed: rounding of the logarithm included.
const MOST: f64 = 1e-9;

impl Move<Dice> for Point {
    fn name(&self) -> &'static str {
        if self.is_near { "near" } else { "point" }
    }

    fn propose(&self, at: At<'_, Dice>, candidate: &mut Draw, stream: &mut Stream) -> Result<Proposal, ModelError> {
        let Some(&field) = at.target.fields().get(below(stream, at.target.fields().len())) else {
            return Ok(Proposal::Stay);
        };
        let table = below(stream, candidate.tables.len());
        let Some(site) = self.choose(at, (table, field), stream) else { return Ok(Proposal::Stay) };
        let (path, is_possible) = change(candidate, table, site, self.scales[field as usize], stream);
        if !is_possible {
            return Ok(Proposal::Candidate { log_ratio: LogRatio::ZERO, path, later: None });
        }
        let log_ratio = LogRatio::new(0.0 - self.log_q(at.target, at.state, (table, site)))?;
        let later = if self.is_near { Some(LogRatio::new(MOST)?) } else { None };
        Ok(Proposal::Candidate { log_ratio, path, later })
    }

    /// The step preserves the law of the point, with respect to which densities are taken.
    fn log_ratio(&self, step: Transition<'_, Dice>) -> Result<LogRatio, ModelError> {
        let forth = LogRatio::new(self.log_q(step.target, step.from, site(step.path)))?;
        Ok(LogRatio::new(self.log_q(step.target, step.to, site(step.path)))?.times(forth.inverse())?)
    }

    fn log_ratio_after(&self, step: Transition<'_, Dice>) -> Result<LogRatio, ModelError> {
        Ok(LogRatio::new(self.log_q(step.target, step.to, site(step.path)))?)
    }

    fn scales(&self) -> Vec<plaus_mcmc::Scale> {
        declared(&self.scales)
    }

    fn at_scales(&self, values: &[Option<f64>]) -> Option<Box<dyn Move<Dice>>> {
        Some(Box::new(Self { scales: about(self.scales, values), ..*self }))
    }

    fn scale_of(&self, path: Path) -> Option<usize> {
        is_adapted(path).then(|| site(path).1.field as usize)
    }
}

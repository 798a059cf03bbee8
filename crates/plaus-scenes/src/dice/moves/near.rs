//! A control point near a collision.

use super::{Scale, change, path, site};
use crate::dice::{Dice, Draw, Rest, Site};
use plaus_dist::stream::below;
use plaus_dist::{LogRatio, Stream, math};
use plaus_mcmc::{ModelError, Move, Path, Proposal, StateOf};

/// One of the places where a die touched its table, or lies at last, each as likely; one of the sixteen control points that a field there depends on; and one of
/// the random fields. That point makes a step that leaves its law as it is.
///
/// After the step the die touches elsewhere. The ratio is how often the point comes up among the places of the new animation over how often among those of the old
/// one, each over the number of places.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Near {
    /// Sizes of the steps.
    pub scale: Scale,
}

/// Places on a table, of the dice thrown onto it.
fn places<'a>(draw: &'a Draw, rest: &'a Rest, table: usize) -> impl Iterator<Item = [f64; 2]> + 'a {
    let of_table = rest.trips.iter().enumerate().filter(move |(die, _)| draw.table_of(*die) == table);
    of_table.flat_map(|(_, trip)| {
        let touched = trip.impacts.iter().map(|&[_, x, y]| [x, y]);
        touched.chain(std::iter::once([trip.position.x, trip.position.y]))
    })
}

/// Log probability of choosing a site of a table, but for what is the same for all sites.
fn log_q(target: &Dice, state: &StateOf<Dice>, table: usize, site: Site) -> f64 {
    let (mut all, mut hits) = (0.0, 0.0);
    for [x, y] in places(&state.draw, &state.outcome, table) {
        all += 1.0;
        if target.plan.surface.support(x, y).any(|at| at == [site.i, site.j]) {
            hits += 1.0;
        }
    }
    math::ln(hits / f64::max(all, 1.0))
}

/// What a log probability can't exceed: rounding of the logarithm included.
const MOST: f64 = 1e-9;

impl Move<Dice> for Near {
    fn name(&self) -> &'static str {
        "near"
    }

    fn propose(
        &self,
        target: &Dice,
        current: &StateOf<Dice>,
        candidate: &mut Draw,
        stream: &mut Stream,
    ) -> Result<Proposal, ModelError> {
        let Some(&field) = target.fields().get(below(stream, target.fields().len())) else { return Ok(Proposal::Stay) };
        let table = below(stream, candidate.tables.len());
        let count = places(&current.draw, &current.outcome, table).count();
        let place = places(&current.draw, &current.outcome, table).nth(below(stream, count));
        let Some([x, y]) = place else { return Ok(Proposal::Stay) };
        let Some([i, j]) = target.plan.surface.support(x, y).nth(below(stream, 16)) else { return Ok(Proposal::Stay) };
        let site = Site { field, i, j };
        if !change(candidate, table, site, self.scale, stream) {
            return Ok(Proposal::with_ratio(LogRatio::ZERO));
        }
        let log_ratio = LogRatio::new(-log_q(target, current, table, site))?;
        Ok(Proposal::Candidate { log_ratio, path: path(table, site), later: Some(LogRatio::new(MOST)?) })
    }

    fn log_ratio(
        &self,
        target: &Dice,
        from: &StateOf<Dice>,
        to: &StateOf<Dice>,
        path: Path,
    ) -> Result<LogRatio, ModelError> {
        let (table, site) = site(path);
        let forth = LogRatio::new(log_q(target, from, table, site))?;
        Ok(LogRatio::new(log_q(target, to, table, site))?.times(forth.inverse())?)
    }

    fn log_ratio_after(
        &self,
        target: &Dice,
        _: &StateOf<Dice>,
        candidate: &StateOf<Dice>,
        path: Path,
    ) -> Result<LogRatio, ModelError> {
        let (table, site) = site(path);
        Ok(LogRatio::new(log_q(target, candidate, table, site))?)
    }
}

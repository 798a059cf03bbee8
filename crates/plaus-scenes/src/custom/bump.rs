//! One control point of a table.

use super::Custom;
use super::flight::Ending;
use super::solids::MM;
use super::tables::Uneven;
use super::values::{Drawn, Values, vector};
use crate::uneven::{Field, Site, about, declared, path, site};
use glam::{DVec2, DVec3};
use plaus_dist::stream::below;
use plaus_dist::{LogRatio, Stream, math, open_unit};
use plaus_mcmc::library::{Sizes, is_adapted, marked};
use plaus_mcmc::{At, ModelError, Move, Path, Proposal, Scale, StateRefOf, Transition};

/// Chooses a table, one of its random fields, a body, a place on the straight line from where the body starts to where
/// it ends, and one of the sixteen control points that the field there depends on. Changes that point by a step that
/// preserves its law.
///
/// After the step, bodies end elsewhere. The ratio is the point's share of the lines of the new motion over its share
/// of those of the old one.
#[derive(Debug, Clone, Copy)]
pub(super) struct Bump {
    /// Sizes of the steps, of heights, restitutions and frictions.
    sizes: [Sizes; 3],
}

impl Bump {
    /// The move, if the world has a table.
    pub(super) fn of(world: &Custom) -> Option<Box<dyn Move<Custom>>> {
        world.plan.tables().next()?;
        Some(Box::new(Self { sizes: [Sizes::new(0.01, 1.0); 3] }))
    }
}

/// From where to where, in cells of a table.
type Line = [DVec2; 2];

/// The lines of all bodies over a table; none if the motion did not come to its end.
fn lines(world: &Custom, state: StateRefOf<'_, Custom>, (table, at): (&Uneven, &Values)) -> Vec<Line> {
    let Ending::Done(done) = state.outcome else { return Vec::new() };
    let numbers = world.plan.works.numbers(Some(state.draw));
    let (origin, spacing) = (vector(at, &numbers) * MM, table.spacing(&numbers));
    let cells = |place: DVec3| (place - origin).truncate() / spacing;
    let bodies = world.plan.free().iter().zip(&done.bodies);
    bodies.map(|(body, last)| [cells(body.begins(&numbers)), cells(last.place)]).collect()
}

/// The share of a line where a field depends on the control point.
fn share([from, to]: Line, site: Site) -> f64 {
    let (mut first, mut last) = (0.0_f64, 1.0_f64);
    for (at, way, index) in [(from.x, to.x - from.x, site.i), (from.y, to.y - from.y, site.j)] {
        let [low, high] = [-2.0, 2.0].map(|reach| f64::from(index) + reach - at);
        if way == 0.0 {
            if low > 0.0 || high <= 0.0 {
                return 0.0;
            }
            continue;
        }
        first = first.max((low / way).min(high / way));
        last = last.min((low / way).max(high / way));
    }
    (last - first).max(0.0)
}

/// Log probability of choosing a site of a table, up to a constant that is the same for all sites.
fn log_q(world: &Custom, state: StateRefOf<'_, Custom>, (table, site): (usize, Site)) -> f64 {
    let lines = world.plan.tables().nth(table).map_or_else(Vec::new, |table| lines(world, state, table));
    math::ln(lines.iter().map(|&line| share(line, site)).sum::<f64>() / lines.len().max(1) as f64)
}

/// What a log probability can't exceed: rounding of the sum and the logarithm included.
const MOST: f64 = 1e-9;

impl Move<Custom> for Bump {
    fn name(&self) -> &'static str {
        "bump"
    }

    fn propose(&self, at: At<'_, Custom>, candidate: &mut Drawn, stream: &mut Stream) -> Result<Proposal, ModelError> {
        let index = below(stream, candidate.tables.len());
        let Some(table) = at.target.plan.tables().nth(index) else { return Ok(Proposal::Stay) };
        let fields: Vec<Field> = table.0.fields().collect();
        let lines = lines(at.target, at.state, table);
        if lines.is_empty() {
            return Ok(Proposal::Stay);
        }
        let field = fields[below(stream, fields.len())];
        let [from, to] = lines[below(stream, lines.len())];
        let cell = from.lerp(to, open_unit(stream)).floor();
        let k = below(stream, 16) as i32;
        let there =
            Site { field, i: (cell.x as i32).saturating_add(k / 4 - 1), j: (cell.y as i32).saturating_add(k % 4 - 1) };
        let log_q = log_q(at.target, at.state, (index, there));
        // A path has no room for sites that are farther away than any body should be. And rounding may choose a site
        // that no line depends on.
        if site(path(index, there)) != (index, there) || log_q == f64::NEG_INFINITY {
            return Ok(Proposal::Stay);
        }
        let (is_wide, is_possible) = candidate.tables[index].step_point(there, self.sizes[field as usize], stream);
        let path = marked(path(index, there), is_wide);
        if !is_possible {
            return Ok(Proposal::Candidate { log_ratio: LogRatio::ZERO, path, later: None });
        }
        Ok(Proposal::Candidate { log_ratio: LogRatio::new(-log_q)?, path, later: Some(LogRatio::new(MOST)?) })
    }

    fn log_ratio(&self, step: Transition<'_, Custom>) -> Result<LogRatio, ModelError> {
        let forth = LogRatio::new(log_q(step.target, step.from, site(step.path)))?;
        Ok(LogRatio::new(log_q(step.target, step.to, site(step.path)))?.times(forth.inverse())?)
    }

    fn log_ratio_after(&self, step: Transition<'_, Custom>) -> Result<LogRatio, ModelError> {
        Ok(LogRatio::new(log_q(step.target, step.to, site(step.path)))?)
    }

    fn scales(&self) -> Vec<Scale> {
        declared(&self.sizes)
    }

    fn at_scales(&self, values: &[Option<f64>]) -> Option<Box<dyn Move<Custom>>> {
        Some(Box::new(Self { sizes: about(self.sizes, values) }))
    }

    fn scale_of(&self, path: Path) -> Option<usize> {
        is_adapted(path).then(|| site(path).1.field as usize)
    }
}

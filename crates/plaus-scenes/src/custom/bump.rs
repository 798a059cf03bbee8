//! One control point of a random field.

use super::Custom;
use super::bumpy::{indices, lattice};
use super::ending::Ending;
use super::standing::{Random, Standing};
use super::values::Drawn;
use crate::uneven::{Site, about, declared, path, site};
use glam::DVec3;
use plaus_dist::stream::below;
use plaus_dist::{LogRatio, Stream, math, open_unit};
use plaus_mcmc::library::{Sizes, is_adapted, marked};
use plaus_mcmc::{At, ModelError, Move, Path, Proposal, Scale, StateRefOf, Transition};

/// Chooses a piece of scenery with random fields, one of these, a body, a place on the straight line from where the
/// body starts to where it ends, and one of the control points that the field there depends on: 16 of a table, 64 of
/// bumps on a surface, whose points fill space. Changes that point by a step that preserves its law.
///
/// After the step, bodies end elsewhere. The ratio is the point's share of the lines of the new motion over its share
/// of those of the old one.
#[derive(Debug, Clone, Copy)]
pub(super) struct Bump {
    /// Sizes of the steps, of heights, restitutions and frictions.
    sizes: [Sizes; 3],
}

impl Bump {
    /// The move, if the world has random fields.
    pub(super) fn of(world: &Custom) -> Option<Box<dyn Move<Custom>>> {
        world.plan.random().next()?;
        Some(Box::new(Self { sizes: [Sizes::new(0.01, 1.0); 3] }))
    }
}

/// From where to where, in cells of random fields.
type Line = [DVec3; 2];

/// The lines of all bodies past a piece of scenery; none if the motion did not come to its end.
fn lines(world: &Custom, state: StateRefOf<'_, Custom>, part: &Standing) -> Vec<Line> {
    let Ending::Done(done) = state.outcome else { return Vec::new() };
    let numbers = world.plan.works.numbers(Some(state.draw));
    let Some(random) = part.random(&numbers) else { return Vec::new() };
    let (origin, turn) = part.pose(&numbers);
    let back = turn.conjugate();
    let cells = |place: DVec3| back * (place - origin) / random.spacing;
    let bodies = world.plan.free().iter().zip(&done.bodies);
    bodies.map(|(body, last)| [cells(body.begins(&numbers)), cells(last.place)]).collect()
}

/// The share of a line where a field depends on the control point: of a table, whatever the height.
fn share([from, to]: Line, is_deep: bool, site: Site) -> f64 {
    let (mut first, mut last) = (0.0_f64, 1.0_f64);
    let indices = if is_deep { indices(site) } else { [site.i.into(), site.j.into(), 0] };
    for axis in 0..if is_deep { 3 } else { 2 } {
        let (at, way) = (from[axis], to[axis] - from[axis]);
        let [low, high] = [-2.0, 2.0].map(|reach| indices[axis] as f64 + reach - at);
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
    let Some(part) = world.plan.random().nth(table) else { return f64::NEG_INFINITY };
    let (lines, is_deep) = (lines(world, state, part), !part.is_endless());
    math::ln(lines.iter().map(|&line| share(line, is_deep, site)).sum::<f64>() / lines.len().max(1) as f64)
}

/// What a log probability can't exceed: rounding of the sum and the logarithm included.
const MOST: f64 = 1e-9;

impl Move<Custom> for Bump {
    fn name(&self) -> &'static str {
        "bump"
    }

    fn propose(&self, at: At<'_, Custom>, candidate: &mut Drawn, stream: &mut Stream) -> Result<Proposal, ModelError> {
        let index = below(stream, at.target.plan.random().count());
        let Some(part) = at.target.plan.random().nth(index) else { return Ok(Proposal::Stay) };
        let numbers = at.target.plan.works.numbers(Some(at.state.draw));
        let Some(Random { fields, is_deep, .. }) = part.random(&numbers) else { return Ok(Proposal::Stay) };
        let lines = lines(at.target, at.state, part);
        if lines.is_empty() {
            return Ok(Proposal::Stay);
        }
        let field = fields[below(stream, fields.len())];
        let [from, to] = lines[below(stream, lines.len())];
        let cell = from.lerp(to, open_unit(stream)).floor();
        let k = below(stream, if is_deep { 64 } else { 16 }) as i64;
        let index_at = |axis: usize, shift: i64| i64::from((cell[axis] as i32).saturating_add(shift as i32 - 1));
        let there = if is_deep {
            lattice([index_at(0, k / 16), index_at(1, k / 4 % 4), index_at(2, k % 4)])
        } else {
            Some(Site { field, i: index_at(0, k / 4) as i32, j: index_at(1, k % 4) as i32 })
        };
        let Some(there) = there else { return Ok(Proposal::Stay) };
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

//! Throws that are the same but for where they are, which way they go, and how the body is labelled.

use super::Custom;
use super::handles::{Upright, turn_by};
use super::throws::Throw;
use super::values::Drawn;
use crate::turns::turned;
use glam::DVec3;
use plaus_dist::stream::below;
use plaus_dist::{LogRatio, Stream, math, open_unit};
use plaus_mcmc::{At, ModelError, Move, Path, Proposal, StateRefOf, Transition};
use std::f64::consts::{PI, TAU};

/// Shifts a body's start so that, if everything goes as before, it ends where it should, at a place drawn from the
/// requirement's own density. The way back aims from where the candidate ends, so the ratio is that of the density where
/// the old state should end over that where the new one should; shifts preserve volumes.
#[derive(Debug, Clone, Copy)]
pub(super) struct Shift;

/// Rounding of a logarithm.
const SLACK: f64 = 1e-9;

/// A throw and one of its zones, by their places.
fn path(throw: usize, zone: usize) -> Path {
    Path((throw as u64) << 32 | zone as u64)
}

impl Shift {
    /// The throw and the zone of a path.
    fn of(world: &Custom, path: Path) -> (&Throw, usize) {
        (&world.throws[(path.0 >> 32) as usize], (path.0 & 0xffff_ffff) as usize)
    }

    /// Log density of a shift from one state's end by as much as leads to another draw.
    fn log_q(world: &Custom, from: StateRefOf<'_, Custom>, to: &Drawn, path: Path) -> f64 {
        let (throw, zone) = Self::of(world, path);
        let Some(end) = throw.end(world, from.draw, from.outcome) else { return f64::NEG_INFINITY };
        let along = |axis: usize| {
            let shift = throw.handles.place[axis]
                .map_or(0.0, |handle| (to.numbers[handle.number] - from.draw.numbers[handle.number]) * handle.factor);
            end[axis] + shift
        };
        throw.zones[zone].log_density([along(0), along(1)])
    }
}

impl Move<Custom> for Shift {
    fn name(&self) -> &'static str {
        "shift"
    }

    fn propose(&self, at: At<'_, Custom>, candidate: &mut Drawn, stream: &mut Stream) -> Result<Proposal, ModelError> {
        let world = at.target;
        let index = below(stream, world.throws.len());
        let throw = &world.throws[index];
        let Some(end) = throw.end(world, at.state.draw, at.state.outcome) else { return Ok(Proposal::Stay) };
        if throw.zones.is_empty() {
            return Ok(Proposal::Stay);
        }
        let which = below(stream, throw.zones.len());
        let (zone, path) = (&throw.zones[which], path(index, which));
        let to = zone.sample(stream);
        for (axis, leads) in zone.leads().into_iter().enumerate() {
            if let Some(handle) = throw.handles.place[axis].filter(|_| leads) {
                handle.add(candidate, to[axis] - end[axis]);
            }
        }
        let log_ratio = LogRatio::new(-Self::log_q(world, at.state, candidate, path))?;
        let later = Some(LogRatio::new(zone.log_most() + SLACK)?);
        Ok(Proposal::Candidate { log_ratio, path, later })
    }

    fn log_ratio(&self, step: Transition<'_, Custom>) -> Result<LogRatio, ModelError> {
        let forth = LogRatio::new(Self::log_q(step.target, step.from, step.to.draw, step.path))?;
        let back = LogRatio::new(Self::log_q(step.target, step.to, step.from.draw, step.path))?;
        Ok(back.times(forth.inverse())?)
    }

    fn log_ratio_after(&self, step: Transition<'_, Custom>) -> Result<LogRatio, ModelError> {
        Ok(LogRatio::new(Self::log_q(step.target, step.to, step.from.draw, step.path))?)
    }
}

/// Turns a body's throw about the vertical through the middle of where it should end: place, velocity, spin and
/// orientation together. Angles are of all sizes, each as likely as its opposite, and turns preserve volumes.
pub(super) fn turn(world: &Custom, state: StateRefOf<'_, Custom>, candidate: &mut Drawn, stream: &mut Stream) -> bool {
    let throw = &world.throws[below(stream, world.throws.len())];
    let Some((levels, upright)) = throw.handles.level else { return false };
    let Some(about) = throw.turns_about(stream) else { return false };
    let size = PI * math::exp(-4.0 * open_unit(stream));
    let angle =
        if open_unit(stream) < 0.5 { TAU * (open_unit(stream) - 0.5) } else { size * (2.0 * open_unit(stream) - 1.0) };
    let (sin, cos) = math::sin_cos(angle);
    let numbers = world.plan.works.numbers(Some(state.draw));
    for (level, about) in levels.iter().zip([about, [0.0; 2], [0.0; 2]]) {
        level.turn(candidate, &numbers, [sin, cos], about);
    }
    match upright {
        Upright::Round => {}
        Upright::Any(index) => candidate.turns[index] = (turned(DVec3::Z * angle) * candidate.turns[index]).normalize(),
        Upright::Angle(handle) => turn_by(&world.vars.get(handle.var).law, candidate, handle, angle.to_degrees()),
    }
    true
}

/// Relabels a body by another of the rotations that map it to itself: it moves as before, and another side comes up.
pub(super) fn relabel(world: &Custom, _: StateRefOf<'_, Custom>, candidate: &mut Drawn, stream: &mut Stream) -> bool {
    let throw = &world.throws[below(stream, world.throws.len())];
    let Some(turn) = throw.handles.turn.filter(|_| throw.rotations.len() > 1) else { return false };
    // Any but the identity; the opposite one is among them.
    let rotation = throw.rotations[1 + below(stream, throw.rotations.len() - 1)];
    candidate.turns[turn] = (candidate.turns[turn] * rotation).normalize();
    true
}

//! Throws that are the same but for where they are, which way they go, and how the body is labelled.

use super::Custom;
use super::recast::SLACK;
use super::throws::Throw;
use super::values::{Drawn, Slot};
use crate::require::Aim;
use plaus_dist::stream::below;
use plaus_dist::{LogRatio, Stream, math, open_unit};
use plaus_mcmc::{At, ModelError, Move, Path, Proposal, StateRefOf, Transition};
use std::collections::BTreeMap;

/// Shifts a body's start so that, if everything goes as before, it ends where it should, at a place drawn from the
/// requirement's own density. The way back aims from where the candidate ends, so the ratio is that of the density
/// where the old state should end over that where the new one should; shifts preserve volumes.
#[derive(Debug, Clone, Copy)]
pub(super) struct Shift;

/// A throw and one of its zones, by their places.
fn path(throw: usize, zone: usize) -> Path {
    Path((throw as u64) << 32 | zone as u64)
}

impl Shift {
    /// The throw and the zone of a path.
    fn of(world: &Custom, path: Path) -> (&Throw, usize) {
        (&world.throws()[(path.0 >> 32) as usize], (path.0 & 0xffff_ffff) as usize)
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
        let index = below(stream, world.throws().len());
        let throw = &world.throws()[index];
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
pub(super) fn turn(world: &Custom, _: StateRefOf<'_, Custom>, candidate: &mut Drawn, stream: &mut Stream) -> bool {
    let throw = &world.throws()[below(stream, world.throws().len())];
    let (Some(course), Some(span)) = (&throw.handles.course, throw.span) else { return false };
    if !throw.is_turned() {
        return false;
    }
    let [Some(x), Some(y)] = throw.zones[below(stream, throw.zones.len())].middle() else { return false };
    let size = span * math::exp(-3.0 * open_unit(stream));
    let angle = size * (2.0 * open_unit(stream) - 1.0);
    throw.handles.turn_start(world, candidate, angle, [x, y]);
    course.turn(world, candidate, angle);
    true
}

/// Relabels a body by another of the rotations that map it to itself: it moves as before, and another side comes up.
pub(super) fn relabel(world: &Custom, _: StateRefOf<'_, Custom>, candidate: &mut Drawn, stream: &mut Stream) -> bool {
    let throw = &world.throws()[below(stream, world.throws().len())];
    let Some(turn) = throw.labelled() else { return false };
    // Any but the identity; the opposite one is among them.
    let rotation = throw.rotations[1 + below(stream, throw.rotations.len() - 1)];
    candidate.turns[turn] = (candidate.turns[turn] * rotation).normalize();
    true
}

/// Two bodies of an array exchange all that is their own: each begins as the other did. Their laws are the same.
pub(super) fn swap(world: &Custom, _: StateRefOf<'_, Custom>, candidate: &mut Drawn, stream: &mut Stream) -> bool {
    let alike = &world.alike()[below(stream, world.alike().len())];
    let (first, second) = (below(stream, alike.len()), below(stream, alike.len()));
    let [first, second] = [first, second].map(|place| &world.handles[alike[place]].own);
    for (a, b) in first.iter().zip(second) {
        match (world.slots[*a], world.slots[*b]) {
            (Slot::Number(a), Slot::Number(b)) => candidate.numbers.swap(a, b),
            (Slot::Turn(a), Slot::Turn(b)) => candidate.turns.swap(a, b),
            _ => {}
        }
    }
    first != second
}

impl Custom {
    /// Bodies of one array each, that begin by the same laws, if something is asked of the end of one of them.
    pub(super) fn alike_for(&self, aims: &[Aim]) -> Vec<Vec<usize>> {
        let laws = |body: usize| {
            let own = self.handles[body].own.iter();
            own.map(|&var| format!("{:?}", self.vars.get(var).law)).collect::<Vec<_>>()
        };
        if aims.is_empty() {
            return Vec::new();
        }
        let mut all: BTreeMap<(&str, Vec<String>), Vec<usize>> = BTreeMap::new();
        for (body, moving) in self.plan.free().iter().enumerate() {
            all.entry((&moving.key, laws(body))).or_default().push(body);
        }
        let is_asked = |body: &usize| aims.iter().any(|aim| aim.body == self.plan.bodies[*body].name);
        let is_any = |alike: &Vec<usize>| alike.len() > 1 && !self.handles[alike[0]].own.is_empty();
        all.into_values().filter(|alike| is_any(alike) && alike.iter().any(is_asked)).collect()
    }
}

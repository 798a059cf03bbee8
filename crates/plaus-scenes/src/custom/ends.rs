//! Where bodies end: the columns of tables, and what kept a draw from coming to rest.

use super::Custom;
use super::ending::{Ending, Last};
use super::engine::Engine;
use super::flight::{Traced, Work, fly};
use super::moving::Moving;
use super::plan::{Built, Plan, World};
use super::regions::Region;
use super::values::Drawn;
use crate::model::{Role, Scalar};
use crate::require::{Ended, upper_face};
use plaus_mcmc::{ModelError, StateRefOf};
use plaus_sim::trace::Trace;

/// Columns of where a body ends that does not go its own way, with their units.
const ENDS: [(&str, &str); 4] = [("end_x", "mm"), ("end_y", "mm"), ("end_z", "mm"), ("rest", "s")];
/// A further column of a body that is no ball: which of its faces counts, numbered as they are marked, or else
/// as on a die.
const UP: &str = "up";
/// The number of the region in which it ends, where regions are given.
const REGION: &str = "region";
/// Further ones of a body that turns: the unit quaternion from its own axes to the scenario's.
const TURN: [&str; 4] = ["qx", "qy", "qz", "qw"];

/// A body whose centre of gravity moves slower than this share of how fast its outermost points turn about it spins on
/// the spot.
const ON_THE_SPOT: f64 = 0.1;

impl Custom {
    /// What a draw is simulated to, in which nothing may fail.
    pub(super) fn simulated(&self, draw: &Drawn) -> Result<Work, ModelError> {
        let mut work = Work::default();
        work.kept.contacts = true;
        match fly(&self.plan, draw, None, &mut work)? {
            Some(Ending::Done(_)) => Ok(work),
            Some(Ending::Overlap(overlap)) => Err(ModelError::new(self.in_words(&overlap))),
            Some(Ending::Failed(failed)) => Err(ModelError::new(failed.named(|index| self.name(index)).to_string())),
            Some(Ending::Folded(part)) => {
                let name = &self.plan.parts[part as usize].name;
                Err(ModelError::new(format!("bumps turn a triangle of {name:?} over")))
            }
            None => Err(ModelError::new("a simulation stopped early although no floor was set: a bug")),
        }
    }

    /// The columns of a body.
    fn columns(&self, body: &Moving) -> Vec<Scalar> {
        let column = |name: &str, unit, role| Scalar::new(format!("{}.{name}", body.name), unit, role, None);
        let number = |name| Scalar { whole: true, ..column(name, "", Role::Outcome) };
        let up = (!body.is_ball()).then(|| number(UP));
        let region = (!self.config.regions.is_empty()).then(|| number(REGION));
        let turn = TURN.iter().filter(|_| self.turns()).map(|name| column(name, "", Role::Detail));
        ENDS.into_iter()
            .map(|(name, unit)| column(name, unit, Role::Outcome))
            .chain(up)
            .chain(region)
            .chain(turn)
            .collect()
    }

    /// The number of columns of a body.
    fn width(&self, body: &Moving) -> usize {
        let numbers = usize::from(!body.is_ball()) + usize::from(!self.config.regions.is_empty());
        ENDS.len() + numbers + if self.turns() { TURN.len() } else { 0 }
    }

    /// The columns of where all bodies end.
    pub(super) fn ends(&self) -> Vec<Scalar> {
        self.plan.free().iter().flat_map(|body| self.columns(body)).collect()
    }

    /// Writes their values. Gives the places that are left.
    pub(super) fn write_ends<'a>(&self, state: StateRefOf<'_, Self>, values: &'a mut [f64]) -> &'a mut [f64] {
        let free = self.plan.free();
        let (ends, left) = values.split_at_mut(free.iter().map(|body| self.width(body)).sum());
        ends.fill(f64::NAN);
        let Ending::Done(done) = &state.outcome else { return left };
        let (mut first, mut body) = (0, 0);
        for (index, Last { place, turn, rest }) in self.plan.there(state.draw).into_iter().zip(&done.bodies) {
            // Bodies that go their own way come last and have no columns.
            let Some(wide) = free.get(index).map(|body| self.width(body)) else { break };
            first += free[body..index].iter().map(|body| self.width(body)).sum::<usize>();
            if *turn == Last::NEVER.turn {
                (first, body) = (first + wide, index + 1);
                continue;
            }
            let regions = &self.config.regions;
            let region = (!regions.is_empty()).then(|| Region::of(regions, *place) as f64);
            let place = (*place * 1e3).to_array().into_iter().chain([rest.unwrap_or(f64::NAN)]);
            let up = (!free[index].is_ball()).then(|| f64::from(upper_face(&free[index].marks, *turn)));
            let end = place.chain(up).chain(region).chain(turn.to_array());
            ends[first..first + wide].iter_mut().zip(end).for_each(|(column, value)| *column = value);
            (first, body) = (first + wide, index + 1);
        }
        left
    }

    /// How the last simulation of `work` ended, which was this state's.
    pub(super) fn how_it_ended(&self, state: StateRefOf<'_, Self>, work: &Work) -> Option<Ended> {
        let name = |index: u32| self.name(index).to_owned();
        Some(match &state.outcome {
            Ending::Overlap(overlap) => Ended::of("began inside something", [name(overlap.body)]),
            Ending::Folded(part) => {
                Ended::of("bumps turned a triangle over", [name(self.plan.bodies.len() as u32 + part)])
            }
            Ending::Failed(failed) => {
                let failure = failed.named(|index| self.name(index));
                Ended::of(failure.cause, [failure.body])
            }
            Ending::Done(done) => {
                let (record, built) = work.known(state.draw)?;
                let ends = (done.bodies.as_slice(), record.end);
                match (&record.trace, &built.world) {
                    (Traced::Turning(trace), World::Turning(rigid)) => {
                        unrest(&self.plan, (rigid.as_ref(), built), trace, ends)
                    }
                    (Traced::Marbles(trace), World::Marbles(marbles)) => {
                        unrest(&self.plan, (&marbles.world, built), trace, ends)
                    }
                    _ => unreachable!("a world has one kind of bodies"),
                }
            }
        })
    }
}

/// What did not come to rest, of the `bodies` that are there, at the `end` of a trace, in s: what fell out, else what
/// still moves from its place, else what spins.
fn unrest<E: Engine>(
    plan: &Plan,
    (engine, built): (&E, &Built),
    trace: &Trace<E::Body>,
    (bodies, end): (&[Last], f64),
) -> Ended {
    let begin = trace.motions.iter().filter_map(|motions| Some(E::path(motions.first()?).x.z));
    // Below all that was ever touched, and below where everything began.
    let low = trace.impacts.iter().map(|impact| impact.point.z).chain(begin).fold(f64::INFINITY, f64::min);
    let mut found: [Vec<String>; 3] = Default::default();
    for (index, last) in bodies.iter().enumerate().filter(|(_, last)| last.rest.is_none()) {
        let body = &plan.bodies[built.there[index]];
        let Some(motion) = trace.motions.get(index).and_then(|motions| motions.last()) else { continue };
        if body.way.is_some() {
            continue;
        }
        let [speed, spin] = engine.speeds(index, motion, end.max(E::path(motion).t));
        let is_out = last.place.z < low && E::is_free(motion) || last.place.z < plan.bottom;
        let spins = speed < ON_THE_SPOT * spin * built.shapes[index].solid.reach();
        let kind = if is_out { 0 } else { 1 + usize::from(spins) };
        found[kind].push(body.name.clone());
    }
    let (moves, spins) = (format!("still moving after {end} s"), format!("{} after {end} s", Ended::SPINS));
    let how = ["fell out of the scene".to_owned(), moves, spins];
    let worst = how.into_iter().zip(found).find(|(_, bodies)| !bodies.is_empty());
    worst.map_or_else(|| Ended::of(Ended::REST, []), |(how, bodies)| Ended::of(how, bodies))
}

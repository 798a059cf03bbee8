//! One simulation: from a draw to where everything ends, and what met on the way.

use super::animate::{film, reach};
use super::engine::Engine;
use super::plan::{Built, Plan, World};
use super::values::Drawn;
use crate::animation::Animation;
use crate::failed::Cause;
use crate::film::Reel;
use crate::loads::{Loads, Span};
use crate::model::Features;
use crate::require::{Stop, Watched};
use glam::{DQuat, DVec3};
use plaus_dist::LogPotential;
use plaus_mcmc::{Failure, ModelError};
use plaus_sim::marbles::{Marble, MarbleScratch, Marbles};
use plaus_sim::mechanics::{Impact, Island, Other};
use plaus_sim::rigid::{RigidBodyState, RigidScratch, RigidWorld, Start};
use plaus_sim::trace::{Observer, Trace};
use plaus_sim::{Outcome, Scratch, State, WorldError};
use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;

/// What became of a draw.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub enum Ending {
    /// It came to its end.
    Done(Done),
    /// Two bodies, or a body and a piece of scenery, would begin inside each other: the draw has probability 0.
    Overlap(Overlap),
    /// The simulation failed: the draw has probability 0.
    Failed(Failed),
    /// Bumps turn a triangle of this piece of scenery over: the draw has probability 0.
    Folded(u32),
}

/// Where everything ended.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Done {
    /// One for each body that is there.
    pub bodies: Vec<Last>,
    /// What met, each pair once, in the order in which it met first: bodies by their places among all, pieces of
    /// scenery by theirs, counted on.
    pub met: Vec<[u32; 2]>,
}

/// Where a body ended.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Last {
    /// Its centre of gravity, in m.
    pub place: DVec3,
    /// How it is turned, as a scenario says it.
    pub turn: DQuat,
    /// When it came to rest, in s; `None`: it did not.
    pub rest: Option<f64>,
}

/// How a simulation failed.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Failed {
    /// Why.
    pub cause: Cause,
    /// The body whose motion could not go on, or that had the most events.
    pub body: u32,
    /// What it touched: another body, or a piece of scenery, counted on.
    pub other: Option<u32>,
    /// When, in s.
    pub time: f64,
}

impl Failed {
    /// The same with names.
    pub(super) fn named<'a>(&self, name: impl Fn(u32) -> &'a str) -> Failure {
        self.cause.failure(name(self.body), self.other.map(name), self.time)
    }
}

/// Two things that begin inside each other.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Overlap {
    /// A body.
    pub body: u32,
    /// Another, or a piece of scenery, counted on.
    pub other: u32,
    /// How deep, in m.
    pub depth: f64,
}

/// A recorded motion.
#[derive(Debug)]
pub(super) struct Record {
    draw: Drawn,
    pub(super) trace: Traced,
    /// Which bodies bore on what, if that was asked for.
    spans: Vec<Span>,
    /// When it ends, in s.
    pub(super) end: f64,
}

/// What was recorded of one kind of bodies.
#[derive(Debug)]
pub(super) enum Traced {
    Turning(Trace<RigidBodyState>),
    Marbles(Trace<Marble>),
}

/// Memory of a chain's simulations.
#[derive(Debug, Default)]
pub struct Work {
    scratch: Scratch<RigidScratch>,
    marbles: Scratch<MarbleScratch>,
    /// The simulator's world: of the last draw, or of all.
    built: Option<Built>,
    /// What was simulated last.
    last: Option<Record>,
    pub(super) watched: Watched,
}

impl Record {
    /// The motion of all bodies, their impacts and contacts.
    pub(super) fn film(&self, plan: &Plan, built: &Built) -> Animation {
        let ends = [self.end, f64::INFINITY];
        let begun = match (&self.trace, &built.world) {
            (Traced::Turning(trace), World::Turning(rigid)) => {
                film(plan, &self.draw, (rigid.as_ref(), built), (trace, &self.spans), ends)
            }
            (Traced::Marbles(trace), World::Marbles(marbles)) => {
                film(plan, &self.draw, (&marbles.world, built), (trace, &self.spans), ends)
            }
            _ => unreachable!("a world has one kind of bodies"),
        };
        begun.motion
    }

    /// How far things move, as [`reach`] says.
    pub(super) fn reach(&self) -> f64 {
        match &self.trace {
            Traced::Turning(trace) => reach::<RigidWorld>(trace),
            Traced::Marbles(trace) => reach::<Marbles>(trace),
        }
    }
}

impl Work {
    /// The motion of a draw and its world, where it is the one that was simulated last.
    pub(super) fn known(&self, draw: &Drawn) -> Option<(&Record, &Built)> {
        self.last.as_ref().filter(|record| record.draw == *draw).zip(self.built.as_ref())
    }

    /// The world of a draw.
    fn world(&mut self, plan: &Plan, draw: &Drawn) -> Result<&Built, WorldError> {
        match self.built.take().filter(|_| plan.is_steady) {
            Some(built) => Ok(self.built.insert(built)),
            None => Ok(self.built.insert(plan.build(&plan.works.numbers(Some(draw)))?)),
        }
    }
}

impl Plan {
    /// Why a state is none, where that is no error; `there` are the bodies that the simulator has.
    fn overlapping(&self, error: &WorldError, built: &Built) -> Option<Overlap> {
        let there = &built.there;
        let of =
            |body: usize, other: usize, depth: f64| Overlap { body: there[body] as u32, other: other as u32, depth };
        match error {
            WorldError::BodiesOverlap { a, b, depth } => Some(of(*a, there[*b], *depth)),
            WorldError::OverlapsScenery { body, surface, depth } => {
                Some(of(*body, self.bodies.len() + built.part_of(*surface)?, *depth))
            }
            _ => None,
        }
    }

    /// A state in which every body waits for its release, or what begins inside what.
    fn begin<E: Engine>(
        &self,
        engine: &E,
        built: &Built,
        starts: &[Start],
    ) -> Result<Result<State<E::Body>, Overlap>, WorldError> {
        if let World::Marbles(marbles) = &built.world
            && let Some((body, part, depth)) = marbles.buried(starts)
        {
            let (body, other) = (built.there[body] as u32, (self.bodies.len() + part) as u32);
            return Ok(Err(Overlap { body, other, depth }));
        }
        match engine.begin(starts) {
            Ok(state) => Ok(Ok(state)),
            Err(error) => self.overlapping(&error, built).map(Err).ok_or(error),
        }
    }

    /// What begins inside what, in a draw.
    pub(super) fn overlap(&self, draw: &Drawn, work: &mut Work) -> Result<Option<Overlap>, WorldError> {
        let built = work.world(self, draw)?;
        let starts = self.starts(&self.works.numbers(Some(draw)), &built.there, &built.shapes);
        Ok(match &built.world {
            World::Turning(rigid) => self.begin(rigid.as_ref(), built, &starts)?.err(),
            World::Marbles(marbles) => self.begin(&marbles.world, built, &starts)?.err(),
        })
    }

    /// Which bodies begin so near to another that, seen from above, the spheres around them overlap.
    pub(super) fn crowded(&self, draw: &Drawn, work: &mut Work) -> Result<Vec<bool>, WorldError> {
        let built = work.world(self, draw)?;
        let starts = self.starts(&self.works.numbers(Some(draw)), &built.there, &built.shapes);
        let discs: Vec<_> =
            starts.iter().zip(&built.shapes).map(|(s, made)| (s.position, made.solid.reach())).collect();
        let mut crowded = vec![false; self.bodies.len()];
        for (k, (place, reach)) in discs.iter().enumerate() {
            for (j, (other, others)) in discs[..k].iter().enumerate() {
                if (*place - *other).truncate().length() < reach + others {
                    (crowded[built.there[k]], crowded[built.there[j]]) = (true, true);
                }
            }
        }
        Ok(crowded)
    }
}

/// Listens to a run.
struct Listener<'a, E: Engine> {
    flight: &'a Flight<'a, E>,
    reel: Reel<E::Body>,
    /// If it is asked which bodies bear on what.
    loads: Option<Loads<E>>,
    /// Whether each body is never cut into pieces, as far as that was asked.
    whole: Vec<Option<bool>>,
}

impl<E: Engine> Listener<'_, E> {
    /// Reckons with the pieces that a body's last motion is cut into, which ends at `until`, in s.
    fn reckon(&mut self, index: usize, until: f64) {
        let Some(last) = self.reel.trace.motions.get(index).and_then(|motions| motions.last()) else { return };
        let parts = E::cuts(last, (until - E::path(last).t).max(0.0));
        if parts > 1 && !*self.whole[index].get_or_insert_with(|| E::is_whole(&self.flight.built.shapes[index])) {
            self.reel.reckon(parts as usize - 1);
        }
    }
}

impl<E: Engine> Observer<E> for Listener<'_, E> {
    fn impact(&mut self, impact: &Impact) {
        self.reel.impact(impact);
    }

    fn motion(&mut self, index: usize, body: &E::Body) {
        self.reckon(index, E::path(body).t);
        self.reel.motion(index, E::recorded(body));
    }

    fn settled(&mut self, engine: &E, island: &Island<'_, E>) {
        let built = self.flight.built;
        let number = |other| match other {
            Other::Body(other) => other as u32,
            Other::Surface(surface) => (built.shapes.len() + built.part(surface)) as u32,
        };
        if let Some(loads) = &mut self.loads {
            loads.settled(engine, island, number);
        }
    }

    fn proceed(&mut self, state: &State<E::Body>) -> bool {
        let Flight { plan, draw, built, engine, .. } = *self.flight;
        let (ends, spans) = ([plan.duration, state.time()], self.loads.as_ref().map_or(&[][..], Loads::spans));
        let begun = |trace: &_| Some(film(plan, draw, (engine, built), (trace, spans), ends));
        !self.reel.is_full() && self.reel.goes_on(state.time(), LogPotential::ONE, begun)
    }
}

/// A draw's world, to be simulated.
struct Flight<'a, E> {
    plan: &'a Plan,
    draw: &'a Drawn,
    built: &'a Built,
    engine: &'a E,
    /// Whether it is asked which bodies bear on what.
    contacts: bool,
}

/// What became of it, and what was recorded up to which time, in s.
struct Flown<B> {
    /// `None` if it can no longer be accepted.
    ending: Option<Ending>,
    record: Option<(Trace<B>, Vec<Span>, f64)>,
}

impl<B> Flown<B> {
    fn early(ending: Option<Ending>) -> Self {
        Self { ending, record: None }
    }
}

impl<E: Engine> Flight<'_, E> {
    fn fly(&self, scratch: &mut Scratch<E::Scratch>, stop: Option<Stop>) -> Result<Flown<E::Body>, ModelError> {
        let Self { plan, draw, built, engine, contacts } = *self;
        let there = built.there.as_slice();
        let starts = plan.starts(&plan.works.numbers(Some(draw)), there, &built.shapes);
        let mut state = match plan.begin(engine, built, &starts).map_err(ModelError::new)? {
            Ok(state) => state,
            Err(overlap) => return Ok(Flown::early(Some(Ending::Overlap(overlap)))),
        };
        for index in (0..there.len()).filter(|&index| plan.bodies[there[index]].acting.is_asleep) {
            engine.put_to_sleep(&mut state, index).map_err(ModelError::new)?;
        }
        let (loads, whole) = (contacts.then(Loads::default), vec![None; there.len()]);
        let mut listener = Listener { flight: self, reel: Reel::new(stop), loads, whole };
        let outcome = engine.go(&mut state, scratch, &mut listener).map_err(ModelError::new)?;
        if listener.reel.is_hopeless {
            return Ok(Flown::early(None));
        }
        (0..there.len()).for_each(|index| listener.reckon(index, state.time()));
        if let Some((cause, body, touched)) = failed(outcome, &listener.reel) {
            let other = touched.map(|other| built.number(other, plan.bodies.len()) as u32);
            let failed = Failed { cause, body: there[body] as u32, other, time: state.time() };
            return Ok(Flown::early(Some(Ending::Failed(failed))));
        }
        let trace = listener.reel.trace;
        let spans = listener.loads.map(Loads::into_spans).unwrap_or_default();
        let end = if outcome == Outcome::AllAtRest {
            state.bodies().iter().map(|body| E::path(body).t).fold(0.0, f64::max)
        } else {
            plan.duration
        };
        let last = |(index, body): (usize, &E::Body)| {
            let (place, turn) = engine.pose(index, body, end.max(E::path(body).t));
            Last { place, turn: (turn * built.shapes[index].axes.conjugate()).normalize(), rest: E::rest(body) }
        };
        let bodies: Vec<Last> = state.bodies().iter().enumerate().map(last).collect();
        let met = met(&trace.impacts, built, plan.bodies.len());
        Ok(Flown { ending: Some(Ending::Done(Done { bodies, met })), record: Some((trace, spans, end)) })
    }
}

/// Why a run failed, if it did; its body, and what that touched.
fn failed<B: Clone>(outcome: Outcome, reel: &Reel<B>) -> Option<(Cause, usize, Option<Other>)> {
    match outcome {
        Outcome::NotFinite { body, touched } => Some((Cause::NotFinite, body, touched)),
        Outcome::OutOfEvents => Some((Cause::OutOfEvents, reel.busiest(), None)),
        Outcome::Crushed { body, by } => Some((Cause::Crushed, body, Some(Other::Body(by)))),
        _ if reel.is_full() => Some((Cause::TooLong, reel.busiest(), None)),
        Outcome::TimeReached | Outcome::AllAtRest | Outcome::Stopped => None,
    }
}

/// Simulates a draw; `None` if it can no longer be accepted.
pub(super) fn fly(plan: &Plan, draw: &Drawn, work: &mut Work) -> Result<Option<Ending>, ModelError> {
    let (stop, contacts) = (work.watched.stop.take(), work.watched.contacts);
    work.last = None;
    if let Some(part) = plan.folded(draw).map_err(ModelError::new)? {
        return Ok(Some(Ending::Folded(part)));
    }
    work.world(plan, draw).map_err(ModelError::new)?;
    let Work { scratch, marbles, built: Some(built), last, .. } = work else {
        return Err(ModelError::new("a world was made but is missing: a bug"));
    };
    let built = &*built;
    let (ending, record) = match &built.world {
        World::Turning(rigid) => {
            let flown = Flight { plan, draw, built, engine: rigid.as_ref(), contacts }.fly(scratch, stop)?;
            (flown.ending, flown.record.map(|(trace, spans, end)| (Traced::Turning(trace), spans, end)))
        }
        World::Marbles(world) => {
            let flown = Flight { plan, draw, built, engine: &world.world, contacts }.fly(marbles, stop)?;
            (flown.ending, flown.record.map(|(trace, spans, end)| (Traced::Marbles(trace), spans, end)))
        }
    };
    *last = record.map(|(trace, spans, end)| Record { draw: draw.clone(), trace, spans, end });
    Ok(ending)
}

/// What met, of the bodies that are there; `bodies` counts all.
fn met(impacts: &[Impact], built: &Built, bodies: usize) -> Vec<[u32; 2]> {
    let there = built.there.as_slice();
    let (mut seen, mut met) = (BTreeSet::new(), Vec::new());
    for hit in impacts {
        let other = built.number(hit.other, bodies);
        let body = there[hit.body];
        let pair = [body.min(other) as u32, body.max(other) as u32];
        if seen.insert(pair) {
            met.push(pair);
        }
    }
    met
}

impl Last {
    /// Which of its axes is nearest to up: 0 to 2, or 3 to 5 for those that point down.
    fn uppermost(&self) -> i64 {
        let up = self.turn.conjugate() * DVec3::Z;
        let axis = (1..3).fold(0, |best, k| if up[k].abs() > up[best].abs() { k } else { best });
        if up[axis] < 0.0 { axis as i64 + 3 } else { axis as i64 }
    }
}

impl Done {
    /// The features of a solution, for cells of a width in m. Of a ball no axis counts. `there` are the bodies that are
    /// there.
    pub(super) fn features(
        &self,
        features: &mut Features,
        cell: f64,
        is_ball: impl Fn(usize) -> bool,
        there: &[usize],
    ) {
        for (last, &index) in self.bodies.iter().zip(there) {
            (last.place / cell).to_array().iter().for_each(|x| features.place(*x));
            features.number(if is_ball(index) { 0 } else { last.uppermost() });
        }
        self.met.iter().flatten().for_each(|&one| features.number(i64::from(one)));
    }
}

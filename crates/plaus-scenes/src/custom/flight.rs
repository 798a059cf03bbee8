//! One simulation: from a draw to where everything ends, and what met on the way.

use super::animate::{film, left, reach};
use super::ending::{Done, Ending, Failed, Last, Overlap};
use super::engine::Engine;
use super::plan::{Built, Plan, World};
use super::rods;
use super::values::Drawn;
use super::waiting::Waitings;
use crate::animation::{Left, Motion, Track};
use crate::failed::Cause;
use crate::film::Reel;
use crate::loads::{Loads, Span};
use crate::require::{Kept, Stop};
use plaus_dist::LogPotential;
use plaus_mcmc::ModelError;
use plaus_sim::marbles::{Marble, MarbleScratch, Marbles};
use plaus_sim::mechanics::{Impact, Island, Other};
use plaus_sim::rigid::{RigidBodyState, RigidScratch, RigidWorld, Start};
use plaus_sim::trace::{Observer, Trace};
use plaus_sim::{Outcome, Scratch, State, WorldError, is_interrupted};
use std::collections::BTreeSet;

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
    pub(super) kept: Kept,
}

impl Record {
    /// The motion of all bodies, their impacts and contacts.
    pub(super) fn film(&self, plan: &Plan, built: &Built) -> Motion {
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

    /// How bodies are left at a time, as [`left`] says.
    pub(super) fn left(&self, plan: &Plan, built: &Built, time: f64) -> Vec<Left> {
        match (&self.trace, &built.world) {
            (Traced::Turning(trace), World::Turning(rigid)) => left(plan, (rigid.as_ref(), built), trace, time),
            (Traced::Marbles(trace), World::Marbles(marbles)) => left(plan, (&marbles.world, built), trace, time),
            _ => unreachable!("a world has one kind of bodies"),
        }
    }

    /// What is drawn of strings, as [`rods::strings`] says.
    pub(super) fn strings(&self, plan: &Plan, built: &Built, tracks: &[Track]) -> Vec<Track> {
        match (&self.trace, &built.world) {
            (Traced::Turning(trace), World::Turning(rigid)) => {
                rods::strings(plan, (rigid.as_ref(), built), trace, tracks, self.end)
            }
            _ => Vec::new(),
        }
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
        let mut built = match self.built.take().filter(|_| plan.is_steady) {
            Some(built) => built,
            None => plan.build(&plan.works.numbers(Some(draw)))?,
        };
        plan.scatter_impacts(draw, &mut built);
        Ok(self.built.insert(built))
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
        let is_late = |index: usize| self.bodies[built.there[index]].late.is_some();
        let mut crowded = vec![false; self.bodies.len()];
        for (k, (place, reach)) in discs.iter().enumerate().filter(|(k, _)| !is_late(*k)) {
            for (j, (other, others)) in discs[..k].iter().enumerate().filter(|(j, _)| !is_late(*j)) {
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
    /// What has not appeared, and when the run is to be stopped for what comes next, in s.
    waitings: Waitings,
    until: f64,
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
        self.waitings.hit(impact, self.flight.built, self.flight.plan.bodies.len());
    }

    fn motion(&mut self, index: usize, body: &E::Body) {
        if self.waitings.has(index) {
            return;
        }
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
        let goes_on = !self.reel.is_full() && self.reel.goes_on(state.time(), LogPotential::ONE, begun);
        goes_on && !self.waitings.is_due::<E>(state.bodies(), &built.there, [state.time(), self.until])
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
    /// Runs to the end, and lets bodies appear on the way.
    fn go(
        &self,
        state: &mut State<E::Body>,
        scratch: &mut Scratch<E::Scratch>,
        listener: &mut Listener<'_, E>,
        starts: &[Start],
    ) -> Result<Result<Outcome, Failed>, ModelError> {
        let Self { plan, built, engine, .. } = *self;
        loop {
            listener.until = listener.waitings.next().map_or(plan.duration, |due| due.min(plan.duration));
            let outcome = engine.go(state, scratch, listener.until, listener).map_err(ModelError::new)?;
            let is_cut = listener.reel.is_hopeless || listener.reel.is_full() || is_interrupted();
            let is_paused = matches!(outcome, Outcome::TimeReached | Outcome::AllAtRest | Outcome::Stopped);
            if is_cut || !is_paused || listener.waitings.is_empty() {
                return Ok(Ok(outcome));
            }
            let Some(index) = listener.waitings.take(state.time()) else {
                if outcome == Outcome::Stopped {
                    continue;
                }
                let rests = |(k, body)| listener.waitings.has(k) || engine.is_resting(body);
                let all = state.bodies().iter().enumerate().all(rests);
                return Ok(Ok(if all { Outcome::AllAtRest } else { outcome }));
            };
            let start = Start { time: state.time(), ..starts[index] };
            if let Err(error) = engine.put(state, index, &start) {
                let Some(Overlap { body, other, .. }) = plan.overlapping(&error, built) else {
                    return Err(ModelError::new(error));
                };
                let late = built.there[index] as u32;
                let other = if body == late { other } else { body };
                let failed = Failed { cause: Cause::Appears, body: late, other: Some(other), time: state.time() };
                return Ok(Err(failed));
            }
            if plan.bodies[built.there[index]].acting.is_asleep {
                engine.put_to_sleep(state, index).map_err(ModelError::new)?;
            }
        }
    }

    fn fly(&self, scratch: &mut Scratch<E::Scratch>, stop: Option<Stop>) -> Result<Flown<E::Body>, ModelError> {
        let Self { plan, draw, built, engine, contacts } = *self;
        let there = built.there.as_slice();
        let numbers = plan.works.numbers(Some(draw));
        let starts = plan.starts(&numbers, there, &built.shapes);
        let mut state = match plan.begin(engine, built, &starts).map_err(ModelError::new)? {
            Ok(state) => state,
            Err(overlap) => return Ok(Flown::early(Some(Ending::Overlap(overlap)))),
        };
        for index in (0..there.len()).filter(|&index| plan.bodies[there[index]].acting.is_asleep) {
            engine.put_to_sleep(&mut state, index).map_err(ModelError::new)?;
        }
        let (loads, whole) = (contacts.then(Loads::default), vec![None; there.len()]);
        let waitings = Waitings::new(plan, &numbers, there);
        let reel = Reel::new(stop);
        let mut listener = Listener { flight: self, reel, loads, whole, waitings, until: plan.duration };
        let outcome = match self.go(&mut state, scratch, &mut listener, &starts)? {
            Ok(outcome) => outcome,
            Err(failed) => return Ok(Flown::early(Some(Ending::Failed(failed)))),
        };
        if listener.reel.is_hopeless {
            return Ok(Flown::early(None));
        }
        (0..there.len()).for_each(|index| listener.reckon(index, state.time()));
        if let Some((cause, body, touched)) = failed(outcome, &listener.reel) {
            let other = touched.map(|other| built.number(other, plan.bodies.len()) as u32);
            let failed = Failed { cause, body: there[body] as u32, other, time: state.time() };
            return Ok(Flown::early(Some(Ending::Failed(failed))));
        }
        let has_appeared = |index: &usize| !listener.waitings.has(*index);
        let end = if outcome == Outcome::AllAtRest {
            let times = (0..there.len()).filter(has_appeared).map(|index| E::path(&state.bodies()[index]).t);
            times.fold(0.0, f64::max)
        } else {
            plan.duration
        };
        let last = |(index, body): (usize, &E::Body)| {
            if !has_appeared(&index) {
                return Last::NEVER;
            }
            let (place, turn) = engine.pose(index, body, end.max(E::path(body).t));
            Last { place, turn: (turn * built.shapes[index].axes.conjugate()).normalize(), rest: E::rest(body) }
        };
        let bodies: Vec<Last> = state.bodies().iter().enumerate().map(last).collect();
        let (trace, spans) = (listener.reel.trace, listener.loads.map(Loads::into_spans).unwrap_or_default());
        let met = met(&trace.impacts, built, plan.bodies.len());
        let scattered = built.scattered(engine.scattered(&state), plan.bodies.len());
        Ok(Flown { ending: Some(Ending::Done(Done { bodies, met, scattered })), record: Some((trace, spans, end)) })
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
pub(super) fn fly(
    plan: &Plan,
    draw: &Drawn,
    stop: Option<Stop>,
    work: &mut Work,
) -> Result<Option<Ending>, ModelError> {
    let contacts = work.kept.contacts;
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

//! One simulation: from a draw to where everything ends, and what met on the way.

use super::animate::film;
use super::plan::{Built, Plan, part};
use super::values::Drawn;
use crate::animation::Animation;
use crate::film::Reel;
use crate::model::Features;
use crate::require::Watched;
use glam::{DQuat, DVec3};
use plaus_dist::LogPotential;
use plaus_mcmc::ModelError;
use plaus_sim::mechanics::{Impact, Other};
use plaus_sim::rigid::{Phase, Rigid, RigidScratch, Turning};
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
    /// The simulator's budget of events was spent: the draw has probability 0.
    Unfinished,
    /// A driven body left a body no way: the draw has probability 0.
    Crushed(Crushed),
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

/// A body that a driven one left no way.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Crushed {
    /// The body.
    pub body: u32,
    /// The driven body.
    pub by: u32,
    /// When, in s.
    pub time: f64,
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
    pub(super) draw: Drawn,
    pub(super) trace: Trace<Turning>,
    /// When it ends, in s.
    pub(super) end: f64,
}

/// Memory of a chain's simulations.
#[derive(Debug, Default)]
pub struct Work {
    scratch: Scratch<RigidScratch>,
    /// The simulator's world: of the last draw, or of all.
    built: Option<Built>,
    /// What was simulated last.
    last: Option<Record>,
    pub(super) watched: Watched,
}

impl Record {
    /// The motion of all bodies, their impacts and contacts.
    pub(super) fn film(&self, plan: &Plan, built: &Built) -> Animation {
        film(plan, &self.draw, built, &self.trace, [self.end, f64::INFINITY]).motion
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
    fn overlapping(&self, error: &WorldError, there: &[usize]) -> Option<Overlap> {
        let of =
            |body: usize, other: usize, depth: f64| Overlap { body: there[body] as u32, other: other as u32, depth };
        match error {
            WorldError::BodiesOverlap { a, b, depth } => Some(of(*a, there[*b], *depth)),
            WorldError::OverlapsScenery { body, surface, depth } => {
                let part: usize = surface.strip_prefix("part ")?.parse().ok()?;
                Some(of(*body, self.bodies.len() + part, *depth))
            }
            _ => None,
        }
    }

    /// What begins inside what, in a draw.
    pub(super) fn overlap(&self, draw: &Drawn, work: &mut Work) -> Result<Option<Overlap>, WorldError> {
        let built = work.world(self, draw)?;
        let starts = self.starts(&self.works.numbers(Some(draw)), &built.there, &built.shapes);
        match built.rigid.state(&starts) {
            Ok(_) => Ok(None),
            Err(error) => self.overlapping(&error, &built.there).map(Some).ok_or(error),
        }
    }
}

/// Listens to a run.
struct Listener<'a> {
    plan: &'a Plan,
    draw: &'a Drawn,
    built: &'a Built,
    reel: Reel,
}

impl Observer<Rigid> for Listener<'_> {
    fn impact(&mut self, impact: &Impact) {
        self.reel.impact(impact);
    }

    fn motion(&mut self, index: usize, body: &Turning) {
        self.reel.motion(index, body);
    }

    fn proceed(&mut self, state: &State<Turning>) -> bool {
        let ends = [self.plan.duration, state.time()];
        let begun = |trace: &_| Some(film(self.plan, self.draw, self.built, trace, ends));
        self.reel.goes_on(state.time(), LogPotential::ONE, begun)
    }
}

/// Simulates a draw; `None` if it can no longer be accepted.
pub(super) fn fly(plan: &Plan, draw: &Drawn, work: &mut Work) -> Result<Option<Ending>, ModelError> {
    let stop = work.watched.stop.take();
    work.last = None;
    work.world(plan, draw).map_err(ModelError::new)?;
    let Work { scratch, built: Some(built), last: record, .. } = work else {
        return Err(ModelError::new("a world was made but is missing: a bug"));
    };
    let there = built.there.as_slice();
    let starts = plan.starts(&plan.works.numbers(Some(draw)), there, &built.shapes);
    let mut state = match built.rigid.state(&starts) {
        Ok(state) => state,
        Err(error) => {
            let overlap = plan.overlapping(&error, there).map(Ending::Overlap);
            return overlap.map(Some).ok_or_else(|| ModelError::new(error));
        }
    };
    for index in (0..there.len()).filter(|&index| plan.bodies[there[index]].acting.is_asleep) {
        built.rigid.put_to_sleep(&mut state, index).map_err(ModelError::new)?;
    }
    let mut listener = Listener { plan, draw, built, reel: Reel::new(stop) };
    let outcome = built.rigid.run(&mut state, scratch, f64::INFINITY, &mut listener).map_err(ModelError::new)?;
    let Reel { trace, is_hopeless, .. } = listener.reel;
    match outcome {
        _ if is_hopeless => return Ok(None),
        Outcome::NotFinite { body } => {
            let name = &plan.bodies[there[body]].name;
            return Err(ModelError::new(format!("the motion of {name:?} is no longer finite")));
        }
        Outcome::OutOfEvents => return Ok(Some(Ending::Unfinished)),
        Outcome::Crushed { body, by } => {
            let [body, by] = [body, by].map(|k| there[k] as u32);
            return Ok(Some(Ending::Crushed(Crushed { body, by, time: state.time() })));
        }
        _ => {}
    }
    let end = if outcome == Outcome::AllAtRest {
        state.bodies().iter().map(|body| body.path.t).fold(0.0, f64::max)
    } else {
        plan.duration
    };
    let last = |(index, body): (usize, &Turning)| {
        let rests = body.phase == Phase::Rest;
        let rest = rests.then_some(body.path.t);
        let at = if rests { body.clone() } else { built.rigid.on_its_way(index, body, end.max(body.path.t)) };
        Last { place: at.path.x, turn: (at.turn * built.shapes[index].axes.conjugate()).normalize(), rest }
    };
    let bodies: Vec<Last> = state.bodies().iter().enumerate().map(last).collect();
    let met = met(&trace, there, plan.bodies.len());
    *record = Some(Record { draw: draw.clone(), trace, end });
    Ok(Some(Ending::Done(Done { bodies, met })))
}

/// What met, of the bodies that are there; `bodies` counts all.
fn met(trace: &Trace<Turning>, there: &[usize], bodies: usize) -> Vec<[u32; 2]> {
    let (mut seen, mut met) = (BTreeSet::new(), Vec::new());
    for hit in &trace.impacts {
        let other = match hit.other {
            Other::Body(other) => there[other],
            Other::Surface(surface) => bodies + part(surface),
        };
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
    /// there, which count too if there could be `others`.
    pub(super) fn features(
        &self,
        features: &mut Features,
        cell: f64,
        is_ball: impl Fn(usize) -> bool,
        (there, others): (&[usize], bool),
    ) {
        for (last, &index) in self.bodies.iter().zip(there) {
            (last.place / cell).to_array().iter().for_each(|x| features.place(*x));
            features.number(if is_ball(index) { 0 } else { last.uppermost() });
        }
        self.met.iter().flatten().for_each(|&one| features.number(i64::from(one)));
        if others {
            // No body has the number −1, which ends the list of those that met.
            features.number(-1);
            there.iter().for_each(|&index| features.number(index as i64));
        }
    }
}

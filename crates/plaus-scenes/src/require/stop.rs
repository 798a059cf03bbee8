//! The one early stop of all scenes: a simulation shows its motion while it runs, and ends as soon as the requirements
//! rule out that it can still be accepted. Each says for itself what a beginning leaves possible ([`Require::reach`]);
//! a whole motion is judged by the same functions, so stopping early cannot change a decision.

use super::begun::Begun;
use super::cast::Cast;
use super::kinds::Require;
use super::looks::Looks;
use super::probe::Probe;
use crate::animation::Motion;
use plaus_dist::LogPotential;
use std::sync::Arc;

/// How simulations are stopped: for tests that compare with twins.
#[doc(hidden)]
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Stops {
    /// As soon as nothing that may come can help.
    #[default]
    Soundly,
    /// Never.
    Never,
    /// As if what is known were the whole motion: wrong.
    Hastily,
}

/// The requirements, and the cast that they are about.
#[derive(Debug, Clone)]
pub(super) struct Asks {
    pub(super) requirements: Vec<Require>,
    pub(super) cast: Cast,
    /// Which bodies each of them names.
    pub(super) named: Vec<Vec<bool>>,
    /// The most that all requirements together can contribute, in nats.
    pub(super) most: f64,
    pub(super) looks: Looks,
    pub(super) stops: Stops,
}

impl Asks {
    pub(super) fn new(requirements: &[Require], cast: Cast, named: Vec<Vec<bool>>) -> Self {
        let (requirements, looks) = (requirements.to_vec(), Looks::of_all(requirements.iter().map(Require::looks)));
        let nothing = Motion::default();
        let mut asks = Self { requirements, cast, named, most: 0.0, looks, stops: Stops::default() };
        asks.most = asks.bound(&Probe::until(&nothing, &asks.cast, 0.0));
        asks
    }

    /// Bodies that a requirement wants to come to rest, although nothing ever stops them once they roll.
    pub(super) fn never_at_rest(&self) -> Option<String> {
        let wanted = |name: &String| {
            let body = self.cast.bodies.iter().position(|body| body == name);
            let asks = |(one, named): (&Require, &Vec<bool>)| one.needs_rest() && body.is_some_and(|body| named[body]);
            self.requirements.iter().zip(&self.named).any(asks)
        };
        let mut found = self.cast.restless.iter().filter(|(body, _)| wanted(body));
        let (body, ground) = found.next()?;
        let others = match found.count() {
            0 => String::new(),
            1 => " (nor does another body)".to_owned(),
            more => format!(" (nor do {more} other bodies)"),
        };
        Some(format!(
            "a requirement wants {body:?} to come to rest, but once it rolls on {ground:?} it never does{others}, \
             because neither of their materials has resistance to rolling: set `rolling` of one, such as `rolling = 0.01`"
        ))
    }

    /// The most that the requirements can still contribute, in nats.
    pub(super) fn bound(&self, probe: &Probe<'_>) -> f64 {
        self.requirements.iter().fold(0.0, |sum, one| sum + one.reach(probe).most.log)
    }
}

/// A bound counts as less than a floor only if it is less by more than this part, because sums in another order may
/// differ by some units in the last place.
const ROUNDING: f64 = 1e-9;

/// Events after which a motion is looked at for the first time, where any impact may rule it out; then after twice as
/// many, and so on, so that all looks together cost no more than two at the end. Default 32: a die has 20 to 100.
const FIRST: u64 = 32;

/// Ends a simulation that can no longer be accepted.
#[derive(Debug, Clone)]
pub struct Stop {
    asks: Arc<Asks>,
    floor: f64,
    /// How many of the times have passed.
    passed: usize,
    events: u64,
    /// The number of events after which to look next.
    due: u64,
}

impl Stop {
    /// For a candidate whose log constraint must exceed `floor`; `None` if no beginning can rule it out.
    pub(super) fn new(asks: &Arc<Asks>, floor: LogPotential) -> Option<Self> {
        let Looks { times, impacts, .. } = &asks.looks;
        let tells = !floor.is_zero() && (*impacts || !times.is_empty()) && asks.stops != Stops::Never;
        tells.then(|| Self { asks: Arc::clone(asks), floor: floor.value(), passed: 0, events: 0, due: FIRST })
    }

    /// The times, in s, after which the motion is to be looked at.
    pub(crate) fn times(&self) -> &[f64] {
        &self.asks.looks.times
    }

    /// Whether to look at the motion after an event at this time, in s.
    pub(crate) fn is_due(&mut self, time: f64) -> bool {
        self.events += 1;
        let before = self.passed;
        self.passed += self.times()[before..].partition_point(|at| *at < time);
        let often = self.asks.looks.impacts && self.events >= self.due;
        if often {
            self.due = 2 * self.events;
        }
        often || self.passed > before
    }

    /// Whether a beginning rules out the candidate, if its scene's own log constraint is `own` at most.
    pub(crate) fn is_hopeless(&self, own: LogPotential, begun: &Begun) -> bool {
        let Asks { cast, stops, .. } = &*self.asks;
        let probe = match stops {
            Stops::Hastily => Probe::whole(&begun.motion, cast),
            Stops::Soundly | Stops::Never => Probe::of(begun, cast),
        };
        let most = own.value() + self.asks.bound(&probe);
        most + ROUNDING * (1.0 + most.abs()) <= self.floor
    }
}

/// What a chain's memory keeps of the motions that it simulates.
#[derive(Debug, Default)]
pub(crate) struct Kept {
    /// Whether motions are kept.
    pub(crate) motions: bool,
    /// Whether it is told which bodies bear on what.
    pub(crate) contacts: bool,
}

impl Kept {
    /// From now on motions are kept, with what bears on what if `contacts` asks for it.
    pub(crate) fn keep(&mut self, contacts: bool) {
        self.motions = true;
        self.contacts |= contacts;
    }
}

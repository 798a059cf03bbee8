//! One shot: from a draw to the pins that are left.

use super::animate::{begin, film};
use super::draw::Shot;
use super::lane::{LENGTH, Lane, WIDTH};
use super::still::Still;
use super::verdict::Verdict;
use crate::animation::Motion;
use crate::failed::{Cause, failure};
use crate::film::Reel;
use crate::require::{Begun, Kept, Stop};
use crate::scene::Until;
use plaus_dist::{LogPotential, math};
use plaus_mcmc::{Failure, ModelError};
use plaus_sim::mechanics::{Impact, Other};
use plaus_sim::rigid::{RigidBodyState, RigidScratch, RigidWorld, Start};
use plaus_sim::trace::{Observer, Trace};
use plaus_sim::{Outcome, Scratch, State};
use serde::{Deserialize, Serialize};

/// Longest time of a shot that is shown, in s.
const LONGEST: f64 = 30.0;

/// The outcome of a shot.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Rest {
    /// The fate of each pin that was set up, in ascending order of their numbers.
    pub pins: Vec<Fate>,
    /// Where and how the ball met the first pin, if it did.
    pub entry: Option<Entry>,
    /// Numbers of the pins that the ball itself struck, in the order in which it did.
    pub struck: Vec<u8>,
    /// Whether the simulation came to its end. If it did not, the draw has probability 0.
    pub complete: bool,
    /// Why it did not; no state of a chain has such an outcome.
    #[serde(skip)]
    pub failed: Option<Box<Failure>>,
}

/// The fate of a pin.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub enum Fate {
    /// It stands, at this distance in m from where it was set.
    Standing(f64),
    /// It has fallen, or is gone.
    Down,
}

/// How a ball met the first pin.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Entry {
    /// Place of the ball's centre across the lane in m.
    pub across: f64,
    /// Angle of its path to the lane's direction in degrees, to the bowler's right.
    pub angle: f64,
}

impl Fate {
    /// Whether the pin stands.
    #[must_use]
    pub fn stands(self) -> bool {
        matches!(self, Self::Standing(_))
    }
}

/// The distance of a pin's middle from where it was set, in m.
fn way(pin: &RigidBodyState, start: &Start, time: f64) -> f64 {
    (pin.path.at(time) - start.position).truncate().length()
}

/// Whether the ball has left the lane before the lane's end. By the rules of the game it is then dead, whatever it may
/// still do.
fn is_in_gutter(ball: &RigidBodyState) -> bool {
    ball.path.x.x.abs() >= 0.5 * WIDTH && ball.path.x.y < 0.0
}

/// Some of the pins that were set up, by their places in the rack.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(super) struct Pins(u16);

impl Pins {
    pub(super) fn contains(self, place: usize) -> bool {
        self.0 >> place & 1 == 1
    }

    fn insert(&mut self, place: usize) {
        self.0 |= 1 << place;
    }
}

/// Memory of a chain's simulations.
#[derive(Debug, Default)]
pub struct Work {
    scratch: Scratch<RigidScratch>,
    pub(super) kept: Kept,
    /// What was simulated last, if motions are kept.
    last: Option<Record>,
}

/// A recorded shot.
#[derive(Debug)]
pub(super) struct Record {
    draw: Shot,
    world: RigidWorld,
    trace: Trace<RigidBodyState>,
    /// When it ends, in s.
    end: f64,
}

impl Record {
    /// The bodies alone.
    pub(super) fn film(&self, lane: &Lane) -> Result<Motion, ModelError> {
        let begun = film(lane, &self.draw, (&self.world, &self.trace), [self.end, f64::INFINITY]);
        Ok(begun.ok_or_else(|| ModelError::new("a whole shot has no beginning: a bug"))?.motion)
    }
}

impl Work {
    /// The motions of a draw, if it was simulated last and they were kept.
    pub(super) fn recorded(&self, draw: &Shot) -> Option<&Record> {
        self.last.as_ref().filter(|record| record.draw == *draw)
    }
}

impl Lane {
    /// k and m: how many pins end as they should, and how many of those rewarded for it stand and have not moved far.
    pub(super) fn counts(&self, pins: &[Fate]) -> (u64, u64) {
        let (mut k, mut m) = (0, 0);
        for ((fate, &leave), far) in pins.iter().zip(&self.leave).zip(&self.far) {
            k += u64::from(fate.stands() == leave);
            m += u64::from(far.is_some_and(|far| matches!(fate, Fate::Standing(way) if *way <= far)));
        }
        (k, m)
    }

    /// What a shot is worth that ends like this: its log constraint.
    pub(super) fn worth(&self, pins: &[Fate]) -> LogPotential {
        let (k, m) = self.counts(pins);
        self.goal.log_potential(k + m)
    }

    /// The most that a shot with these pins down can be worth.
    pub(super) fn most(&self, down: Pins) -> LogPotential {
        let one = |(place, leave): (usize, &bool)| match (down.contains(place), leave) {
            (true, true) => 0,
            (false, true) => 2,
            // Down as it should be; or standing, if any standing pin is rewarded.
            (_, false) => 1,
        };
        self.goal.log_potential(self.leave.iter().enumerate().map(one).sum())
    }

    /// Bowls from `distance` m before the head pin's spot. Stops as soon as no pin's fate can change, or the shot
    /// cannot be worth more than `floor`; in that case there is no outcome. If motions are kept, it goes on to the
    /// scenario's `duration_s`.
    pub(super) fn bowl(
        &self,
        draw: &Shot,
        distance: f64,
        work: &mut Work,
        (floor, stop): (LogPotential, Option<Stop>),
        observer: impl Observer<RigidWorld>,
    ) -> Result<Option<Rest>, ModelError> {
        let records = work.kept.motions;
        work.last = None;
        let (world, starts) = self.world(draw, distance).map_err(ModelError::new)?;
        let mut state = world.state(&starts).map_err(ModelError::new)?;
        let film = |trace: &_, known| film(self, draw, (&world, trace), [f64::INFINITY, known]);
        let mut umpire = Umpire {
            lane: self,
            world: &world,
            verdict: self.verdict.with_ball(&self.alley(draw)),
            starts: &starts,
            still: Still::default(),
            floor,
            reel: records.then(|| Reel::new(stop)),
            begin: None,
            film,
            gave_up: false,
            over: None,
            down: Pins::default(),
            path: None,
            entry: None,
            struck: Vec::new(),
        };
        let duration = self.alley.duration;
        let outcome = world
            .run(&mut state, &mut work.scratch, duration, &mut (&mut umpire, observer))
            .map_err(ModelError::new)?;
        if umpire.gave_up {
            return Ok(None);
        }
        let name = |other: Other| match other {
            Other::Body(0) => "ball".to_owned(),
            Other::Body(body) => format!("pin_{}", self.pins[body - 1]),
            Other::Surface(_) => "lane".to_owned(),
        };
        // A shot that is decided does not depend on what comes after.
        let undecided = Some(outcome).filter(|_| umpire.over.is_none());
        let failed = match &umpire.reel {
            Some(reel) if reel.is_full() => Some(Cause::TooLong.failure("the simulation", None, state.time())),
            _ => undecided.and_then(|outcome| failure(outcome, state.time(), name)),
        };
        let failed = failed.map(Box::new);
        let pins = umpire.over.take().unwrap_or_else(|| umpire.fates(&state));
        let struck = umpire.struck.iter().map(|&body| self.pins[body - 1] as u8).collect();
        let (entry, reel) = (umpire.entry, umpire.reel);
        if let Some(Reel { trace, .. }) = reel {
            let end = last_event(&trace);
            work.last = Some(Record { draw: draw.clone(), world, trace, end });
        }
        Ok(Some(Rest { pins, entry, struck, complete: failed.is_none(), failed }))
    }

    /// Bowls and records the shot: the world, all motions, and when it ends. Without a given end, it lasts for the
    /// scenario's `duration_s`.
    pub(super) fn record(&self, draw: &Shot, work: &mut Work, until: Option<Until>) -> Result<Record, ModelError> {
        let mut trace = Trace::default();
        if until == Some(Until::Decided) {
            let mut clock = Clock(0.0);
            self.bowl(draw, LENGTH, work, (LogPotential::ZERO, None), (&mut trace, &mut clock))?;
            let (world, _) = self.world(draw, LENGTH).map_err(ModelError::new)?;
            return Ok(Record { draw: draw.clone(), world, trace, end: clock.0 });
        }
        let (world, starts) = self.world(draw, LENGTH).map_err(ModelError::new)?;
        let mut state = world.state(&starts).map_err(ModelError::new)?;
        let longest = until.map_or(self.alley.duration, |_| self.alley.duration.max(LONGEST));
        let outcome = world.run(&mut state, &mut work.scratch, longest, &mut trace).map_err(ModelError::new)?;
        let is_cut = until.is_some() && outcome == Outcome::TimeReached;
        let end = if is_cut { longest } else { last_event(&trace) };
        Ok(Record { draw: draw.clone(), world, trace, end })
    }
}

/// The time of the last motion of a trace, in s.
fn last_event(trace: &Trace<RigidBodyState>) -> f64 {
    trace.motions.iter().filter_map(|motions| motions.last()).map(|motion| motion.path.t).fold(0.0, f64::max)
}

/// Notes the time of the last event.
struct Clock(f64);

impl Observer<RigidWorld> for Clock {
    fn proceed(&mut self, state: &State<RigidBodyState>) -> bool {
        self.0 = state.time();
        true
    }
}

/// Watches a shot: what the ball strikes, and when the shot is decided.
struct Umpire<'a, F> {
    lane: &'a Lane,
    world: &'a RigidWorld,
    verdict: Verdict,
    starts: &'a [Start],
    still: Still,
    /// What the shot must be worth more than.
    floor: LogPotential,
    /// If motions are kept: the recorder, when the animation begins, and what makes it of a trace.
    reel: Option<Reel>,
    begin: Option<f64>,
    film: F,
    gave_up: bool,
    /// What becomes of the pins, once it is decided.
    over: Option<Vec<Fate>>,
    /// Pins that have fallen at any time: one that rises again still counts as down.
    down: Pins,
    /// The ball's latest motion.
    path: Option<plaus_sim::motion::Parabola>,
    entry: Option<Entry>,
    /// Bodies that the ball struck.
    struck: Vec<usize>,
}

impl<F> Umpire<'_, F> {
    /// The fates of the pins as they are now.
    fn fates(&self, state: &State<RigidBodyState>) -> Vec<Fate> {
        let fate = |(place, (body, start)): (usize, (&RigidBodyState, &Start))| {
            if self.down.contains(place) {
                return Fate::Down;
            }
            Fate::Standing(way(body, start, state.time()))
        };
        state.bodies().iter().zip(self.starts).skip(1).enumerate().map(fate).collect()
    }

    /// Whether the shot is over after an event.
    fn is_over(&mut self, state: &State<RigidBodyState>) -> bool {
        if self.struck.is_empty() && is_in_gutter(&state.bodies()[0]) {
            return true;
        }
        self.still.look(state);
        let before = self.down;
        for (place, pin) in state.bodies()[1..].iter().enumerate() {
            if Verdict::has_fallen(pin) {
                self.down.insert(place);
            }
        }
        self.gave_up = self.down != before && self.lane.most(self.down) <= self.floor;
        self.gave_up || self.is_decided(state)
    }

    /// Whether no pin's fate can change any more, including whether it has moved far, if that counts.
    fn is_decided(&self, state: &State<RigidBodyState>) -> bool {
        let is_down = |body: usize| self.down.contains(body - 1);
        let Some(slack) = self.verdict.settled(self.world, state, &self.still, is_down) else { return false };
        let mut pins = state.bodies().iter().zip(self.starts).skip(1).zip(&self.lane.far).enumerate();
        pins.all(|(place, ((pin, start), far))| match far {
            Some(far) if !self.down.contains(place) => (way(pin, start, state.time()) - far).abs() > slack,
            _ => true,
        })
    }
}

impl<F: Fn(&Trace<RigidBodyState>, f64) -> Option<Begun>> Observer<RigidWorld> for Umpire<'_, F> {
    fn impact(&mut self, impact: &Impact) {
        if let Some(reel) = &mut self.reel {
            reel.impact(impact);
        }
        let (0, Other::Body(pin)) = (impact.body, impact.other) else { return };
        if self.over.is_some() || self.struck.contains(&pin) {
            return;
        }
        self.struck.push(pin);
        if let (None, Some(path)) = (self.entry, self.path) {
            let velocity = path.velocity_after(impact.time - path.t);
            let angle = math::atan2(velocity.x, velocity.y).to_degrees();
            self.entry = Some(Entry { across: path.at(impact.time).x, angle });
        }
    }

    fn motion(&mut self, index: usize, body: &RigidBodyState) {
        if let Some(reel) = &mut self.reel {
            reel.motion(index, body.recorded());
        }
        if index == 0 && self.entry.is_none() {
            self.path = Some(body.path);
        }
    }

    fn proceed(&mut self, state: &State<RigidBodyState>) -> bool {
        if self.over.is_none() && self.is_over(state) {
            let fates = self.fates(state);
            // If motions are kept, the rest of a shot is simulated only if it may be accepted.
            self.gave_up |= self.reel.is_some() && self.lane.worth(&fates) <= self.floor;
            self.over = Some(fates);
        }
        let Some(reel) = self.reel.as_mut().filter(|_| !self.gave_up) else { return self.over.is_none() };
        let time = state.time();
        self.begin = self.begin.or_else(|| begin(self.world, &reel.trace, self.lane.shown, time));
        let Some(begin) = self.begin else { return true };
        let most = self.lane.most(self.down);
        self.gave_up = !reel.goes_on(time - begin, most, |trace| (self.film)(trace, time));
        !self.gave_up && !reel.is_full()
    }
}

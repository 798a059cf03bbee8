//! Bodies that meet only level ground, and where they should end.
//!
//! The same throw from another place, or in another direction, ends elsewhere by as much, so moves can lead it. No
//! ratio relies on that: each is that of what is proposed, wherever the body ends.

use super::Custom;
use super::angles::{Turn, cells_of};
use super::ending::{Done, Ending, Last};
use super::flight::{Work, fly};
use super::handles::{FINEST, Handles, turned_by};
use super::plan::Plan;
use super::shapes::{Form, Round};
use super::there::There;
use super::values::{Drawn, Value};
use crate::dice::Rotation;
use crate::failed::Cause;
use crate::require::{Aim, End, Up, Zone};
use glam::{DQuat, DVec2, DVec3};
use plaus_dist::{Purpose, Seed, math};
use plaus_mcmc::{ModelError, Target};
use std::sync::{Mutex, PoisonError};

/// Draws of the prior in which it is looked whether bodies meet, and after how many events no more are.
const DRAWS: u64 = 32;
const EVENTS: u64 = 5_000;
/// How many events one of these draws may have for each body, and in all: where there are more, bodies lie on each
/// other.
const EVENTS_OF_A_BODY: u64 = 1_000;
const EVENTS_OF_A_DRAW: u64 = 2_000;

/// A body that can be led to where it should end.
#[derive(Debug)]
pub(super) struct Throw {
    /// Its place among the bodies.
    pub(super) body: usize,
    pub(super) handles: Handles,
    /// Where it should end, in any of these, as far as it can be led there by its place.
    pub(super) zones: Vec<Zone>,
    /// Where it should end, in any of these, whatever can be changed.
    pub(super) all: Vec<Zone>,
    /// Whether it has to come to rest.
    rests: bool,
    /// Which of its axes should point up.
    ups: Vec<Up>,
    /// Rotations of the body that change no motion.
    pub(super) rotations: Vec<DQuat>,
    /// Between which angle and its opposite throws are turned; `None`: they are not.
    pub(super) span: Option<f64>,
    /// Turns in the middle of parts of the span.
    pub(super) turns: Vec<Turn>,
    /// The body alone.
    alone: Plan,
    /// Memories that no trial uses at the moment.
    idle: Mutex<Vec<Work>>,
}

/// How a throw ends that begins in the middle of the law of its place.
#[derive(Debug)]
pub(super) struct Trial {
    /// With what it began.
    pub(super) begun: Drawn,
    /// From where it begins to where it ends, in mm.
    by: DVec2,
    /// How it is turned at the end.
    turn: DQuat,
}

impl Throw {
    /// A body of a world, for what is asked of it.
    fn new(world: &Custom, body: usize, aims: &[Aim]) -> Option<Self> {
        let (plan, moving) = (&world.plan, &world.plan.bodies[body]);
        let handles = world.handles.get(body)?.clone();
        let fits =
            moving.way.is_none() && moving.on.is_none() && moving.late.is_none() && moving.there == There::Always;
        if !fits || moving.acting.is_asleep {
            return None;
        }
        let (mut all, mut ups, mut rests) = (Vec::new(), Vec::new(), false);
        for aim in aims.iter().filter(|aim| aim.body == moving.name) {
            match aim.end {
                End::In(zone, at_rest) => {
                    rests |= at_rest;
                    all.push(zone);
                }
                End::Up(up) => ups.push(up),
            }
        }
        let leads =
            |zone: &&Zone| zone.leads().iter().zip(&handles.place).all(|(leads, place)| !leads || place.is_some());
        let zones: Vec<Zone> = all.iter().filter(leads).copied().collect();
        let is_relabelled = handles.turn.is_some() && !ups.is_empty();
        let rotations = if is_relabelled { moving.form.rotations() } else { vec![DQuat::IDENTITY] };
        let span = if all.is_empty() { None } else { world.span(&handles) };
        if zones.is_empty() && span.is_none() && rotations.len() == 1 {
            return None;
        }
        let (alone, idle) = (plan.alone(body), Mutex::default());
        let turns = span.map(cells_of).unwrap_or_default();
        Some(Self { body, handles, zones, all, rests, ups, rotations, span, turns, alone, idle })
    }

    /// Weights of the relabelled ends of a trial, by what is asked of the body's axes; their largest is 1.
    pub(super) fn weights(&self, trial: &Trial) -> Vec<f64> {
        let log = |rotation: &DQuat| self.log_up(trial.turn * *rotation);
        let logs: Vec<f64> = self.rotations.iter().map(log).collect();
        let most = logs.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        logs.into_iter().map(|log| math::exp(log - most)).collect()
    }

    /// What the direction of its axes adds to the log density.
    fn log_up(&self, turn: DQuat) -> f64 {
        let up = turn.conjugate() * DVec3::Z;
        self.ups.iter().map(|one| one.log(up)).sum::<f64>()
    }

    /// Its orientation in a draw, if it can be relabelled: its place there.
    pub(super) fn labelled(&self) -> Option<usize> {
        self.handles.turn.filter(|_| self.rotations.len() > 1)
    }

    /// Which of the rotations relabels a trial's body as that of a draw, which is turned by an angle.
    pub(super) fn label(&self, trial: &Trial, draw: &Drawn, angle: f64) -> usize {
        let Some(index) = self.handles.turn else { return 0 };
        let back = turned_by(-angle) * draw.turns[index];
        nearest(&self.rotations, |rotation| (trial.begun.turns[index] * rotation).dot(back))
    }

    /// With what the trial of a draw begins that is turned by an angle: from the middle of the law of its place, turned
    /// back, and with one label for all. It is the same, bit by bit, wherever the body begins and however it is turned
    /// and relabelled, unless rounding leads across the edge of a multiple.
    pub(super) fn shared(&self, world: &Custom, draw: &Drawn, angle: f64) -> Drawn {
        let mut draw = draw.clone();
        for handle in self.handles.place.iter().flatten() {
            draw.numbers[handle.number] = world.plan.works.middle().numbers[handle.number];
        }
        if let Some(course) = self.handles.course.as_ref().filter(|_| self.span.is_some()) {
            course.turn(world, &mut draw, -angle);
            course.round(world, &mut draw);
        }
        if let Some(index) = self.handles.turn.filter(|_| self.span.is_some() || self.rotations.len() > 1) {
            let turn = draw.turns[index];
            let turn = turn * self.rotations[nearest(&self.rotations, |rotation| (turn * rotation).w)];
            let turn = if turn.w < 0.0 { -turn } else { turn };
            let coarse = turn.to_array().map(|x| (x / FINEST).round() * FINEST);
            draw.turns[index] = DQuat::from_array(coarse).normalize();
        }
        draw
    }

    /// Tries the throw of a draw alone, turned back by an angle; `None` if it does not end as it has to.
    pub(super) fn trial(&self, world: &Custom, draw: &Drawn, angle: f64) -> Result<Option<Trial>, ModelError> {
        let begun = self.shared(world, draw, angle);
        let mut work = self.idle.lock().unwrap_or_else(PoisonError::into_inner).pop().unwrap_or_default();
        let ending = fly(&self.alone, &begun, None, &mut work);
        self.idle.lock().unwrap_or_else(PoisonError::into_inner).push(work);
        let Some(Ending::Done(Done { bodies, .. })) = ending? else { return Ok(None) };
        let [last] = bodies.as_slice() else { return Ok(None) };
        let by = level(last) - self.start(world, &begun);
        Ok(Some(Trial { begun, by, turn: last.turn }).filter(|_| last.rest.is_some() || !self.rests))
    }

    /// Where the body begins, in mm.
    pub(super) fn start(&self, world: &Custom, draw: &Drawn) -> DVec2 {
        let numbers = world.plan.works.numbers(Some(draw));
        DVec2::from_array(self.handles.at.map(|value| value.of(&numbers)))
    }

    /// Where the throw of a draw ends according to a trial, in mm, if it is turned by an angle.
    pub(super) fn led(&self, world: &Custom, draw: &Drawn, trial: &Trial, angle: f64) -> [f64; 2] {
        (self.start(world, draw) + trial.turned(Turn::by(angle))).to_array()
    }

    /// Where the body ends in a state.
    fn last<'a>(&self, world: &Custom, draw: &Drawn, ending: &'a Ending) -> Option<&'a Last> {
        let Ending::Done(done) = ending else { return None };
        let place = world.plan.there(draw).iter().position(|&body| body == self.body)?;
        done.bodies.get(place)
    }

    /// The same, in mm.
    pub(super) fn end(&self, world: &Custom, draw: &Drawn, ending: &Ending) -> Option<[f64; 2]> {
        self.last(world, draw, ending).map(|last| level(last).to_array())
    }

    /// Whether it ends otherwise than asked.
    pub(super) fn misses(&self, world: &Custom, draw: &Drawn, ending: &Ending) -> bool {
        let Some(last) = self.last(world, draw, ending) else { return true };
        let (end, is_up) = (level(last).to_array(), self.log_up(last.turn) >= 0.0);
        let is_in = self.all.is_empty() || self.all.iter().any(|zone| zone.holds(end));
        !is_up || !is_in || (self.rests && last.rest.is_none())
    }

    /// Whether it can be turned about the middle of where it should end.
    pub(super) fn is_turned(&self) -> bool {
        self.span.is_some() && self.handles.start.is_some() && self.zones.iter().any(|zone| zone.leads() == [true; 2])
    }
}

impl Trial {
    /// From begin to end, in mm, turned.
    pub(super) fn turned(&self, turn: Turn) -> DVec2 {
        turn.of(self.by)
    }
}

fn level(last: &Last) -> DVec2 {
    1e3 * last.place.truncate()
}

/// The rotation for which something is largest in size.
fn nearest(rotations: &[DQuat], of: impl Fn(DQuat) -> f64) -> usize {
    let sizes: Vec<f64> = rotations.iter().map(|rotation| of(*rotation).abs()).collect();
    (1..sizes.len()).fold(0, |best, k| if sizes[k] > sizes[best] { k } else { best })
}

impl Form {
    /// Rotations that map it to itself, the identity first; of a round body only half a turn about a level axis.
    fn rotations(&self) -> Vec<DQuat> {
        if let Some(([Value::Fixed(x), Value::Fixed(y), Value::Fixed(z)], _)) = &self.cuboid {
            let all = Rotation::of_cuboid(DVec3::new(*x, *y, *z));
            return all.iter().map(|rotation| rotation.pips(DQuat::IDENTITY)).collect();
        }
        let half = DQuat::from_xyzw(1.0, 0.0, 0.0, 0.0);
        if self.round == Round::Rod { vec![DQuat::IDENTITY, half] } else { vec![DQuat::IDENTITY] }
    }
}

impl Plan {
    /// Whether all scenery is level ground, and nothing but ground and other bodies acts on bodies.
    fn is_featureless(&self) -> bool {
        self.joints.is_empty()
            && self.free().len() == self.bodies.len()
            && self.parts.iter().all(|part| part.is_level())
    }

    /// The world with one body alone.
    fn alone(&self, body: usize) -> Self {
        let mut alone = self.clone();
        alone.bodies = vec![self.bodies[body].clone()];
        alone.is_steady = alone.is_steady();
        alone
    }
}

impl Custom {
    /// The bodies of this world that moves can lead to where they should end.
    pub(super) fn throws_for(&self, aims: &[Aim]) -> Vec<Throw> {
        if aims.is_empty() || !self.plan.is_featureless() {
            return Vec::new();
        }
        let throws = |body| Throw::new(self, body, aims);
        let throws: Vec<Throw> = (0..self.plan.bodies.len()).filter_map(throws).collect();
        if throws.is_empty() || self.plan.bodies.len() == 1 {
            return throws;
        }
        // Bodies that begin above others fall on them, which would take long to find out by simulation.
        let crowded = self.in_most_draws(|draw, work| self.plan.crowded(draw, work).ok().map(Some));
        let throws: Vec<Throw> = throws.into_iter().filter(|throw| !crowded[throw.body]).collect();
        if throws.is_empty() {
            return throws;
        }
        let meet = self.meeting();
        throws.into_iter().filter(|throw| !meet[throw.body]).collect()
    }

    /// What holds for each body in most of some draws of the prior: all, if a draw cannot tell (`None` within).
    fn in_most_draws(&self, mut holds: impl FnMut(&Drawn, &mut Work) -> Option<Option<Vec<bool>>>) -> Vec<bool> {
        let (mut counts, mut seen) = (vec![0; self.plan.bodies.len()], 0);
        let (mut work, begun) = (Work::default(), plaus_sim::work());
        for nth in 0..DRAWS {
            let draw = self.start(&mut Seed(0).chain(0).at(nth, Purpose::START));
            let Some(found) = holds(&draw, &mut work) else { continue };
            let Some(found) = found else { return vec![true; counts.len()] };
            seen += 1;
            counts.iter_mut().zip(found).for_each(|(count, holds)| *count += i32::from(holds));
            if plaus_sim::work() - begun > EVENTS {
                break;
            }
        }
        counts.into_iter().map(|count| 2 * count > seen).collect()
    }

    /// Which bodies meet others in most of some draws of the prior; all, if a draw is too long to tell.
    fn meeting(&self) -> Vec<bool> {
        let (count, mut plan) = (self.plan.bodies.len(), self.plan.clone());
        let most = EVENTS_OF_A_BODY.min(EVENTS_OF_A_DRAW / count as u64).max(1);
        plan.accuracy.events = plan.accuracy.events.min(most);
        self.in_most_draws(|draw, work| match fly(&plan, draw, None, work) {
            Ok(Some(Ending::Done(done))) => {
                let mut meets = vec![false; count];
                let pairs = done.met.iter().map(|pair| pair.map(|thing| thing as usize));
                pairs.filter(|[_, other]| *other < count).flatten().for_each(|body| meets[body] = true);
                Some(Some(meets))
            }
            Ok(Some(Ending::Failed(failed))) if failed.cause == Cause::OutOfEvents => Some(None),
            _ => None,
        })
    }

    /// How far throws have to be turned until their laws hardly allow it: a part of half a turn, in most of some draws
    /// of the prior. `None` if they cannot be turned.
    fn span(&self, handles: &Handles) -> Option<f64> {
        let course = handles.course.as_ref().filter(|course| course.is_any())?;
        let draws = (0..DRAWS).map(|nth| self.start(&mut Seed(0).chain(1).at(nth, Purpose::START)));
        let draws: Vec<Drawn> = draws.collect();
        let allows = |draw: &Drawn, angle: f64| {
            let numbers = self.plan.works.numbers(Some(draw));
            let log = |angle: f64| course.log_law(self, draw, &numbers, Turn::by(angle));
            log(angle).max(log(-angle)) > log(0.0) - FAR
        };
        let is_wide = |angle: f64| 2 * draws.iter().filter(|draw| allows(draw, angle)).count() > draws.len();
        let mut span = std::f64::consts::PI;
        while span > NARROWEST && !is_wide(0.5 * span) {
            span *= 0.5;
        }
        Some(span)
    }
}

/// What laws hardly allow, in nats; and the narrowest span.
const FAR: f64 = 8.0;
const NARROWEST: f64 = 1e-3;

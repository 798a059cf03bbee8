//! Bodies that meet only level ground, and where they should end.
//!
//! The same throw from another place, or in another direction, ends elsewhere by as much, so moves can lead it. No ratio
//! relies on that: each is that of what is proposed, wherever the body ends.

use super::Custom;
use super::flight::{Done, Ending, Work, fly};
use super::handles::{Handle, Handles};
use super::plan::Plan;
use super::solids::Form;
use super::there::There;
use super::values::{Drawn, Value};
use crate::dice::Rotation;
use crate::require::{Aim, End, Up, Zone};
use glam::{DQuat, DVec3};
use plaus_dist::stream::below;
use plaus_dist::{Purpose, Seed, Stream, math};
use plaus_mcmc::{ModelError, Target};
use std::sync::{Mutex, PoisonError};

/// Draws of the prior in which it is looked whether bodies meet, and after how many events no more are.
const DRAWS: u64 = 32;
const EVENTS: u64 = 100_000;

/// Finest part of an orientation in a trial: its components are multiples of this. An orientation and the same one
/// relabelled differ by rounding, but not in these multiples, so they share a trial.
const FINEST: f64 = 1.0 / (1_u64 << 40) as f64;

/// A body that can be led to where it should end.
#[derive(Debug)]
pub(super) struct Throw {
    /// Its place among the bodies.
    pub(super) body: usize,
    pub(super) handles: Handles,
    /// Where it should end, in any of these, which ask only for what can be led.
    pub(super) zones: Vec<Zone>,
    /// Whether it has to come to rest.
    rests: bool,
    /// Which of its axes should point up.
    ups: Vec<Up>,
    /// Rotations of the body that change no motion.
    pub(super) rotations: Vec<DQuat>,
    /// The body alone.
    alone: Plan,
    /// Values in the middle of the laws of its place.
    middle: [f64; 2],
    /// Memories that no trial uses at the moment.
    idle: Mutex<Vec<Work>>,
}

/// How a throw ends that begins in the middle of the law of its place.
#[derive(Debug, Clone, Copy)]
pub(super) struct Trial {
    /// Where, in mm.
    pub(super) end: [f64; 2],
    /// How it is turned, and was at the beginning.
    turn: DQuat,
    begun: DQuat,
}

impl Throw {
    /// A body of a world, for what is asked of it.
    fn new(world: &Custom, body: usize, aims: &[Aim]) -> Option<Self> {
        let (plan, moving) = (&world.plan, &world.plan.bodies[body]);
        let handles = world.handles.get(body)?.clone();
        let fits = moving.way.is_none() && moving.on.is_none() && moving.there == There::Always;
        if !fits || moving.acting.is_asleep {
            return None;
        }
        let (mut zones, mut ups, mut rests) = (Vec::new(), Vec::new(), false);
        for aim in aims.iter().filter(|aim| aim.body == moving.name) {
            match aim.end {
                End::In(zone, at_rest) => {
                    rests |= at_rest;
                    zones.push(zone);
                }
                End::Up(up) => ups.push(up),
            }
        }
        let can_lead =
            |zone: &Zone| zone.leads().iter().zip(&handles.place).all(|(leads, place)| !leads || place.is_some());
        zones.retain(can_lead);
        let is_relabelled = handles.turn.is_some() && !ups.is_empty();
        let rotations = if is_relabelled { moving.form.rotations() } else { vec![DQuat::IDENTITY] };
        if zones.is_empty() && rotations.len() == 1 {
            return None;
        }
        let middle =
            |handle: Option<Handle>| handle.map_or(0.0, |handle| world.plan.works.middle().numbers[handle.number]);
        Some(Self {
            body,
            middle: handles.place.map(middle),
            handles,
            zones,
            rests,
            ups,
            rotations,
            alone: plan.alone(body),
            idle: Mutex::default(),
        })
    }

    /// Weights of the relabelled ends of a trial, by what is asked of the body's axes; their largest is 1.
    pub(super) fn weights(&self, trial: &Trial) -> Vec<f64> {
        let log = |rotation: &DQuat| {
            let up = (trial.turn * *rotation).conjugate() * DVec3::Z;
            self.ups.iter().map(|one| one.log(up)).sum::<f64>()
        };
        let logs: Vec<f64> = self.rotations.iter().map(log).collect();
        let most = logs.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        logs.into_iter().map(|log| math::exp(log - most)).collect()
    }

    /// Which of the rotations leads from the orientation at the beginning of a trial to one that shares it.
    pub(super) fn label(&self, trial: &Trial, turn: DQuat) -> usize {
        nearest(&self.rotations, |rotation| (trial.begun * rotation).dot(turn))
    }

    /// The orientation in trials of one, whichever way it is relabelled; and that of the body in a draw.
    fn shared(&self, draw: &Drawn) -> Option<DQuat> {
        let turn = draw.turns[self.handles.turn?];
        if self.rotations.len() == 1 {
            return Some(turn);
        }
        let label = nearest(&self.rotations, |rotation| (turn * rotation).w);
        let turn = turn * self.rotations[label];
        let turn = if turn.w < 0.0 { -turn } else { turn };
        let coarse = turn.to_array().map(|x| (x / FINEST).round() * FINEST);
        Some(DQuat::from_array(coarse).normalize())
    }

    /// Tries the body's throw alone, from the middle of the law of its place; `None` if it does not end as it has to.
    pub(super) fn trial(&self, draw: &Drawn) -> Result<Option<Trial>, ModelError> {
        let mut draw = draw.clone();
        for (handle, middle) in self.handles.place.iter().zip(self.middle) {
            if let Some(handle) = handle {
                draw.numbers[handle.number] = middle;
            }
        }
        let begun = self.shared(&draw);
        if let (Some(begun), Some(index)) = (begun, self.handles.turn) {
            draw.turns[index] = begun;
        }
        let mut work = self.idle.lock().unwrap_or_else(PoisonError::into_inner).pop().unwrap_or_default();
        let ending = fly(&self.alone, &draw, &mut work);
        self.idle.lock().unwrap_or_else(PoisonError::into_inner).push(work);
        let Some(Ending::Done(Done { bodies, .. })) = ending? else { return Ok(None) };
        let [last] = bodies.as_slice() else { return Ok(None) };
        let trial =
            Trial { end: [1e3 * last.place.x, 1e3 * last.place.y], turn: last.turn, begun: begun.unwrap_or_default() };
        Ok(Some(trial).filter(|_| last.rest.is_some() || !self.rests))
    }

    /// Where the body ends according to a trial, in mm, if it begins where the draw says.
    pub(super) fn led(&self, draw: &Drawn, trial: &Trial) -> [f64; 2] {
        let along = |axis: usize| {
            let by = |handle: Handle| (draw.numbers[handle.number] - self.middle[axis]) * handle.factor;
            trial.end[axis] + self.handles.place[axis].map_or(0.0, by)
        };
        [along(0), along(1)]
    }

    /// Makes a trial's throw end at a place, in mm, along the axes that a zone leads.
    pub(super) fn lead(&self, draw: &mut Drawn, trial: &Trial, (zone, to): (&Zone, [f64; 2])) {
        for (axis, leads) in zone.leads().into_iter().enumerate() {
            if let Some(handle) = self.handles.place[axis].filter(|_| leads) {
                draw.numbers[handle.number] = self.middle[axis] + (to[axis] - trial.end[axis]) / handle.factor;
            }
        }
    }

    /// Whether a draw has this trial.
    pub(super) fn shares(&self, trial: &Trial, draw: &Drawn) -> bool {
        self.shared(draw).is_none_or(|turn| turn == trial.begun)
    }

    /// About which vertical line it can be turned, in mm.
    pub(super) fn turns_about(&self, stream: &mut Stream) -> Option<[f64; 2]> {
        let [Some(x), Some(y)] = self.zones.get(below(stream, self.zones.len()))?.middle() else { return None };
        Some([x, y])
    }

    /// Whether it can be turned about such a line.
    pub(super) fn is_turned(&self) -> bool {
        self.handles.level.is_some() && self.zones.iter().any(|zone| zone.leads() == [true; 2])
    }

    /// Where the body ends in a state, in mm.
    pub(super) fn end(&self, world: &Custom, draw: &Drawn, ending: &Ending) -> Option<[f64; 2]> {
        let Ending::Done(done) = ending else { return None };
        let place = world.plan.there(draw).iter().position(|&body| body == self.body)?;
        let last = done.bodies.get(place)?.place;
        Some([1e3 * last.x, 1e3 * last.y])
    }
}

/// The rotation for which something is largest in size.
fn nearest(rotations: &[DQuat], of: impl Fn(DQuat) -> f64) -> usize {
    let sizes: Vec<f64> = rotations.iter().map(|rotation| of(*rotation).abs()).collect();
    (1..sizes.len()).fold(0, |best, k| if sizes[k] > sizes[best] { k } else { best })
}

impl Form {
    /// Rotations that map it to itself, the identity first; of a round body only half a turn about a level axis.
    fn rotations(&self) -> Vec<DQuat> {
        match self {
            Self::Box([Value::Fixed(x), Value::Fixed(y), Value::Fixed(z)], _) => {
                let all = Rotation::of_cuboid(DVec3::new(*x, *y, *z));
                all.iter().map(|rotation| rotation.pips(DQuat::IDENTITY)).collect()
            }
            Self::Cylinder(..) | Self::Capsule(..) => vec![DQuat::IDENTITY, DQuat::from_xyzw(1.0, 0.0, 0.0, 0.0)],
            _ => vec![DQuat::IDENTITY],
        }
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
        let meet = self.meeting();
        throws.into_iter().filter(|throw| !meet[throw.body]).collect()
    }

    /// Which bodies meet others in most of some draws of the prior.
    fn meeting(&self) -> Vec<bool> {
        let (count, mut work) = (self.plan.bodies.len(), Work::default());
        let (mut met, mut seen, begun) = (vec![0; count], 0, plaus_sim::work());
        for nth in 0..DRAWS {
            let draw = self.start(&mut Seed(0).chain(0).at(nth, Purpose::START));
            let Ok(Some(Ending::Done(done))) = fly(&self.plan, &draw, &mut work) else { continue };
            seen += 1;
            let mut meets = vec![false; count];
            let pairs = done.met.iter().map(|pair| pair.map(|thing| thing as usize));
            pairs.filter(|[_, other]| *other < count).flatten().for_each(|body| meets[body] = true);
            met.iter_mut().zip(meets).for_each(|(met, meets)| *met += i32::from(meets));
            if plaus_sim::work() - begun > EVENTS {
                break;
            }
        }
        met.into_iter().map(|met| 2 * met > seen).collect()
    }
}

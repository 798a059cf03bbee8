//! The results of a throw: where its die comes to rest, where it touched the table, and what the constraints ask about
//! its path.

use super::Rotation;
use crate::model::Features;
use crate::way::{Way, follow};
use glam::{DQuat, DVec3};
use plaus_mcmc::Failure;
use plaus_sim::mechanics::{Impact, Other};
use plaus_sim::motion::Parabola;
use plaus_sim::rigid::{Phase, RigidBodyState, RigidWorld};
use plaus_sim::state::State;
use plaus_sim::trace::Observer;
use serde::{Deserialize, Serialize};

/// How a die's trip ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum End {
    /// It lies at rest on the table.
    AtRest,
    /// It left the table.
    Left,
    /// It still moved when its time was used up, or the simulation failed.
    Unfinished,
}

/// A die at some time.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Frame {
    /// Its middle, in m.
    pub position: DVec3,
    /// The orientation of its body.
    pub orientation: DQuat,
    /// In m/s.
    pub velocity: DVec3,
}

/// The path of one die.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Trip {
    /// How it ended.
    pub end: End,
    /// When, in s.
    pub time: f64,
    /// Where its middle was then, in m. If its table has been shifted, this and all other places of the trip are
    /// shifted by as much.
    pub position: DVec3,
    /// Its body's orientation then.
    pub orientation: DQuat,
    /// Time in s and place in m of every impact on the table.
    pub impacts: Vec<[f64; 3]>,
    /// The die at each of the times asked for.
    pub frames: Vec<Frame>,
    /// The least distance of its middle, in m, from each of the points asked for.
    pub nearest: Vec<f64>,
    /// Whether it touched another die.
    pub met: bool,
    /// Why its simulation failed, if it did; no state of a chain has such a trip.
    #[serde(skip)]
    pub failed: Option<Box<Failure>>,
    /// Cells and uppermost axes at regular times, for telling solutions apart.
    looks: Vec<Look>,
    /// The least and the largest x and y of its middle.
    extent: [[f64; 2]; 2],
}

/// Where a die is, and which face would be uppermost if the pips lay along the body's axes.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
struct Look {
    at: [f64; 2],
    face: u8,
}

impl Trip {
    /// A trip that ends at rest, of which only the places where it touched the table are known.
    #[must_use]
    pub fn resting(position: DVec3, orientation: DQuat, impacts: Vec<[f64; 3]>) -> Self {
        let time = impacts.last().map_or(0.0, |last| last[0]);
        let (frames, nearest, looks) = (Vec::new(), Vec::new(), Vec::new());
        let extent = [[position.x, position.y]; 2];
        let (end, met, failed) = (End::AtRest, false, None);
        Self { end, time, position, orientation, impacts, frames, nearest, met, failed, looks, extent }
    }

    /// Whether its middle stays on a table with these half sides when the trip is moved by `offset`.
    pub(super) fn stays_on(&self, edge: &[f64; 2], offset: DVec3) -> bool {
        self.extent.iter().all(|[x, y]| is_on(edge, DVec3::new(*x, *y, 0.0) + offset))
    }

    /// The features of this trip, moved by `offset`, with the given pips and cells of this width.
    pub(super) fn features(&self, features: &mut Features, pips: &Rotation, cell: f64, offset: DVec3) {
        features.number(self.looks.len() as i64);
        for look in &self.looks {
            features.place((look.at[0] + offset.x) / cell);
            features.place((look.at[1] + offset.y) / cell);
            // Which face shows where the body's own face is uppermost.
            features.number(i64::from(pips.uppermost(super::symmetry::facing(look.face)).0));
        }
    }
}

/// What is asked about a die's path.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Asked {
    /// Times in s.
    pub(super) times: Vec<f64>,
    /// Points in m.
    pub(super) points: Vec<DVec3>,
}

/// Settings that are the same for all trips.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Looking {
    /// Half the table's length and width, in m.
    pub(super) edge: [f64; 2],
    /// Width of a cell, in m, and time between two looks, in s.
    pub(super) cell: f64,
    pub(super) every: f64,
}

/// Distance from a point is measured to chords of this duration, in s: a parabola leaves them by 5 µm at most.
const CHORD: f64 = 0.002;

/// Listens to a run.
pub(super) struct Watch<'a> {
    rigid: &'a RigidWorld,
    asked: Vec<&'a Asked>,
    looking: Looking,
    /// By how much the places of the dice are shifted.
    offset: DVec3,
    /// Each die's motion before the current one's begin.
    last: Vec<Option<RigidBodyState>>,
    trips: Vec<Trip>,
    paths: Vec<Vec<Parabola>>,
    left: bool,
}

impl<'a> Watch<'a> {
    /// Watches the bodies of `rigid`, each with what is asked about it, which stand farther on by `offset`.
    pub(super) fn new(rigid: &'a RigidWorld, asked: Vec<&'a Asked>, looking: Looking, offset: DVec3) -> Self {
        let still = Frame { position: DVec3::ZERO, orientation: DQuat::IDENTITY, velocity: DVec3::ZERO };
        let trip = |asked: &&Asked| Trip {
            end: End::Unfinished,
            time: 0.0,
            position: DVec3::ZERO,
            orientation: DQuat::IDENTITY,
            impacts: Vec::new(),
            frames: vec![still; asked.times.len()],
            nearest: vec![f64::MAX; asked.points.len()],
            met: false,
            failed: None,
            looks: Vec::new(),
            extent: [[f64::MAX; 2], [f64::MIN; 2]],
        };
        let trips: Vec<Trip> = asked.iter().map(trip).collect();
        let paths = vec![Vec::new(); trips.len()];
        Self { rigid, last: vec![None; trips.len()], asked, looking, trips, paths, offset, left: false }
    }

    /// The trips, after a run that failed: none of its dice came to its end.
    pub(super) fn fail(mut self, failure: &Failure, longest: f64) -> (Vec<Trip>, Vec<Way>) {
        // The last motions that are finite.
        let bodies: Vec<RigidBodyState> = self.last.iter_mut().filter_map(Option::take).collect();
        let (mut trips, ways) = self.finish(&bodies, longest);
        for trip in &mut trips {
            (trip.end, trip.failed) = (End::Unfinished, Some(Box::new(failure.clone())));
        }
        (trips, ways)
    }

    /// The trips, after a run that ended with the given bodies; and the paths, in which a die at rest stays there until
    /// the time `longest`.
    pub(super) fn finish(mut self, bodies: &[RigidBodyState], longest: f64) -> (Vec<Trip>, Vec<Way>) {
        let mut ways = Vec::with_capacity(bodies.len());
        for (k, body) in bodies.iter().enumerate() {
            self.cover(k, body, f64::INFINITY);
            follow(&mut self.paths[k], path(body));
            ways.push(Way::new(&self.paths[k], if body.phase == Phase::Rest { longest } else { body.path.t }));
            let trip = &mut self.trips[k];
            (trip.time, trip.position, trip.orientation) = (body.path.t, body.path.x, body.turn);
            trip.end = match body.phase {
                _ if !trip.stays_on(&self.looking.edge, self.offset) => End::Left,
                Phase::Rest => End::AtRest,
                _ => End::Unfinished,
            };
        }
        (self.trips, ways)
    }

    /// Answers everything that is asked about a motion until it ends.
    fn cover(&mut self, k: usize, piece: &RigidBodyState, until: f64) {
        let (rigid, from) = (self.rigid, piece.path.t);
        let (trip, asked) = (&mut self.trips[k], self.asked[k]);
        let moves = piece.phase != Phase::Rest;
        for (frame, &time) in trip.frames.iter_mut().zip(&asked.times) {
            if from <= time && time < until {
                let at = rigid.at(k, piece, time);
                let velocity = if moves { at.path.v } else { DVec3::ZERO };
                *frame = Frame { position: at.path.x, orientation: at.turn, velocity };
            }
        }
        if !moves {
            return;
        }
        let until = if until.is_finite() { until } else { from };
        let mut next = trip.looks.len() as f64 * self.looking.every;
        while next < until {
            let at = rigid.at(k, piece, next.max(from));
            trip.looks.push(Look { at: [at.path.x.x, at.path.x.y], face: Rotation::IDENTITY.uppermost(at.turn).0 });
            next = trip.looks.len() as f64 * self.looking.every;
        }
        if !asked.points.is_empty() {
            let chords = ((until - from) / CHORD).ceil().clamp(1.0, 1e5) as u32;
            let mut here = piece.path.x;
            for chord in 1..=chords {
                let there = piece.path.at(from + (until - from) * f64::from(chord) / f64::from(chords));
                for (nearest, &point) in trip.nearest.iter_mut().zip(&asked.points) {
                    *nearest = nearest.min(from_chord(point - self.offset, here, there));
                }
                here = there;
            }
        }
    }
}

/// Distance of a point from a straight line between two others.
fn from_chord(point: DVec3, from: DVec3, to: DVec3) -> f64 {
    let (along, off) = (to - from, point - from);
    let length = along.length_squared();
    let part = if length > 0.0 { (off.dot(along) / length).clamp(0.0, 1.0) } else { 0.0 };
    (off - along * part).length()
}

/// The motion of a body's centre.
fn path(body: &RigidBodyState) -> Parabola {
    match body.phase {
        Phase::Rest | Phase::Waiting => Parabola { v: DVec3::ZERO, a: DVec3::ZERO, ..body.path },
        _ => body.path,
    }
}

fn is_on(edge: &[f64; 2], x: DVec3) -> bool {
    x.x.abs() <= edge[0] && x.y.abs() <= edge[1]
}

impl Observer<RigidWorld> for Watch<'_> {
    fn impact(&mut self, impact: &Impact) {
        match impact.other {
            Other::Surface(_) => {
                self.trips[impact.body].impacts.push([impact.time, impact.point.x, impact.point.y]);
            }
            Other::Body(other) => {
                self.trips[impact.body].met = true;
                self.trips[other].met = true;
            }
        }
    }

    fn motion(&mut self, index: usize, body: &RigidBodyState) {
        if let Some(last) = self.last[index].take() {
            self.cover(index, &last, body.path.t);
        }
        let (trip, x) = (&mut self.trips[index], body.path.x);
        let [low, high] = &mut trip.extent;
        *low = [low[0].min(x.x), low[1].min(x.y)];
        *high = [high[0].max(x.x), high[1].max(x.y)];
        follow(&mut self.paths[index], path(body));
        self.left |= !is_on(&self.looking.edge, x + self.offset);
        self.last[index] = Some(body.clone());
    }

    fn proceed(&mut self, _: &State<RigidBodyState>) -> bool {
        !self.left
    }
}

//! One run of a world: its record, and how deep things were in each other.

use super::exact::{Piece, overlap};
use super::world::World;
use crate::laws::record::{Facts, Record, record_beside};
use glam::{DQuat, DVec3};
use plaus_sim::rigid::{Rigid, Turning};
use plaus_sim::trace::Observer;
use plaus_sim::{State, WorldError};

/// What a body was deepest in.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Deepest {
    /// In units of what is allowed.
    pub worst: f64,
    /// In m.
    pub depth: f64,
    pub time: f64,
    pub body: usize,
    /// Another body, or after all bodies a fixed part.
    pub other: usize,
}

/// What a run came to.
#[derive(Debug, Clone)]
pub struct Ran {
    pub record: Record,
    pub deepest: Deepest,
    /// The number of times at which the judge looked.
    pub looks: u64,
}

/// The judge, as a listener.
pub struct Judge<'w> {
    rigid: &'w Rigid,
    bodies: Vec<Vec<Piece>>,
    parts: Vec<Vec<Piece>>,
    /// How deep each body may be, in m.
    allowed: Vec<f64>,
    reach: Vec<f64>,
    /// Looks at every event at first, later at every n-th.
    looks: u64,
    events: u64,
    pub deepest: Deepest,
}

/// Number of events at all of which the judge looks; after each as many, it looks half as often.
const ALL_OF: u64 = 300;

impl<'w> Judge<'w> {
    /// `multiple`: of each body's gap that it may be deep.
    pub fn new(world: &World, rigid: &'w Rigid, multiple: f64) -> Self {
        let gap = plaus_sim::Accuracy::preset(world.preset).gap;
        let deepest = Deepest { worst: 0.0, depth: 0.0, time: 0.0, body: 0, other: 0 };
        let shapes: Vec<_> = world.movers.iter().map(|m| m.form.shape().0).collect();
        Self {
            rigid,
            bodies: world.movers.iter().map(super::world::Mover::pieces).collect(),
            parts: world.fixed.iter().map(super::world::Fixed::pieces).collect(),
            allowed: world
                .movers
                .iter()
                .zip(&shapes)
                .map(|(m, s)| multiple * gap * s.size() + m.form.rough())
                .collect(),
            reach: shapes.iter().map(plaus_sim::shape::Shape::reach).collect(),
            looks: 0,
            events: 0,
            deepest,
        }
    }

    /// The same with other fixed things: a wrong twin.
    pub fn of_parts(mut self, parts: Vec<Vec<Piece>>) -> Self {
        self.parts = parts;
        self
    }

    fn add(&mut self, depth: f64, allowed: f64, time: f64, body: usize, other: usize) {
        let worst = depth / allowed;
        if worst > self.deepest.worst {
            self.deepest = Deepest { worst, depth, time, body, other };
        }
    }

    /// Looks at all pairs of which one was moved at this time.
    pub fn look(&mut self, state: &State<Turning>, time: f64, all: bool) {
        self.looks += 1;
        let bodies = state.bodies();
        let poses: Vec<(DVec3, DQuat)> = bodies
            .iter()
            .enumerate()
            .map(|(k, b)| {
                let at = self.rigid.at(k, b, time.max(b.path.t));
                (at.path.x, at.turn)
            })
            .collect();
        if poses.iter().any(|(x, q)| !x.is_finite() || !q.is_finite()) {
            return;
        }
        let placed: Vec<Vec<Piece>> = self
            .bodies
            .iter()
            .zip(&poses)
            .map(|(pieces, &(x, q))| pieces.iter().map(|p| p.moved(x, q)).collect())
            .collect();
        for k in 0..bodies.len() {
            let moved = |k: usize| all || bodies[k].path.t == time;
            for j in (k + 1..bodies.len()).filter(|&j| moved(j) || moved(k)) {
                let (small, allowed) = (if self.reach[j] < self.reach[k] { j } else { k }, self.allowed[k].max(self.allowed[j]));
                let ball = (poses[small].0, self.reach[small]);
                let (a, b) = (&placed[k], &placed[j]);
                if (poses[k].0 - poses[j].0).length() < self.reach[k] + self.reach[j] {
                    let depth = deepest(a, b, ball, 0.5 * allowed);
                    self.add(depth, allowed, time, k, j);
                }
            }
            if moved(k) {
                for j in 0..self.parts.len() {
                    let allowed = self.allowed[k];
                    let depth = deepest(&placed[k], &self.parts[j], (poses[k].0, self.reach[k]), 0.5 * allowed);
                    self.add(depth, allowed, time, k, bodies.len() + j);
                }
            }
        }
    }
}

fn deepest(a: &[Piece], b: &[Piece], ball: (DVec3, f64), least: f64) -> f64 {
    let pairs = a.iter().flat_map(|p| b.iter().map(move |q| (p, q)));
    pairs.map(|(p, q)| overlap(p, q, ball, least)).fold(0.0, f64::max)
}

impl Observer<Rigid> for Judge<'_> {
    fn proceed(&mut self, state: &State<Turning>) -> bool {
        self.events += 1;
        if self.events % (1 << (self.events / ALL_OF).min(10)) == 0 {
            self.look(state, state.time(), false);
        }
        true
    }
}

/// Runs a world under the judge, for `most` events at most.
///
/// # Errors
/// If things overlap at the start.
pub fn run(world: &World, multiple: f64, most: u64) -> Result<Ran, WorldError> {
    let made = world.rigid();
    let facts = made.bodies.iter().map(Facts::new).collect();
    let (gravity, accuracy) = (made.gravity, made.accuracy);
    let rigid = Rigid::new(made)?;
    let mut state = rigid.state(&world.starts())?;
    let mut judge = Judge::new(world, &rigid, multiple);
    let end = [world.until, most as f64];
    let record = record_beside(&rigid, (facts, gravity, accuracy), &mut state, end, &mut judge);
    let time = state.time();
    judge.look(&state, time, true);
    Ok(Ran { record, deepest: judge.deepest, looks: judge.looks })
}

/// Runs a world without a judge; where the bodies are at its end: centres of gravity and turns.
pub fn poses(world: &World, most: u64) -> Option<Vec<(DVec3, DQuat)>> {
    let made = world.rigid();
    let facts = made.bodies.iter().map(Facts::new).collect();
    let (gravity, accuracy) = (made.gravity, made.accuracy);
    let rigid = Rigid::new(made).ok()?;
    let mut state = rigid.state(&world.starts()).ok()?;
    let end = [world.until, most as f64];
    let record = record_beside(&rigid, (facts, gravity, accuracy), &mut state, end, &mut ());
    let last = |moments: &Vec<crate::laws::record::Moment>| moments.last().map(|m| (m.x, m.turn));
    record.moments.iter().map(last).collect()
}

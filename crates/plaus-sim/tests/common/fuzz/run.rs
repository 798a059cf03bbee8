//! One run of a world: its record, and how deep things were in each other.

use super::exact::{Piece, overlap};
use super::form::Form;
use super::world::{Fixed, World};
use crate::laws::record::{Facts, Record, record_beside};
use glam::{DQuat, DVec3};
use plaus_sim::mechanics::Mechanics;
use plaus_sim::rigid::{Phase, RigidBodyState, RigidWorld};
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

/// How deep a body may be in another thing.
#[derive(Debug, Clone, Copy)]
pub enum Limit {
    /// At the ends of its motions, in gaps of the preset. A step that an event interrupts may end deeper, by how far
    /// its path bends; what overlaps then may do so until it is pushed out, but by no more than twice as much.
    Gaps(f64),
    /// At any time, as a part of its size.
    Size(f64),
}

/// A motion that an event has ended.
#[derive(Debug, Clone, Copy)]
struct Moved {
    from: f64,
    /// `τ (h − τ)/2` of a step of `h` seconds that was interrupted after `τ`; 0 of other motions.
    bend: f64,
    /// Largest angular speed, speed and reach.
    turn: f64,
    speed: f64,
    reach: f64,
}

impl Moved {
    /// How deep an interrupted step may leave what it holds. At both ends of a step, that is where it should be;
    /// between them, a body's point leaves the straight line by its acceleration times `τ (h − τ)/2`. Over flat ground
    /// only the turn accelerates it, elsewhere also that it slides along faces that turn, or round corners.
    fn bend(&self, is_ground: bool) -> f64 {
        let slides = if is_ground { 0.0 } else { (2.0 * self.turn + self.speed / self.reach) * self.speed };
        self.bend * (self.turn * self.turn * self.reach + slides)
    }
}

/// A fixed part is ground to a body from this many of its reaches on: no edge of it is near. Default 5.
const LARGE: f64 = 5.0;

/// The judge, as a listener.
pub struct Judge<'w> {
    rigid: &'w RigidWorld,
    bodies: Vec<Vec<Piece>>,
    parts: Vec<Vec<Piece>>,
    /// How deep each body may be, in m.
    allowed: Vec<f64>,
    /// How far each body's skin may lie inside its form, in m.
    rough: Vec<f64>,
    /// The same on tables, and which parts are some.
    rough_on_tables: Vec<f64>,
    is_table: Vec<bool>,
    reach: Vec<f64>,
    sizes: Vec<f64>,
    /// Looks at every event at first, later at every n-th.
    looks: u64,
    events: u64,
    /// Whether it also looks on the way from event to event; and the bodies at the event before.
    looks_between: bool,
    before: Option<(f64, Vec<RigidBodyState>)>,
    /// The bodies after the event before, and the motions that ended with this one.
    last: Vec<RigidBodyState>,
    moved: Vec<Option<Moved>>,
    /// Size of fixed parts with flat faces; 0 of others.
    flat: Vec<f64>,
    /// When each body and each other thing were looked at last, and how deep they were in each other.
    known: Vec<Vec<(f64, f64)>>,
    /// Largest over least moment of inertia of each body.
    spread: Vec<f64>,
    pub deepest: Deepest,
}

/// What rounding may do to a place that follows from a search for a root and a free rotation, over the reach. Default
/// 1e-9.
const ROUNDING: f64 = 1e-9;

/// Number of events at all of which the judge looks; after each as many, it looks half as often.
const ALL_OF: u64 = 300;

impl<'w> Judge<'w> {
    pub fn new(world: &World, rigid: &'w RigidWorld, limit: Limit) -> Self {
        let part = match limit {
            Limit::Gaps(multiple) => multiple * plaus_sim::Accuracy::preset(world.preset).gap,
            Limit::Size(part) => part,
        };
        let deepest = Deepest { worst: 0.0, depth: 0.0, time: 0.0, body: 0, other: 0 };
        let shapes: Vec<_> = world.movers.iter().map(|m| m.form.shape().0).collect();
        Self {
            rigid,
            bodies: world.movers.iter().map(super::world::Mover::pieces).collect(),
            parts: world.fixed.iter().map(super::world::Fixed::pieces).collect(),
            allowed: shapes.iter().map(|s| part * s.size() + ROUNDING * s.reach()).collect(),
            rough: world.movers.iter().map(|m| m.form.rough()).collect(),
            rough_on_tables: world.movers.iter().map(|m| m.form.rough() + m.form.rough_on_tables()).collect(),
            is_table: world.fixed.iter().map(|f| matches!(f, Fixed::Table { .. })).collect(),
            sizes: shapes.iter().map(plaus_sim::shape::Shape::size).collect(),
            reach: shapes.iter().map(plaus_sim::shape::Shape::reach).collect(),
            looks: 0,
            events: 0,
            looks_between: matches!(limit, Limit::Size(_)),
            before: None,
            last: Vec::new(),
            moved: vec![None; shapes.len()],
            flat: world.fixed.iter().map(flat).collect(),
            known: vec![vec![(0.0, 0.0); shapes.len() + world.fixed.len()]; shapes.len()],
            spread: world.rigid().bodies.iter().map(|b| b.mass.inertia).map(spread).collect(),
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

    /// Adds what a look has found, if it is known how deep they were before.
    fn weigh(&mut self, depth: f64, least: f64, time: f64, body: usize, other: usize) {
        if self.looks_between {
            return self.add(depth, least, time, body, other);
        }
        let (since, before) = std::mem::replace(&mut self.known[body][other], (time, depth));
        let is_ground =
            other.checked_sub(self.bodies.len()).is_some_and(|part| self.flat[part] >= LARGE * self.reach[body]);
        let moved = || [body, other].into_iter().filter_map(|k| self.moved.get(k).copied().flatten());
        if moved().all(|m| since >= m.from) {
            let bend: f64 = moved().map(|m| m.bend(is_ground)).sum();
            self.add(depth, least + 2.0 * before + bend, time, body, other);
        }
    }

    /// Notes which motions this event ends.
    fn note_moved(&mut self, state: &State<RigidBodyState>) {
        let time = state.time();
        for (k, body) in state.bodies().iter().enumerate() {
            self.moved[k] = self.last.get(k).filter(|_| body.path.t == time).map(|last| {
                let (from, end) = (last.path.t, self.rigid.expiry(last));
                let left = if last.phase == Phase::Step { (end - time).max(0.0) } else { 0.0 };
                let (turn, speed) = (last.spin.length() * self.spread[k], last.path.v.length());
                Moved { from, bend: 0.5 * (time - from) * left, turn, speed, reach: self.reach[k] }
            });
        }
        self.last.clear();
        self.last.extend_from_slice(state.bodies());
    }

    /// Looks at all pairs of which one was moved at this time.
    pub fn look(&mut self, state: &State<RigidBodyState>, time: f64, all: bool) {
        let bodies = state.bodies();
        let poses: Vec<_> = bodies.iter().enumerate().map(|(k, b)| self.rigid.at(k, b, time.max(b.path.t))).collect();
        // Half way through a step, a body may be in another.
        let is_between = |k: usize| bodies[k].phase == Phase::Step && bodies[k].path.t != time;
        let moved = |k: usize| all || bodies[k].path.t == time;
        self.judge(&poses, time, |k, j| {
            (moved(k) || j.is_some_and(moved)) && !is_between(k) && !j.is_some_and(is_between)
        });
    }

    /// Looks at some times on the way from the last event to this one.
    fn look_between(&mut self, state: &State<RigidBodyState>) {
        let time = state.time();
        if let Some((from, bodies)) = self.before.take() {
            let far = |(k, b): (usize, &RigidBodyState)| {
                let way = (b.path.v.length() + b.spin.length() * self.reach[k]) * (time - from);
                way / (0.5 * self.sizes[k])
            };
            let looks = bodies.iter().enumerate().map(far).fold(0.0, f64::max).ceil().min(MOST_BETWEEN);
            for look in 1..looks as u32 {
                let at = from + (time - from) * f64::from(look) / looks;
                let pose = |(k, b): (usize, &RigidBodyState)| self.rigid.on_its_way(k, b, at.max(b.path.t));
                let poses: Vec<_> = bodies.iter().enumerate().map(pose).collect();
                self.judge(&poses, at, |_, _| true);
            }
        }
    }

    /// Compares pairs of bodies, and bodies with parts (`None`).
    fn judge(&mut self, poses: &[RigidBodyState], time: f64, is_asked: impl Fn(usize, Option<usize>) -> bool) {
        self.looks += 1;
        if poses.iter().any(|b| !b.path.x.is_finite() || !b.turn.is_finite()) {
            return;
        }
        let place =
            |(pieces, b): (&Vec<Piece>, &RigidBodyState)| pieces.iter().map(|p| p.moved(b.path.x, b.turn)).collect();
        let placed: Vec<Vec<Piece>> = self.bodies.iter().zip(poses).map(place).collect();
        for k in 0..poses.len() {
            for j in (k + 1..poses.len()).filter(|&j| is_asked(k, Some(j))) {
                let small = if self.reach[j] < self.reach[k] { j } else { k };
                let allowed = match self.looks_between {
                    true => self.allowed[k].min(self.allowed[j]),
                    false => self.allowed[k].max(self.allowed[j]),
                };
                let allowed = allowed + self.rough[k] + self.rough[j];
                let ball = (poses[small].path.x, self.reach[small]);
                if (poses[k].path.x - poses[j].path.x).length() < self.reach[k] + self.reach[j] {
                    let depth = deepest(&placed[k], &placed[j], ball, 0.5 * allowed);
                    self.weigh(depth, allowed, time, k, j);
                }
            }
            if is_asked(k, None) {
                for j in 0..self.parts.len() {
                    let rough = if self.is_table[j] { &self.rough_on_tables } else { &self.rough };
                    let allowed = self.allowed[k] + rough[k];
                    let ball = (poses[k].path.x, self.reach[k]);
                    let depth = deepest(&placed[k], &self.parts[j], ball, 0.5 * allowed);
                    self.weigh(depth, allowed, time, k, poses.len() + j);
                }
            }
        }
    }
}

/// Looks between two events, at most; a body that goes farther than half its size each time is seen less well.
const MOST_BETWEEN: f64 = 12.0;

/// The largest edge of a part with flat faces; 0 of others.
fn flat(fixed: &Fixed) -> f64 {
    match fixed {
        Fixed::Plane(_) | Fixed::Table { .. } => f64::INFINITY,
        Fixed::Block { edges, .. } | Fixed::Mesh { edges, .. } => edges.max_element(),
        Fixed::Solid { form: Form::Cuboid { edges, .. }, .. } => edges.max_element(),
        Fixed::Solid { .. } => 0.0,
    }
}

fn spread(inertia: DVec3) -> f64 {
    inertia.max_element() / inertia.min_element()
}

fn deepest(a: &[Piece], b: &[Piece], ball: (DVec3, f64), least: f64) -> f64 {
    let pairs = a.iter().flat_map(|p| b.iter().map(move |q| (p, q)));
    pairs.map(|(p, q)| overlap(p, q, ball, least)).fold(0.0, f64::max)
}

impl Observer<RigidWorld> for Judge<'_> {
    fn proceed(&mut self, state: &State<RigidBodyState>) -> bool {
        self.events += 1;
        self.note_moved(state);
        // Two in a row, as what a look finds depends on the one before.
        let is_seen = |event: u64| event % (1 << (event / ALL_OF).min(10)) <= u64::from(!self.looks_between);
        let (now, next) = (is_seen(self.events), is_seen(self.events + 1));
        if now && self.looks_between {
            self.look_between(state);
        }
        if now {
            self.look(state, state.time(), false);
        }
        // Only up to the next event are bodies on these ways.
        self.before = (next && self.looks_between).then(|| (state.time(), state.bodies().to_vec()));
        true
    }
}

/// Runs a world under the judge, for `most` events at most.
///
/// # Errors
/// If things overlap at the start.
pub fn run(world: &World, limit: Limit, most: u64) -> Result<Ran, WorldError> {
    let made = world.rigid();
    let facts = made.bodies.iter().map(Facts::new).collect();
    let (gravity, accuracy) = (made.gravity, made.accuracy);
    let rigid = RigidWorld::new(made)?;
    let mut state = rigid.state(&world.starts())?;
    let mut judge = Judge::new(world, &rigid, limit);
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
    let rigid = RigidWorld::new(made).ok()?;
    let mut state = rigid.state(&world.starts()).ok()?;
    let end = [world.until, most as f64];
    let record = record_beside(&rigid, (facts, gravity, accuracy), &mut state, end, &mut ());
    let last = |moments: &Vec<crate::laws::record::Moment>| moments.last().map(|m| (m.x, m.turn));
    record.moments.iter().map(last).collect()
}

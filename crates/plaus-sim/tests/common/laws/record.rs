//! The events of a run, in terms of mechanics only.

use glam::{DMat3, DQuat, DVec3};
use plaus_sim::mechanics::Impact;
use plaus_sim::rigid::{BodySpec, Phase, RigidBodyState, RigidWorld, RigidWorldDesc, Start};
use plaus_sim::trace::Observer;
use plaus_sim::{Accuracy, Outcome, Preset, Scratch, State};

/// The constant properties of a body.
#[derive(Debug, Clone, Copy)]
pub struct Facts {
    /// In kg.
    pub mass: f64,
    /// About the body's axes, in kg m².
    pub inertia: DVec3,
    /// The unit of length for tolerances, in m.
    pub size: f64,
    /// Radius of the sphere around it, in m.
    pub reach: f64,
}

impl Facts {
    pub fn new(body: &BodySpec) -> Self {
        let (size, reach) = (body.shape.size(), body.shape.reach());
        Self { mass: body.mass.mass, inertia: body.mass.inertia, size, reach }
    }
}

/// A body just after one of its events.
#[derive(Debug, Clone, Copy)]
pub struct Moment {
    pub time: f64,
    pub x: DVec3,
    pub v: DVec3,
    /// Angular velocity in world axes.
    pub w: DVec3,
    pub turn: DQuat,
    pub phase: Phase,
    /// Number of impacts in the whole record before this event.
    pub impacts: usize,
}

impl Moment {
    /// Angular momentum about the centre of gravity, in world axes.
    pub fn spin_momentum(&self, facts: &Facts) -> DVec3 {
        let r = DMat3::from_quat(self.turn);
        r * (facts.inertia * (r.transpose() * self.w))
    }

    pub fn kinetic(&self, facts: &Facts) -> f64 {
        0.5 * (facts.mass * self.v.length_squared() + self.w.dot(self.spin_momentum(facts)))
    }

    pub fn energy(&self, facts: &Facts, gravity: DVec3) -> f64 {
        self.kinetic(facts) - facts.mass * gravity.dot(self.x)
    }
}

/// One run.
#[derive(Debug, Clone)]
pub struct Record {
    pub facts: Vec<Facts>,
    pub gravity: DVec3,
    pub accuracy: Accuracy,
    /// For each body, its events in order; the last is the end of the run.
    pub moments: Vec<Vec<Moment>>,
    pub impacts: Vec<Impact>,
    pub outcome: Outcome,
    pub events: u64,
}

impl Record {
    /// Largest speed of any point of any body at any event, in m/s.
    pub fn fastest(&self) -> f64 {
        let speed = |(f, m): (&Facts, &Moment)| m.v.length() + m.w.length() * f.reach;
        let each = self.facts.iter().zip(&self.moments).flat_map(|(f, ms)| ms.iter().map(move |m| (f, m)));
        each.map(speed).fold(0.0, f64::max)
    }

    /// All events of all bodies in the order of their times, with the index of the body.
    pub fn in_order(&self) -> Vec<(usize, Moment)> {
        let mut all: Vec<(usize, Moment)> =
            self.moments.iter().enumerate().flat_map(|(k, ms)| ms.iter().map(move |m| (k, *m))).collect();
        all.sort_by(|a, b| a.1.time.total_cmp(&b.1.time));
        all
    }
}

/// Writes down what bodies do, and stops a run that has gone on for too many events.
pub struct Recorder<'w> {
    world: &'w RigidWorld,
    moments: Vec<Vec<Moment>>,
    impacts: Vec<Impact>,
    most: u64,
}

impl<'w> Recorder<'w> {
    /// Stops after `most` events.
    pub fn new(world: &'w RigidWorld, most: u64) -> Self {
        Self { world, moments: vec![Vec::new(); world.count()], impacts: Vec::new(), most }
    }

    fn moment(&self, index: usize, body: &RigidBodyState) -> Moment {
        // A motion's own fields may hold the velocity of a drift; advanced to its own clock, it has the body's
        // velocity.
        let at = self.world.at(index, body, body.path.t);
        let (time, x, v, w) = (at.path.t, at.path.x, at.path.v, at.spin);
        Moment { time, x, v, w, turn: at.turn, phase: body.phase, impacts: self.impacts.len() }
    }
}

impl Observer<RigidWorld> for Recorder<'_> {
    fn impact(&mut self, impact: &Impact) {
        self.impacts.push(*impact);
    }

    fn motion(&mut self, index: usize, body: &RigidBodyState) {
        let moment = self.moment(index, body);
        self.moments[index].push(moment);
    }

    fn proceed(&mut self, state: &State<RigidBodyState>) -> bool {
        state.counts().events < self.most
    }
}

/// Runs a world and writes down its events. A run is cut off after `most` events: its record up to then must be lawful
/// too.
pub fn record(world: RigidWorldDesc, starts: &[Start], until: f64, most: u64) -> Record {
    let facts = world.bodies.iter().map(Facts::new).collect();
    let (gravity, accuracy) = (world.gravity, world.accuracy);
    let world = RigidWorld::new(world).expect("worlds of these tests are sound");
    let mut state = world.state(starts).expect("starts of these tests are sound");
    record_beside(&world, (facts, gravity, accuracy), &mut state, [until, most as f64], &mut ())
}

/// The same of a world that is made, from a state on, with another listener beside.
pub fn record_beside(
    world: &RigidWorld,
    (facts, gravity, accuracy): (Vec<Facts>, DVec3, Accuracy),
    state: &mut State<RigidBodyState>,
    [until, most]: [f64; 2],
    beside: &mut impl Observer<RigidWorld>,
) -> Record {
    let recorder = Recorder::new(world, most as u64);
    let mut both = (recorder, beside);
    let outcome = world.run(state, &mut Scratch::default(), until, &mut both).expect("no tables, no faults");
    let events = state.counts().events;
    let Recorder { mut moments, impacts, .. } = both.0;
    for (k, body) in state.bodies().iter().enumerate() {
        let end = world.at(k, body, state.time().max(body.path.t));
        let (x, v, w) = (end.path.x, end.path.v, end.spin);
        let (time, turn, phase) = (end.path.t, end.turn, body.phase);
        moments[k].push(Moment { time, x, v, w, turn, phase, impacts: impacts.len() });
    }
    Record { facts, gravity, accuracy, moments, impacts, outcome, events }
}

/// The preset with this name.
pub fn preset(name: &str) -> Option<Preset> {
    Preset::ALL.into_iter().find(|p| p.name() == name)
}

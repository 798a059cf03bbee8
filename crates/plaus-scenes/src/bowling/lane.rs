//! One shot: from a draw to the pins that are left.

use super::alley::Alley;
use super::config::{Config, Rewarded};
use super::draw::Shot;
use super::rack::Rack;
use super::release::Delivery;
use super::release::Quantity;
use super::still::Still;
use super::verdict::Verdict;
use crate::scene::Until;
use crate::world::{Physical, PlainWorld};
use glam::{DQuat, DVec3};
use plaus_dist::math;
use plaus_mcmc::ModelError;
use plaus_sim::material::Law;
use plaus_sim::mechanics::{Impact, Other};
use plaus_sim::rigid::{Rigid, RigidScratch, Start, Turning};
use plaus_sim::shape::Revolution;
use plaus_sim::trace::{Observer, Trace};
use plaus_sim::{Outcome, Scratch, State, WorldError};
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// Width of the lane in m.
pub(super) const WIDTH: f64 = Alley::WIDTH;

/// From the foul line to the head pin's spot in m.
pub(super) const LENGTH: f64 = Alley::LENGTH;

/// Longest time of a shot that is shown, in s.
const LONGEST: f64 = 30.0;

/// What all shots of a scenario have in common.
#[derive(Debug)]
pub(super) struct Lane {
    alley: Alley,
    pin: Arc<Revolution>,
    verdict: Verdict,
    pins: Vec<usize>,
    /// How far a pin may be moved, in m, for each pin that is rewarded for not having moved far.
    far: Vec<Option<f64>>,
}

/// The outcome of a shot.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Rest {
    /// The fate of each pin that was set up, in ascending order of their numbers.
    pub pins: Vec<Fate>,
    /// Where and how the ball met the first pin, if it did.
    pub entry: Option<Entry>,
    /// Numbers of the pins that the ball itself struck, in the order in which it did.
    pub struck: Vec<u8>,
    /// Whether the simulation came to its end within the simulator's budget of events. If it did not, the draw has
    /// probability 0.
    pub complete: bool,
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

/// Where a pin with this offset in mm stands.
fn place(number: usize, offset: &[f64; 2]) -> DVec3 {
    Alley::spot(number) + DVec3::new(offset[0] / 1000.0, offset[1] / 1000.0, 0.0)
}

/// The distance of a pin's middle from where it was set, in m.
fn way(pin: &Turning, start: &Start, time: f64) -> f64 {
    (pin.path.at(time) - start.position).truncate().length()
}

/// Whether the ball has left the lane before the lane's end. By the rules of the game it is then dead, whatever it may
/// still do.
fn is_in_gutter(ball: &Turning) -> bool {
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
}

impl Lane {
    pub(super) fn new(config: &Config, rack: &Rack) -> Result<Self, WorldError> {
        let contact = &config.contact;
        let (friction, oil) = match config.delivery {
            Delivery::Paper => (0.12, 0.0),
            Delivery::Regulation => (0.2, 12.0),
        };
        let mut alley = Alley {
            pin_mass: config.pin_kg,
            ball_lane: Law::new(contact.lane_friction.unwrap_or(friction), contact.lane_restitution),
            ball_pin: Law::new(contact.ball_pin_friction, contact.ball_pin_restitution),
            pin_pin: Law::new(contact.pin_pin_friction, contact.pin_pin_restitution),
            pin_lane: Law::new(contact.pin_lane_friction, contact.pin_lane_restitution)
                .with_resistance(contact.pin_rolling, contact.pin_spinning),
            oil: contact.oil_m.unwrap_or(oil),
            oil_friction: contact.oil_friction,
            accuracy: config.accuracy.tolerances(),
            duration: config.duration_s,
            standing: [false; 10],
            ..Alley::default()
        };
        for pin in rack.pins() {
            alley.standing[pin - 1] = true;
        }
        let pin = Arc::new(alley.pin()?);
        let counts = |leave: &bool| *leave || config.rewarded == Rewarded::AnyStanding;
        let far = rack.leave().iter().map(|leave| counts(leave).then_some(config.moved_far_mm / 1000.0)).collect();
        let lane = Self { verdict: Verdict::of(&alley, &pin), pin, alley, pins: rack.pins().to_vec(), far };
        // Finds errors of the configuration now, not in the middle of a run.
        lane.alley.world_of(&lane.pin)?;
        Ok(lane)
    }

    /// The alley with the ball of a draw.
    pub(super) fn alley(&self, draw: &Shot) -> Alley {
        let radius = draw.get(Quantity::Radius);
        Alley {
            ball_radius: radius,
            ball_mass: draw.get(Quantity::Density) * 4.0 / 3.0 * std::f64::consts::PI * radius * radius * radius,
            ball_gyration: draw.get(Quantity::Gyration) * radius,
            ..self.alley
        }
    }

    /// How the ball starts, `distance` m before the head pin's spot.
    pub(super) fn start(draw: &Shot, distance: f64) -> Start {
        Start {
            position: DVec3::new(draw.get(Quantity::Across), -distance, draw.get(Quantity::Height)),
            orientation: DQuat::IDENTITY,
            velocity: DVec3::new(draw.get(Quantity::Drift), draw.get(Quantity::Speed), 0.0),
            spin: DVec3::new(-draw.get(Quantity::Roll), draw.get(Quantity::Hook), draw.get(Quantity::Twist)),
            time: 0.0,
        }
    }

    /// The places of those pins set up that are nearest to the bowler: one row.
    pub(super) fn first_row(&self, draw: &Shot) -> Vec<DVec3> {
        let row = |pin: usize| Alley::spot(pin).y;
        let least = self.pins.iter().map(|pin| row(*pin)).fold(f64::INFINITY, f64::min);
        let pins = self.pins.iter().zip(&draw.pins).filter(|(pin, _)| row(**pin) == least);
        let mut places: Vec<DVec3> = pins.map(|(pin, offset)| place(*pin, offset)).collect();
        places.sort_by(|a, b| a.y.total_cmp(&b.y));
        places
    }

    /// The lane with the ball of its alley, and a place for it and for each pin: at the foul line, and on their spots.
    pub(super) fn plain_world(&self) -> Result<PlainWorld, WorldError> {
        let up = DVec3::new(0.0, 0.0, self.pin.balance());
        let ball = DVec3::new(0.0, -LENGTH, self.alley.ball_radius);
        let places = std::iter::once(ball).chain(self.pins.iter().map(|&pin| Alley::spot(pin) + up)).collect();
        Ok(PlainWorld { world: Physical::Rigid(Box::new(self.alley.world_of(&self.pin)?)), places })
    }

    /// The world of a draw, and where everything starts: the ball `distance` m before the head pin's spot.
    pub(super) fn world(&self, draw: &Shot, distance: f64) -> Result<(Rigid, Vec<Start>), WorldError> {
        let up = self.pin.balance();
        let pin =
            |(number, offset): (&usize, &[f64; 2])| Start::at_rest(place(*number, offset) + DVec3::new(0.0, 0.0, up));
        let starts =
            std::iter::once(Self::start(draw, distance)).chain(self.pins.iter().zip(&draw.pins).map(pin)).collect();
        Ok((self.alley(draw).world_of(&self.pin)?, starts))
    }

    /// Bowls from `distance` m before the head pin's spot. Stops as soon as no pin's fate can change, or `hopeless`
    /// returns true for the pins that are down; in that case there is no outcome.
    pub(super) fn bowl(
        &self,
        draw: &Shot,
        distance: f64,
        work: &mut Work,
        hopeless: impl FnMut(Pins) -> bool,
        observer: impl Observer<Rigid>,
    ) -> Result<Option<Rest>, ModelError> {
        let (world, starts) = self.world(draw, distance).map_err(ModelError::new)?;
        let mut state = world.state(&starts).map_err(ModelError::new)?;
        let mut umpire = Umpire {
            world: &world,
            verdict: self.verdict.with_ball(&self.alley(draw)),
            starts: &starts,
            far: &self.far,
            still: Still::default(),
            hopeless,
            gave_up: false,
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
        if let Outcome::NotFinite { body } = outcome {
            return Err(ModelError::new(format!("the motion of body {body} is no longer finite")));
        }
        let fate = |(place, (body, start)): (usize, (&Turning, &Start))| {
            if umpire.down.contains(place) {
                return Fate::Down;
            }
            Fate::Standing(way(body, start, state.time()))
        };
        let pins = state.bodies().iter().zip(&starts).skip(1).enumerate().map(fate).collect();
        let struck = umpire.struck.iter().map(|&body| self.pins[body - 1] as u8).collect();
        Ok(Some(Rest { pins, entry: umpire.entry, struck, complete: outcome != Outcome::OutOfEvents }))
    }

    /// Bowls and records the shot: the world, all motions, and when it ends. Without a given end, it lasts for the
    /// scenario's `duration_s`.
    pub(super) fn record(
        &self,
        draw: &Shot,
        work: &mut Work,
        until: Option<Until>,
    ) -> Result<(Rigid, Trace<Turning>, f64), ModelError> {
        let mut trace = Trace::default();
        if until == Some(Until::Decided) {
            let mut clock = Clock(0.0);
            self.bowl(draw, LENGTH, work, |_| false, (&mut trace, &mut clock))?;
            return Ok((self.world(draw, LENGTH).map_err(ModelError::new)?.0, trace, clock.0));
        }
        let (world, starts) = self.world(draw, LENGTH).map_err(ModelError::new)?;
        let mut state = world.state(&starts).map_err(ModelError::new)?;
        let longest = until.map_or(self.alley.duration, |_| self.alley.duration.max(LONGEST));
        let outcome = world.run(&mut state, &mut work.scratch, longest, &mut trace).map_err(ModelError::new)?;
        let last = trace.motions.iter().filter_map(|motions| motions.last()).map(|motion| motion.path.t);
        let end = if until.is_some() && outcome == Outcome::TimeReached { longest } else { last.fold(0.0, f64::max) };
        Ok((world, trace, end))
    }

    /// Name of a body.
    pub(super) fn name(&self, body: usize) -> String {
        if body == 0 { "ball".into() } else { format!("pin_{}", self.pins[body - 1]) }
    }

    /// The pin's form.
    pub(super) fn pin(&self) -> &Revolution {
        &self.pin
    }
}

/// Notes the time of the last event.
struct Clock(f64);

impl Observer<Rigid> for Clock {
    fn proceed(&mut self, state: &State<Turning>) -> bool {
        self.0 = state.time();
        true
    }
}

/// Watches a shot: what the ball strikes, and when the shot is decided.
struct Umpire<'a, H> {
    world: &'a Rigid,
    verdict: Verdict,
    starts: &'a [Start],
    far: &'a [Option<f64>],
    still: Still,
    hopeless: H,
    gave_up: bool,
    /// Pins that have fallen at any time: one that rises again still counts as down.
    down: Pins,
    /// The ball's latest motion.
    path: Option<plaus_sim::motion::Parabola>,
    entry: Option<Entry>,
    /// Bodies that the ball struck.
    struck: Vec<usize>,
}

impl<H> Umpire<'_, H> {
    /// Whether no pin's fate can change any more, including whether it has moved far, if that counts.
    fn is_decided(&self, state: &State<Turning>) -> bool {
        let is_down = |body: usize| self.down.contains(body - 1);
        let Some(slack) = self.verdict.settled(self.world, state, &self.still, is_down) else { return false };
        let mut pins = state.bodies().iter().zip(self.starts).skip(1).zip(self.far).enumerate();
        pins.all(|(place, ((pin, start), far))| match far {
            Some(far) if !self.down.contains(place) => (way(pin, start, state.time()) - far).abs() > slack,
            _ => true,
        })
    }
}

impl<H: FnMut(Pins) -> bool> Observer<Rigid> for Umpire<'_, H> {
    fn impact(&mut self, impact: &Impact) {
        let (0, Other::Body(pin)) = (impact.body, impact.other) else { return };
        if self.struck.contains(&pin) {
            return;
        }
        self.struck.push(pin);
        if let (None, Some(path)) = (self.entry, self.path) {
            let velocity = path.velocity_after(impact.time - path.t);
            let angle = math::atan2(velocity.x, velocity.y).to_degrees();
            self.entry = Some(Entry { across: path.at(impact.time).x, angle });
        }
    }

    fn motion(&mut self, index: usize, body: &Turning) {
        if index == 0 && self.entry.is_none() {
            self.path = Some(body.path);
        }
    }

    fn proceed(&mut self, state: &State<Turning>) -> bool {
        if self.struck.is_empty() && is_in_gutter(&state.bodies()[0]) {
            return false;
        }
        self.still.look(state);
        let before = self.down;
        for (place, pin) in state.bodies()[1..].iter().enumerate() {
            if Verdict::has_fallen(pin) {
                self.down.insert(place);
            }
        }
        self.gave_up = self.down != before && (self.hopeless)(self.down);
        !self.gave_up && !self.is_decided(state)
    }
}

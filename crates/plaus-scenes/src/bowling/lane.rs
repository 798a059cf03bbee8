//! The lane of a scenario: its alley with the ball of a draw, and where everything starts.

use super::alley::Alley;
use super::config::{Config, Rewarded};
use super::draw::Shot;
use super::rack::Rack;
use super::release::{Delivery, Quantity};
use super::verdict::Verdict;
use crate::world::{Physical, PlainWorld};
use glam::{DQuat, DVec3};
use plaus_dist::Gibbs;
use plaus_sim::WorldError;
use plaus_sim::material::Law;
use plaus_sim::rigid::{RigidWorld, Start};
use plaus_sim::shape::{Profile, Revolution};
use std::sync::Arc;

/// Width of the lane in m.
pub(super) const WIDTH: f64 = Alley::WIDTH;

/// From the foul line to the head pin's spot in m.
pub(super) const LENGTH: f64 = Alley::LENGTH;

/// A pin less than this to the side of one before it can be hidden by that one, in m: the largest ball and two pins are
/// this wide together. Only the aim depends on it.
const SHADOW: f64 = 0.34;

/// What all shots of a scenario have in common.
#[derive(Debug)]
pub(super) struct Lane {
    pub(super) alley: Alley,
    pub(super) pin: Arc<Revolution>,
    pub(super) verdict: Verdict,
    pub(super) pins: Vec<usize>,
    /// Whether each of them should stand at the end.
    pub(super) leave: Vec<bool>,
    /// The reward for pins that end as they should.
    pub(super) goal: Gibbs,
    /// How far a pin may be moved, in m, for each pin that is rewarded for not having moved far.
    pub(super) far: Vec<Option<f64>>,
    /// How far before the head pin's spot the ball is, in m, where an animation begins.
    pub(super) shown: f64,
    /// The outline of a pin as it is drawn: radii and heights in m about its centre of gravity.
    pub(super) profile: Vec<[f64; 2]>,
}

/// Where a pin with this offset in mm stands.
fn place(number: usize, offset: &[f64; 2]) -> DVec3 {
    Alley::spot(number) + DVec3::new(offset[0] / 1000.0, offset[1] / 1000.0, 0.0)
}

/// Points of a pin's drawn outline.
const OUTLINE: usize = 40;

/// The outline of a pin as it is drawn, about its centre of gravity.
fn outline(pin: &Revolution) -> Result<Vec<[f64; 2]>, WorldError> {
    Ok(Profile::pin().outline(OUTLINE)?.iter().map(|[r, height]| [*r, height - pin.balance()]).collect())
}

impl Lane {
    pub(super) fn new(config: &Config, rack: &Rack, goal: Gibbs) -> Result<Self, WorldError> {
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
        let (verdict, profile) = (Verdict::of(&alley, &pin), outline(&pin)?);
        let (pins, leave) = (rack.pins().to_vec(), rack.leave().to_vec());
        let lane = Self { verdict, pin, alley, pins, leave, goal, far, shown: config.shown_m, profile };
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

    /// The places of those pins set up that no other one stands before, from the bowler on.
    pub(super) fn foremost(&self, draw: &Shot) -> Vec<DVec3> {
        let is_before = |pin: DVec3, other: DVec3| other.y < pin.y && (other.x - pin.x).abs() < SHADOW;
        let is_free = |pin: usize| !self.pins.iter().any(|&other| is_before(Alley::spot(pin), Alley::spot(other)));
        let pins = self.pins.iter().zip(&draw.pins).filter(|(pin, _)| is_free(**pin));
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
    pub(super) fn world(&self, draw: &Shot, distance: f64) -> Result<(RigidWorld, Vec<Start>), WorldError> {
        let up = self.pin.balance();
        let pin =
            |(number, offset): (&usize, &[f64; 2])| Start::at_rest(place(*number, offset) + DVec3::new(0.0, 0.0, up));
        let starts =
            std::iter::once(Self::start(draw, distance)).chain(self.pins.iter().zip(&draw.pins).map(pin)).collect();
        Ok((self.alley(draw).world_of(&self.pin)?, starts))
    }

    /// Name of a body.
    pub(super) fn name(&self, body: usize) -> String {
        if body == 0 { "ball".into() } else { format!("pin_{}", self.pins[body - 1]) }
    }
}

//! A bowling alley: lane, gutters, kickbacks and pit, ten pins and a ball.

use glam::{DQuat, DVec3};
use plaus_sim::rigid::{BodySpec, RigidWorld, RigidWorldDesc, Section, Start, StaticShape};
use plaus_sim::scenery::{Aabb, Plane};
use plaus_sim::shape::{MassProperties, Profile, Revolution, Shape};
use plaus_sim::{Accuracy, Law, Laws, Material, WorldError};
use std::sync::Arc;

/// In m.
pub(super) const INCH: f64 = 0.0254;

/// In m/s².
pub(super) const GRAVITY: f64 = 9.81;

/// Where the deck ends and the pit begins: y in m.
pub(super) const END: f64 = 34.1875 * INCH;

/// Height of the gutters' floor beside the deck, and of the pit's, in m.
pub(super) const GUTTER: f64 = -3.5 * INCH;
pub(super) const PIT: f64 = -10.0 * INCH;

/// Where the lane begins, behind the foul line: y in inches.
const START: f64 = -740.0;

/// Half the width, and the end, of a practice lane, in m: farther than a ball gets in any time that matters.
const OPEN: f64 = 1000.0;

/// An alley along y. The head pin's spot is the origin, and the ball comes from negative y. Body 0 is the ball, the
/// others are the pins that are set up, in ascending order of their numbers: with all ten, body k is pin k.
#[derive(Debug, Clone, Copy)]
pub struct Alley {
    /// Radius of the ball in m. Regulation: 0.10795–0.10916.
    pub ball_radius: f64,
    /// Mass of the ball in kg. Regulation: at most 7.26.
    pub ball_mass: f64,
    /// Radius of gyration of the ball in m. Regulation: 0.0625–0.0711.
    pub ball_gyration: f64,
    /// Mass of a pin in kg. Regulation: 1.53–1.64.
    pub pin_mass: f64,
    /// Balls that make up a pin's skin.
    pub stations: usize,
    /// Between ball and lane.
    pub ball_lane: Law,
    /// Between ball and pin.
    pub ball_pin: Law,
    /// Between pins.
    pub pin_pin: Law,
    /// Between pin and lane, walls and pit.
    pub pin_lane: Law,
    /// Tolerances.
    pub accuracy: Accuracy,
    /// Length of a run in s.
    pub duration: f64,
    /// Which pins are set up; pin k is entry k − 1.
    pub standing: [bool; 10],
    /// Length of the lane in m, from the foul line on, that is oiled.
    pub oil: f64,
    /// Coefficient of friction between ball and oiled lane.
    pub oil_friction: f64,
}

impl Default for Alley {
    /// A 15 lb ball. The coefficients of pins are not published; these are usual values.
    fn default() -> Self {
        Self {
            ball_radius: 0.1085,
            ball_mass: 6.8,
            ball_gyration: 0.066,
            pin_mass: 1.59,
            stations: 40,
            ball_lane: Law::new(0.12, 0.2),
            ball_pin: Law::new(0.15, 0.7),
            pin_pin: Law::new(0.2, 0.6),
            pin_lane: Law::new(0.25, 0.4).with_resistance(0.02, 0.01),
            accuracy: Accuracy::default(),
            duration: 5.0,
            standing: [true; 10],
            oil: 0.0,
            oil_friction: 0.04,
        }
    }
}

const BALL: Material = Material(0);
const PIN: Material = Material(1);
const WOOD: Material = Material(2);

impl Alley {
    /// How many materials there are.
    pub(super) const MATERIALS: u16 = 3;

    /// Names of the parts.
    pub(super) const PARTS: [&str; 9] = [
        "lane",
        "gutter_left",
        "gutter_right",
        "flat_gutter_left",
        "flat_gutter_right",
        "kickback_left",
        "kickback_right",
        "pit",
        "cushion",
    ];

    /// Width of the lane in m.
    pub const WIDTH: f64 = 41.5 * INCH;

    /// From the foul line to the head pin's spot in m.
    pub const LENGTH: f64 = 60.0 * 12.0 * INCH;

    /// Numbers of the pins that are set up, in ascending order: those of bodies 1, 2, …
    pub fn set_up(&self) -> impl Iterator<Item = usize> {
        let standing = self.standing;
        (1..=10).filter(move |pin| standing[pin - 1])
    }

    /// Where a pin (1–10) stands, on the lane's surface.
    #[must_use]
    pub fn spot(pin: usize) -> DVec3 {
        let (row, place) = match pin {
            1 => (0, 0),
            2..=3 => (1, pin - 2),
            4..=6 => (2, pin - 4),
            _ => (3, pin - 7),
        };
        // Numbers grow from the bowler's left, which is −x.
        let x = 12.0 * INCH * (place as f64 - 0.5 * f64::from(row));
        DVec3::new(x, 6.0 * 3.0_f64.sqrt() * INCH * f64::from(row), 0.0)
    }

    /// The pin.
    ///
    /// # Errors
    /// [`WorldError`] for impossible numbers.
    pub fn pin(&self) -> Result<Revolution, WorldError> {
        Revolution::new(&Profile::pin(), self.stations)
    }

    /// The world.
    ///
    /// # Errors
    /// [`WorldError`] for impossible numbers.
    pub fn world(&self) -> Result<RigidWorld, WorldError> {
        self.world_of(&Arc::new(self.pin()?))
    }

    /// The world, with an [`Alley::pin`] made earlier: for many worlds that differ in the ball.
    ///
    /// # Errors
    /// [`WorldError`] for impossible numbers.
    pub fn world_of(&self, pin: &Arc<Revolution>) -> Result<RigidWorld, WorldError> {
        self.among(self.bodies(pin), self.parts()?)
    }

    /// The ball and the pins that are set up.
    pub(super) fn bodies(&self, pin: &Arc<Revolution>) -> Vec<BodySpec> {
        let mass = pin.mass_properties(1.0).with_mass(self.pin_mass);
        let pin = |_| BodySpec { shape: Shape::Revolution(Arc::clone(pin)), mass, material: PIN };
        std::iter::once(self.ball()).chain(self.set_up().map(pin)).collect()
    }

    /// The ball alone on a lane with the same friction that is wide and continues behind the pins: it shows where a
    /// delivery leads.
    ///
    /// # Errors
    /// [`WorldError`] for impossible numbers.
    pub fn practice(&self) -> Result<RigidWorld, WorldError> {
        self.among(vec![self.ball()], vec![self.lane(OPEN, OPEN)])
    }

    fn ball(&self) -> BodySpec {
        let inertia = DVec3::splat(self.ball_mass * self.ball_gyration * self.ball_gyration);
        BodySpec {
            shape: Shape::Ball(self.ball_radius),
            mass: MassProperties { mass: self.ball_mass, inertia },
            material: BALL,
        }
    }

    /// The laws of pairs of ball, pins and wood.
    pub(super) fn laws(&self) -> Result<Laws, WorldError> {
        let mut laws = Laws::new(Self::MATERIALS, self.pin_lane)?;
        laws.set(BALL, WOOD, self.ball_lane)?;
        laws.set(BALL, PIN, self.ball_pin)?;
        laws.set(PIN, PIN, self.pin_pin)?;
        Ok(laws)
    }

    fn among(&self, bodies: Vec<BodySpec>, parts: Vec<StaticShape>) -> Result<RigidWorld, WorldError> {
        RigidWorld::new(RigidWorldDesc {
            bodies,
            parts,
            laws: self.laws()?,
            gravity: DVec3::new(0.0, 0.0, -GRAVITY),
            accuracy: self.accuracy,
            skin: 1.0,
            sink: -5.0 * INCH,
            duration: self.duration,
        })
    }

    /// The lane, with half this width and up to this end, in m.
    fn lane(&self, half: f64, end: f64) -> StaticShape {
        let start = START * INCH;
        let oiled = Section { from: start, friction: Some(self.oil_friction) };
        let dry = Section { from: self.oil - Self::LENGTH, friction: None };
        StaticShape::Block {
            bounds: Aabb { min: DVec3::new(-half, start, -12.0 * INCH), max: DVec3::new(half, end, 0.0) },
            material: WOOD,
            sections: if self.oil > 0.0 { vec![oiled, dry] } else { Vec::new() },
        }
    }

    /// In the order of their [names](Alley::PARTS).
    pub(super) fn parts(&self) -> Result<Vec<StaticShape>, WorldError> {
        let (half, gutter, end, start) = (0.5 * Self::WIDTH / INCH, 9.25, END / INCH, START);
        let block = |min: [f64; 3], max: [f64; 3]| StaticShape::Block {
            bounds: Aabb { min: DVec3::from(min) * INCH, max: DVec3::from(max) * INCH },
            material: WOOD,
            sections: Vec::new(),
        };
        let plane = |point: [f64; 3], normal: DVec3| {
            Ok(StaticShape::Plane(Plane::new(DVec3::from(point) * INCH, normal, WOOD)?))
        };
        let wall = half + gutter + 0.0625;
        let (floor, pit) = (GUTTER / INCH, PIT / INCH);
        Ok(vec![
            // Lane and deck, then the gutters' floors: deeper at the deck.
            self.lane(half * INCH, end * INCH),
            block([-wall, start, -12.0], [-half, -24.0, -1.875]),
            block([half, start, -12.0], [wall, -24.0, -1.875]),
            block([-wall, -24.0, -12.0], [-half, end, floor]),
            block([half, -24.0, -12.0], [wall, end, floor]),
            // Kickbacks, pit, and the cushion behind it.
            plane([-wall, 0.0, 0.0], DVec3::X)?,
            plane([wall, 0.0, 0.0], -DVec3::X)?,
            plane([0.0, 0.0, pit], DVec3::Z)?,
            plane([0.0, 66.0, 0.0], -DVec3::Y)?,
        ])
    }

    /// The ball on the lane with its centre at `x`, `distance` m before the head pin's spot, rolling or sliding towards
    /// the pins, and all pins on their spots.
    ///
    /// # Errors
    /// [`WorldError`] for impossible numbers.
    pub fn starts(&self, distance: f64, x: f64, velocity: DVec3, spin: DVec3) -> Result<Vec<Start>, WorldError> {
        let up = self.pin()?.balance();
        let ball = Start {
            position: DVec3::new(x, -distance, self.ball_radius),
            orientation: DQuat::IDENTITY,
            velocity,
            spin,
            time: 0.0,
        };
        let pins = self.set_up().map(|k| Start::at_rest(Self::spot(k) + DVec3::new(0.0, 0.0, up)));
        Ok(std::iter::once(ball).chain(pins).collect())
    }

    /// Whether a pin still stands upright near its spot.
    #[must_use]
    pub fn stands(pin: usize, x: DVec3, up: DVec3) -> bool {
        up.z > 0.9 && (x - Self::spot(pin)).truncate().length() < 0.06 && x.z > 0.1
    }
}

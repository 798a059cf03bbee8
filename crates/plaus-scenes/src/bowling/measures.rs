//! The heights and energies that decide whether a pin can still fall.

use super::alley::{Alley, GRAVITY};
use plaus_dist::math;
use plaus_sim::shape::Revolution;

/// Total energy that the bodies that can still meet a standing pin may have, over the energy that tips a pin. Default
/// 0.75. The rest, 9 mJ, is for the energy that lasting contact may add by pushing bodies out of overlaps, at most 4 mJ
/// at a time. Danger: at 1 and above nothing is certain.
const HARMLESS: f64 = 0.75;

/// Number of angles at which a lying pin's lowest height is computed: their heights differ by less than 0.1 mm, or 2
/// mJ. Default 8000.
const ANGLES: u32 = 8000;

/// Distance that a pin's middle moves over that of its farther end, when it rolls in a circle on belly and head.
/// Default 0.7.
const ENDS: f64 = 0.7;

/// Fraction of its weight that rests on its head. Default 0.13, because its middle is 26 mm from where the belly
/// touches, and the head 230 mm.
const HEAD: f64 = 0.13;

/// Distance in m along its axis from a pin's middle within which it is convex. Default 0.04: beyond that, towards the
/// head, it is narrower.
const BELLY: f64 = 0.04;

/// Of the pins and the ball of an alley.
#[derive(Debug, Clone, Copy)]
pub(super) struct Measures {
    /// Energy in J that tips a standing pin, and the part of it that other bodies may have without harm.
    pub(super) tipping: f64,
    pub(super) harmless: f64,
    /// Height in m of the middle of a standing pin, and least heights for a lying pin: with all of it over the ground,
    /// and with only its middle over the ground.
    pub(super) upright: f64,
    pub(super) lying: f64,
    pub(super) inside: f64,
    /// Distance in m of a pin's farthest point from its middle, and its largest radius.
    pub(super) reach: f64,
    pub(super) widest: f64,
    /// Radius of the ball in m.
    pub(super) ball: f64,
    /// Weights in N of the ball and of a pin.
    pub(super) weights: [f64; 2],
    /// Least energy in J that a pin loses for each metre of its path while it touches.
    pub(super) roll: f64,
}

/// Distance in m of a pin's middle from the circle on which it stands.
pub(super) fn slant(pin: &Revolution) -> f64 {
    let rim = pin.rings()[0];
    (rim.height * rim.height + rim.circle * rim.circle).sqrt()
}

impl Measures {
    pub(super) fn of(alley: &Alley, pin: &Revolution) -> Self {
        let (weight, law) = (alley.pin_mass * GRAVITY, alley.pin_lane);
        let tipping = weight * (slant(pin) + pin.rings()[0].height);
        Self {
            tipping,
            harmless: HARMLESS * tipping,
            upright: pin.balance(),
            lying: lying(pin, f64::INFINITY),
            inside: lying(pin, BELLY),
            reach: pin.reach(),
            widest: pin.row().iter().map(|ball| ball.radius).fold(0.0, f64::max),
            ball: alley.ball_radius,
            weights: [alley.ball_mass * GRAVITY, weight],
            roll: weight * (ENDS * law.rolling).min(HEAD * law.friction),
        }
    }

    /// With the ball of another alley.
    pub(super) fn with_ball(mut self, alley: &Alley) -> Self {
        self.weights[0] = alley.ball_mass * GRAVITY;
        self.ball = alley.ball_radius;
        self
    }
}

/// The least height of the middle of a pin that lies on the deck at any angle, if only the part within `near` of its
/// middle along its axis has ground below it.
pub(super) fn lying(pin: &Revolution, near: f64) -> f64 {
    let step = std::f64::consts::PI / f64::from(ANGLES);
    let height = |angle: f64| {
        let (sin, cos) = math::sin_cos(angle);
        let row = pin.row().iter().filter(|ball| ball.centre.z.abs() <= near);
        let rings = pin.rings().iter().filter(|ring| ring.height.abs() <= near);
        let balls = row.map(|ball| ball.radius - ball.centre.z * cos);
        let rings = rings.map(|ring| ring.radius + ring.circle * sin - ring.height * cos);
        balls.chain(rings).fold(0.0, f64::max)
    };
    // Between two angles, it can be lower by at most the effect of turning by half a step.
    let least = (0..=ANGLES).map(|k| height(f64::from(k) * step)).fold(f64::INFINITY, f64::min);
    least - 0.5 * step * pin.reach()
}

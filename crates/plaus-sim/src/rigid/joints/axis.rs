//! What acts along the one degree of freedom of a hinge or a slider: limits, dry friction, springs and motors.
//!
//! Its *coordinate* is the angle by which the body's frame is turned from the other's about their z axis, or the
//! distance by which its anchor is ahead of the other's along that axis. It is 0 at the starts with which a joint is
//! made.

use crate::error::WorldError;
use crate::rigid::BodyDef;
use crate::rigid::motion::kinematic::{Key, Keyframes, KinematicPath, Track};
use crate::rigid::tolerances::WIDEST_HINGE;
use glam::{DQuat, DVec3};
use plaus_dist::math;
use std::f64::consts::PI;

/// How a hinge turns, or a slider slides: its coordinate is in rad or m, with forces in N m or N.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct AxisJoint {
    /// Least and largest coordinate. Those of a hinge are in [−π, π] and at most 6 apart. Default none.
    pub limits: Option<[f64; 2]>,
    /// Restitution at the limits, in [0, 1]: by Newton's rule. Default 0.
    pub restitution: f64,
    /// Dry friction, in [0, ∞): the same at rest and in motion, and under any load. Default 0.
    pub friction: f64,
    /// A spring with a damper. Default none.
    pub spring: Option<Spring>,
}

/// A linear spring with a linear damper: `stiffness (rest − q) − damping q′` acts along the coordinate q. Where a hinge
/// has no limits, its angle is the one within half a turn of `rest`.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Spring {
    /// In N m/rad or N/m, in [0, ∞).
    pub stiffness: f64,
    /// The coordinate at which it does not pull, in rad or m. That of a hinge is in [−π, π].
    pub rest: f64,
    /// In N m s/rad or N s/m, in [0, ∞).
    pub damping: f64,
}

/// What moves a hinge or slider, by a torque in N m or a force in N that is never greater than `most`.
#[derive(Debug, Clone, PartialEq)]
pub struct Motor {
    /// What it seeks.
    pub goal: MotorGoal,
    /// Its greatest torque or force, in (0, ∞).
    pub most: f64,
}

/// What a motor seeks.
#[derive(Debug, Clone, PartialEq)]
pub enum MotorGoal {
    /// A speed in rad/s or m/s.
    Speed(f64),
    /// A coordinate in rad or m over time. Of an angle, what counts is the way to it that is less than half a turn.
    Keys {
        /// The coordinate.
        track: Track<f64>,
        /// Time in s, in (0, ∞), in which the motor seeks to make what it lags behind e times less: at
        /// `lag / catch_up` beside the speed of the track.
        catch_up: f64,
    },
}

/// A checked motor.
#[derive(Debug, Clone)]
pub(crate) struct JointMotor {
    pub(super) most: f64,
    speed: f64,
    /// The path on which it goes, along x, and the time in which it catches up.
    keys: Option<(KinematicPath, f64)>,
}

impl JointMotor {
    pub(super) fn new(motor: &Motor, spec: &BodyDef) -> Result<Self, Fault> {
        if !(motor.most > 0.0 && motor.most.is_finite()) {
            return Err(("greatest force of its motor", motor.most, "a positive number"));
        }
        let (speed, keys) = match &motor.goal {
            MotorGoal::Speed(speed) if !speed.is_finite() => {
                return Err(("speed of its motor", *speed, "a finite number"));
            }
            MotorGoal::Speed(speed) => (*speed, None),
            MotorGoal::Keys { catch_up, .. } if !(*catch_up > 0.0 && catch_up.is_finite()) => {
                return Err(("time in which its motor catches up", *catch_up, "a positive number"));
            }
            MotorGoal::Keys { track, catch_up } => {
                let key = |key: &Key<f64>| Key {
                    time: key.time,
                    value: DVec3::X * key.value,
                    slopes: key.slopes.map(|slope| DVec3::X * slope),
                };
                let position = Track { between: track.between, keys: track.keys.iter().map(key).collect() };
                let keys = Keyframes { position, rotation: Track::fixed(DQuat::IDENTITY) };
                let wrong = |error| match error {
                    WorldError::BadKey { field, value, expected, .. } => (field, value, expected),
                    _ => ("key of its motor", f64::NAN, "a finite number"),
                };
                (0.0, Some((KinematicPath::new(0, spec, &keys).map_err(wrong)?, *catch_up)))
            }
        };
        Ok(Self { most: motor.most, speed, keys })
    }

    /// The mean rate that it seeks in a step of `h` seconds from a time on, and the one at its end. `behind` is by how
    /// much it lags where it seeks a coordinate.
    pub(super) fn rates(&self, time: f64, h: f64, behind: impl Fn(f64) -> f64) -> [f64; 2] {
        let Some((path, catch_up)) = &self.keys else { return [self.speed; 2] };
        let (carried, lag) = (path.carried(time, h), behind(path.moved(time, 0.0).x.x));
        let left = math::exp(-h / catch_up);
        [carried.mean.0.x + lag * (1.0 - left) / h, carried.end.0.x + lag * left / catch_up]
    }

    /// How long after a time its next key comes.
    pub(crate) fn left(&self, time: f64) -> f64 {
        self.keys.as_ref().map_or(f64::INFINITY, |(path, _)| path.left(time))
    }

    /// Whether it goes nowhere by itself after a time.
    pub(crate) fn is_still(&self, time: f64) -> bool {
        self.left(time) == f64::INFINITY
    }
}

/// A field of an invalid joint, its value, and what is expected.
pub(super) type Fault = (&'static str, f64, &'static str);

impl AxisJoint {
    pub(super) fn check(&self, is_hinge: bool) -> Result<(), Fault> {
        if let Some([low, high]) = self.limits {
            let value = if high.is_nan() { high } else { low };
            if is_hinge && !(-PI <= low && low < high && high <= PI && high - low <= WIDEST_HINGE) {
                return Err(("limit", value, "an angle from −π on, less than the other, which is within 6 and π"));
            }
            if !(low < high && low.is_finite() && high.is_finite()) {
                return Err(("limit", value, "a finite distance, less than the other"));
            }
        }
        if !(0.0..=1.0).contains(&self.restitution) {
            return Err(("restitution", self.restitution, "a number in [0, 1]"));
        }
        if !(self.friction >= 0.0 && self.friction.is_finite()) {
            let expected = if is_hinge { "a torque from 0 on" } else { "a force from 0 on" };
            return Err(("friction", self.friction, expected));
        }
        if let Some(Spring { stiffness, rest, damping }) = self.spring {
            for (field, value) in [("stiffness", stiffness), ("damping", damping)] {
                if !(value >= 0.0 && value.is_finite()) {
                    return Err((field, value, "a finite number from 0 on"));
                }
            }
            if rest.is_nan() || rest.abs() > if is_hinge { PI } else { f64::MAX } {
                let expected = if is_hinge { "an angle within −π and π" } else { "a finite distance" };
                return Err(("rest of its spring", rest, expected));
            }
        }
        Ok(())
    }
}

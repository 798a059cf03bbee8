//! What acts along the one degree of freedom of a hinge or a slider: limits, dry friction, springs and motors.
//!
//! Its *coordinate* is the angle by which the body's frame is turned from the other's about their z axis, or the
//! distance by which its anchor is ahead of the other's along that axis. It is 0 at the starts with which a joint is
//! made.

use crate::rigid::tolerances::WIDEST_HINGE;
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
            if !(rest.abs() <= if is_hinge { PI } else { f64::MAX }) {
                let expected = if is_hinge { "an angle within −π and π" } else { "a finite distance" };
                return Err(("rest of its spring", rest, expected));
            }
        }
        Ok(())
    }
}

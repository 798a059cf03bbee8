//! From a simulator's axes, where z points up, to an animation's, where y points up.

use glam::{DQuat, DVec3};
use std::f64::consts::FRAC_1_SQRT_2;

/// Turns a simulator's axes into an animation's: a quarter turn about x.
pub const UPRIGHT: DQuat = DQuat::from_xyzw(-FRAC_1_SQRT_2, 0.0, 0.0, FRAC_1_SQRT_2);

/// A vector in a simulator's axes, in those of an animation; exact.
#[must_use]
pub fn upright(v: DVec3) -> DVec3 {
    DVec3::new(v.x, v.z, -v.y)
}

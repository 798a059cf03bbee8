//! Rotations about an axis.

use glam::{DQuat, DVec3};
use plaus_dist::math;

/// Rotation by `angle` about a unit vector.
#[inline]
pub(super) fn about(axis: DVec3, angle: f64) -> DQuat {
    let (s, c) = math::sin_cos(0.5 * angle);
    DQuat::from_xyzw(axis.x * s, axis.y * s, axis.z * s, c)
}

/// Rotation by the vector `turn` in radians.
#[inline]
pub(crate) fn rotation(turn: DVec3) -> DQuat {
    let angle = turn.length();
    if angle > 0.0 { about(turn / angle, angle) } else { DQuat::IDENTITY }
}

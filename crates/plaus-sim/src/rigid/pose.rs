//! Place and velocities of a body at one time.

use super::BodyDef;
use glam::{DMat3, DVec3};

/// Place and velocities at one time.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Pose {
    pub(crate) x: DVec3,
    pub(crate) r: DMat3,
    pub(crate) v: DVec3,
    pub(crate) w: DVec3,
}

impl Pose {
    /// Velocity of the body's point at `offset` from the centre of gravity.
    #[inline]
    pub(crate) fn velocity(&self, offset: DVec3) -> DVec3 {
        self.v + self.w.cross(offset)
    }

    /// A bound on the speed of all points of the body.
    pub(super) fn fastest(&self, spec: &BodyDef) -> f64 {
        self.v.length() + self.w.length() * spec.bounding_radius
    }
}

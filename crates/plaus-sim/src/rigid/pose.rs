//! Where a body is, and where it starts.

use super::BodyDef;
use glam::{DMat3, DQuat, DVec3};
use serde::{Deserialize, Serialize};

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

/// Where a body starts.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Start {
    /// Centre of gravity in m.
    pub position: DVec3,
    /// Turns body axes into world axes.
    pub orientation: DQuat,
    /// In m/s.
    pub velocity: DVec3,
    /// Angular velocity in rad/s, in world axes.
    pub spin: DVec3,
    /// When the body appears, in s.
    pub time: f64,
}

impl Start {
    /// At rest and upright at a point at time 0.
    #[must_use]
    pub fn at_rest(position: DVec3) -> Self {
        Self { position, orientation: DQuat::IDENTITY, velocity: DVec3::ZERO, spin: DVec3::ZERO, time: 0.0 }
    }
}

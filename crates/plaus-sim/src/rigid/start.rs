//! Where a body starts.

use glam::{DQuat, DVec3};
use serde::{Deserialize, Serialize};

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

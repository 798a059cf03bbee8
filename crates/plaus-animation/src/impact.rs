//! Impacts, for sound and for marks on a timeline.

use glam::DVec3;
use serde::{Deserialize, Serialize};

/// A contact of a body with something else.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Impact {
    /// Seconds.
    pub time: f64,
    /// The body's name.
    pub body: String,
    /// What it hit: another body or a part of the scenery.
    pub other: String,
    /// The place.
    pub point: DVec3,
    /// Unit normal of the surface hit, towards the body.
    pub normal: DVec3,
    /// Speed at which the two met along the normal, m/s; 0 if unknown.
    pub speed: f64,
    /// Size of the impulse between them, N·s; 0 if unknown.
    pub impulse: f64,
}

impl Impact {
    /// An impact of unknown strength.
    pub fn new(time: f64, body: impl Into<String>, other: impl Into<String>, point: DVec3, normal: DVec3) -> Self {
        Self { time, body: body.into(), other: other.into(), point, normal, speed: 0.0, impulse: 0.0 }
    }

    /// The same impact with the speed at which the two met along the normal (m/s), and the impulse between them (N·s).
    #[must_use]
    pub fn with_strength(self, speed: f64, impulse: f64) -> Self {
        Self { speed, impulse, ..self }
    }

    /// Whether a body took part.
    #[must_use]
    pub fn involves(&self, name: &str) -> bool {
        self.body == name || self.other == name
    }
}

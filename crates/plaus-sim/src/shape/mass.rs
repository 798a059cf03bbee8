//! Mass and inertia.

use super::hull::principal;
use glam::{DMat3, DQuat, DVec3};

/// Mass and principal moments of inertia about the centre of gravity.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct MassProperties {
    /// In kg.
    pub mass: f64,
    /// About the body's three axes, in kg m².
    pub inertia: DVec3,
}

impl MassProperties {
    /// A solid sphere.
    #[must_use]
    pub fn ball(radius: f64, density: f64) -> Self {
        let mass = 4.0 / 3.0 * std::f64::consts::PI * radius * radius * radius * density;
        Self { mass, inertia: DVec3::splat(0.4 * mass * radius * radius) }
    }

    /// Principal moments of a symmetric tensor of inertia, and what turns their axes into those of the tensor.
    #[must_use]
    pub fn principal(tensor: DMat3) -> (DVec3, DQuat) {
        let (moments, axes) = principal(tensor);
        (moments, DQuat::from_mat3(&axes).normalize())
    }

    /// The same shape with a different mass.
    #[must_use]
    pub fn with_mass(self, mass: f64) -> Self {
        Self { mass, inertia: self.inertia * (mass / self.mass) }
    }
}

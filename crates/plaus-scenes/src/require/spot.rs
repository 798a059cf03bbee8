//! Spots at which something should come to rest, as pictures and galleries mark them.

use crate::animation::{Form, Look, Prop, upright};
use glam::DVec3;
use plaus_dist::math;
use std::f64::consts::TAU;

/// Corners of the disc that marks a spot.
const CORNERS: u32 = 32;

/// How far above the ground it lies, in mm: enough not to flicker.
const ABOVE: f64 = 0.3;

/// A spot, and how far from it is near enough.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Spot {
    /// z up.
    pub(super) at_mm: [f64; 3],
    pub(super) within_mm: f64,
}

impl Spot {
    /// A disc that nothing touches.
    pub(super) fn prop(&self, number: usize) -> Prop {
        let middle = DVec3::from_array(self.at_mm) + ABOVE * DVec3::Z;
        let corner = |k: u32| {
            let (sin, cos) = math::sin_cos(TAU * f64::from(k) / f64::from(CORNERS));
            upright(1e-3 * (middle + self.within_mm * DVec3::new(cos, sin, 0.0)))
        };
        let triangles = (2..CORNERS).map(|k| [0, k - 1, k]).collect();
        let form = Form::Mesh { vertices: (0..CORNERS).map(corner).collect(), triangles };
        Prop::new(format!("spot_{}", number + 1), Look::TARGET, form)
    }
}

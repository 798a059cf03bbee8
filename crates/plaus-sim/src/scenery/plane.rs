//! Infinite planes: everything behind one is solid.

use crate::error::{SurfaceId, WorldError, first_not_finite};
use crate::material::Material;
use crate::scenery::Aabb;
use glam::DVec3;
use serde::{Deserialize, Serialize};

/// The half space `normal · x < offset` is solid.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Plane {
    /// Unit normal out of the solid.
    pub normal: DVec3,
    /// Distance of the plane from the origin along the normal, in m.
    pub offset: f64,
    /// What it is made of.
    pub material: Material,
}

impl Plane {
    /// The plane through `point` with `normal` (of any length) out of the solid.
    ///
    /// # Errors
    /// [`WorldError::BadSurface`] if the normal has no direction or a number is not finite.
    pub fn new(point: DVec3, normal: DVec3, material: Material) -> Result<Self, WorldError> {
        let bad = |field, value, expected| WorldError::BadSurface { surface: SurfaceId::Plane, field, value, expected };
        let length = normal.length();
        if !(length > 0.0 && length.is_finite()) {
            return Err(bad("normal", length, "a vector of finite, non-zero length"));
        }
        if let Some(value) = first_not_finite(&[point]) {
            return Err(bad("point", value, "finite coordinates"));
        }
        let normal = normal / length;
        Ok(Self { normal, offset: normal.dot(point), material })
    }

    /// Distance of a point from the plane, negative inside the solid.
    #[inline]
    #[must_use]
    pub fn distance(&self, x: DVec3) -> f64 {
        self.normal.dot(x) - self.offset
    }

    /// Whether a ball of radius up to `reach` whose centre is in a box, which may be endless, can touch the plane or be
    /// behind it.
    pub(crate) fn may_touch(&self, centres: &Aabb, reach: f64) -> bool {
        let nearest = |k: usize| match self.normal[k] {
            n if n > 0.0 => n * centres.min[k],
            n if n < 0.0 => n * centres.max[k],
            _ => 0.0,
        };
        let nearest = nearest(0) + nearest(1) + nearest(2) - self.offset;
        // A little more than the reach, for rounding. Infinities of both signs give NaN, and then the answer is yes.
        nearest.is_nan() || nearest <= reach + 1e-6 * (reach + self.offset.abs())
    }
}

//! Spherical caps: bowls (the ball is inside the sphere) and domes (it is outside).

use crate::error::{SurfaceId, WorldError, first_not_finite};
use crate::material::Material;
use crate::scenery::{Aabb, Projection};
use glam::DVec3;
use serde::{Deserialize, Serialize};

/// The part of a sphere's surface that lies inside a box.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Dome {
    /// Centre of the sphere.
    pub centre: DVec3,
    /// Its radius in m.
    pub radius: f64,
    /// Whether bodies touch it from inside (a bowl).
    pub hollow: bool,
    /// Only contact points in this box count.
    pub clip: Aabb,
    /// What it is made of.
    pub material: Material,
}

impl Dome {
    /// A cap.
    ///
    /// # Errors
    /// [`WorldError::BadSurface`] if the radius is not positive or a number is not finite.
    pub fn new(centre: DVec3, radius: f64, hollow: bool, clip: Aabb, material: Material) -> Result<Self, WorldError> {
        let bad = |field, value, expected| WorldError::BadSurface { surface: SurfaceId::Dome, field, value, expected };
        if !(radius > 0.0 && radius.is_finite()) {
            return Err(bad("radius", radius, "a positive length"));
        }
        if let Some(value) = first_not_finite(&[centre]) {
            return Err(bad("centre", value, "finite coordinates"));
        }
        if let Some(value) = first_not_finite(&[clip.min, clip.max]) {
            return Err(bad("clip", value, "finite coordinates"));
        }
        Ok(Self { centre, radius, hollow, clip, material })
    }

    /// Unit normal towards a body's centre `x`, and the distance of `x` from the surface (positive outside the solid).
    #[inline]
    #[must_use]
    pub fn normal_and_distance(&self, x: DVec3) -> (DVec3, f64) {
        let offset = x - self.centre;
        let length = offset.length();
        let outward = if length > 0.0 { offset / length } else { DVec3::Z };
        if self.hollow { (-outward, self.radius - length) } else { (outward, length - self.radius) }
    }

    /// The projection of a ball's centre on the surface.
    #[inline]
    pub(crate) fn stands(&self, x: DVec3) -> Projection {
        let (normal, distance) = self.normal_and_distance(x);
        Projection { normal, distance, curvature_radius: if self.hollow { -self.radius } else { self.radius } }
    }

    /// The surface point nearest to `x`, if it counts.
    #[inline]
    #[must_use]
    pub fn project(&self, x: DVec3) -> Option<DVec3> {
        let (normal, distance) = self.normal_and_distance(x);
        let point = x - normal * distance;
        self.clip.contains(point).then_some(point)
    }

    /// A box around the surface: the slab of the clip box that a cap opening along ±z can reach.
    pub(crate) fn bounds(&self) -> Aabb {
        let ball = Aabb { min: self.centre - self.radius, max: self.centre + self.radius };
        Aabb { min: self.clip.min.max(ball.min), max: self.clip.max.min(ball.max) }
    }

    /// The same, cut to the heights that the surface has over the clip box: a shallow bowl fills little of it.
    pub(crate) fn tight_bounds(&self) -> Aabb {
        let mut bounds = self.bounds();
        let far = (self.clip.min - self.centre).abs().max((self.clip.max - self.centre).abs());
        let deepest = self.radius * self.radius - far.x * far.x - far.y * far.y;
        if deepest <= 0.0 {
            return bounds;
        }
        // A hair more, for rounding. The lower half of the sphere lies below `low`, the upper above `high`.
        let half = deepest.sqrt() * (1.0 - 1e-9);
        let (low, high) = (self.centre.z - half, self.centre.z + half);
        if bounds.max.z < high {
            bounds.max.z = bounds.max.z.min(low);
        }
        if bounds.min.z > low {
            bounds.min.z = bounds.min.z.max(high);
        }
        bounds
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tight_bounds_hold_the_surface_and_little_more() {
        let clip = Aabb { min: DVec3::new(-1.0, -1.0, -2.0), max: DVec3::new(1.0, 1.0, 3.0) };
        for (hollow, z) in [(true, 4.0), (false, 4.0), (false, -4.0), (true, 0.5)] {
            let centre = DVec3::new(0.2, -0.1, z);
            let dome = Dome::new(centre, 4.0, hollow, clip, Material(0)).unwrap();
            let tight = dome.tight_bounds();
            let mut around = Aabb::EMPTY;
            for k in 0..40_000 {
                let (i, j) = (f64::from(k % 200) / 99.5 - 1.0, f64::from(k / 200) / 99.5 - 1.0);
                let flat = DVec3::new(i, j, 0.0) - centre.with_z(0.0);
                let up = (16.0 - flat.length_squared()).sqrt();
                for z in [centre.z - up, centre.z + up] {
                    let point = DVec3::new(i, j, z);
                    if clip.contains(point) {
                        assert!(tight.contains(point), "{point}");
                        around = around.union(Aabb::around([point]));
                    }
                }
            }
            if around.min.x <= around.max.x {
                // The samples are 0.01 apart: between them the surface rises by 3e-6 at a top, and by 0.003 at a rim.
                assert!(tight.max.z - around.max.z < 0.01, "{tight:?} {around:?}");
            }
        }
    }
}

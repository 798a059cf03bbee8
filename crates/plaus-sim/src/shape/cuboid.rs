//! Cuboids, sharp or with rounded edges and corners.

use super::MassProperties;
use crate::error::WorldError;
use glam::DVec3;
use std::f64::consts::PI;

/// A cuboid with edges along the body's axes. A rounded one is the sum of a smaller cuboid and a ball, so its faces
/// stay where they are.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Cuboid {
    half: DVec3,
    rounding: f64,
}

impl Cuboid {
    /// A cuboid with `edges` in m. Its edges and corners are rounded with radius `rounding` in m (0: sharp).
    ///
    /// # Errors
    /// [`WorldError::BadNumber`] if an edge is not positive, or the rounding is negative or not less than half the
    /// shortest edge.
    pub fn new(edges: DVec3, rounding: f64) -> Result<Self, WorldError> {
        for value in edges.to_array() {
            if !(value > 0.0 && value.is_finite()) {
                return Err(WorldError::BadNumber { field: "edge", value, expected: "a positive length" });
            }
        }
        if !(rounding >= 0.0 && 2.0 * rounding < edges.min_element()) {
            return Err(WorldError::BadNumber {
                field: "rounding",
                value: rounding,
                expected: "at least 0 and less than half the shortest edge",
            });
        }
        Ok(Self { half: edges * 0.5, rounding })
    }

    /// Half the edges in m.
    #[must_use]
    pub fn half(&self) -> DVec3 {
        self.half
    }

    /// Radius of edges and corners in m.
    #[must_use]
    pub fn rounding(&self) -> f64 {
        self.rounding
    }

    /// Centres of the corners' roundings; for a sharp cuboid, the corners. Bit k of the index tells the side along axis
    /// k.
    #[must_use]
    pub fn corners(&self) -> [DVec3; 8] {
        let c = self.half - self.rounding;
        std::array::from_fn(|k| {
            DVec3::from_array(std::array::from_fn(|axis| if k >> axis & 1 == 1 { c[axis] } else { -c[axis] }))
        })
    }

    /// Points on the edges and faces of the inner cuboid, on a lattice of at most `spacing`, without the corners.
    #[must_use]
    pub fn between(&self, spacing: f64) -> Vec<DVec3> {
        let c = self.half - self.rounding;
        // At most 16 intervals per edge: the cost grows with the square.
        let n = c.to_array().map(|c| (2.0 * c / spacing).ceil().clamp(1.0, 16.0) as usize);
        let at = |axis: usize, k: usize| -c[axis] + 2.0 * c[axis] * (k as f64 / n[axis] as f64);
        let mut points = Vec::new();
        for i in 0..=n[0] {
            for j in 0..=n[1] {
                for k in 0..=n[2] {
                    let ends = usize::from(i == 0 || i == n[0])
                        + usize::from(j == 0 || j == n[1])
                        + usize::from(k == 0 || k == n[2]);
                    if ends == 1 || ends == 2 {
                        points.push(DVec3::new(at(0, i), at(1, j), at(2, k)));
                    }
                }
            }
        }
        points
    }

    /// Mass and inertia, with the rounding integrated exactly: inner cuboid, six slabs, twelve quarter cylinders, eight
    /// octants of a ball.
    #[must_use]
    pub fn mass_properties(&self, density: f64) -> MassProperties {
        let (c, r) = (self.half - self.rounding, self.rounding);
        let volume = 8.0 * c.x * c.y * c.z
            + 8.0 * r * (c.x * c.y + c.y * c.z + c.z * c.x)
            + 2.0 * PI * r * r * (c.x + c.y + c.z)
            + 4.0 / 3.0 * PI * r * r * r;
        // Second moments ∫ x² dV along each axis.
        let second = DVec3::from_array(std::array::from_fn(|axis| {
            second_moment(c[axis], c[(axis + 1) % 3], c[(axis + 2) % 3], r)
        }));
        let about = DVec3::new(second.y + second.z, second.z + second.x, second.x + second.y);
        MassProperties { mass: density * volume, inertia: about * density }
    }
}

/// `∫ x² dV` of the cuboid `±a, ±b, ±c` grown by `r`.
fn second_moment(a: f64, b: f64, c: f64, r: f64) -> f64 {
    let middle = 2.0 * a * a * a / 3.0;
    // Cross-section of constant size along |x| < a: rounded rectangle.
    let section = 4.0 * b * c + 4.0 * r * (b + c) + PI * r * r;
    // Caps beyond |x| = a, at depth s: a rectangle grown by √(r² − s²). Both caps: 2 ∫₀ʳ (a + s)² A(s) ds, A = 4bc +
    // 4(b+c)√(r²−s²) + π(r²−s²).
    let (r2, r3) = (r * r, r * r * r);
    let slab = 4.0 * b * c * (a * a * r + a * r2 + r3 / 3.0);
    let quarters = 4.0 * (b + c) * (a * a * PI * r2 / 4.0 + 2.0 * a * r3 / 3.0 + PI * r2 * r2 / 16.0);
    let octants = PI * (a * a * 2.0 * r3 / 3.0 + a * r2 * r2 / 2.0 + 2.0 * r3 * r2 / 15.0);
    middle * section + 2.0 * (slab + quarters + octants)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sharp_cuboid() {
        let c = Cuboid::new(DVec3::new(1.0, 2.0, 3.0), 0.0).unwrap();
        let p = c.mass_properties(2.0);
        // m (y² + z²)/12 and so on; rounding only.
        assert!((p.mass - 12.0).abs() < 1e-14);
        assert!((p.inertia - DVec3::new(13.0, 10.0, 5.0)).length() < 1e-14);
    }

    #[test]
    fn rounding_to_almost_a_ball_gives_a_ball() {
        let (r, tiny) = (0.5, 1e-9);
        let c = Cuboid::new(DVec3::splat(2.0 * r + tiny), r).unwrap();
        let (p, q) = (c.mass_properties(3.0), MassProperties::ball(r, 3.0));
        // The inner cube's edge is 1e-9, so relative errors are a few times that.
        assert!((p.mass - q.mass).abs() < 1e-8 * q.mass && (p.inertia - q.inertia).length() < 1e-8);
    }

    #[test]
    fn rounding_agrees_with_a_plain_sum() {
        let c = Cuboid::new(DVec3::new(1.0, 1.4, 0.8), 0.2).unwrap();
        let (inner, n) = (c.half() - c.rounding(), 120);
        let (mut volume, mut second) = (0.0, DVec3::ZERO);
        let step = c.half() * (2.0 / f64::from(n));
        for i in 0..n {
            for j in 0..n {
                for k in 0..n {
                    let x = -c.half() + step * DVec3::new(f64::from(i) + 0.5, f64::from(j) + 0.5, f64::from(k) + 0.5);
                    if (x.abs() - inner).max(DVec3::ZERO).length() <= c.rounding() {
                        volume += 1.0;
                        second += x * x;
                    }
                }
            }
        }
        let cell = step.x * step.y * step.z;
        let p = c.mass_properties(1.0);
        // Cells cut by the rounding: about 1e-3 of the volume at 120 per edge.
        assert!((volume * cell / p.mass - 1.0).abs() < 1e-3);
        let about = DVec3::new(second.y + second.z, second.z + second.x, second.x + second.y) * cell;
        assert!(((about - p.inertia) / p.inertia).abs().max_element() < 2e-3);
    }

    #[test]
    fn points_between_lie_on_the_skin_and_leave_no_large_gaps() {
        let c = Cuboid::new(DVec3::ONE, 0.0).unwrap();
        // Two intervals per edge: 12 middles of edges and 6 of faces.
        assert_eq!(c.between(0.5).len(), 18);
        assert_eq!(c.between(2.0).len(), 0);
    }

    #[test]
    fn bad_sizes_are_refused() {
        for (edges, rounding) in
            [(DVec3::new(0.0, 1.0, 1.0), 0.0), (DVec3::ONE, 0.5), (DVec3::ONE, -0.1), (DVec3::NAN, 0.0)]
        {
            assert!(Cuboid::new(edges, rounding).is_err());
        }
    }
}

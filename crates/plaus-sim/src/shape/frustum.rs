//! Cylinders, cones and capsules: the convex hull of two discs about one axis, sharp or rounded.

use super::MassProperties;
use crate::error::WorldError;
use glam::DVec3;
use plaus_dist::math;
use std::f64::consts::{FRAC_PI_2, PI};

/// The convex hull of two discs across the z axis, and all that is within `rounding` of it.
///
/// A cylinder has two equal discs, a cone has a disc and a point, a capsule has two points and a rounding, and a
/// frustum has two discs of different radii. A frustum's own origin is half way between the discs; a body's origin is
/// its centre of gravity (see [`Compound`](crate::shape::Compound)).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Frustum {
    pub(crate) core: Discs,
    rounding: f64,
}

/// The core: heights and radii of the discs, the lower first.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Discs {
    pub(crate) heights: [f64; 2],
    pub(crate) radii: [f64; 2],
    /// Of the side in the half plane (distance from the axis, height): its unit normal, its direction, and its length.
    normal: [f64; 2],
    along: [f64; 2],
    length: f64,
}

/// Points of a rim at which contact is tested: its lowest point, and four that are fixed in the body.
pub(crate) const SLOTS: u8 = 5;

/// Sine of the angle between an axis and a normal up to which no point of the rim counts as the lowest. Default 1e-9:
/// except for rounding, the rim's other points are then as low.
const LEVEL: f64 = 1e-9;

impl Frustum {
    /// Between a disc of radius `radii[0]` and one of radius `radii[1]` at `height` above it, grown by `rounding`, all
    /// in m. Radii and height do not include the rounding.
    ///
    /// # Errors
    /// [`WorldError::BadNumber`] for a negative or infinite length, and for a solid without volume.
    pub fn new(radii: [f64; 2], height: f64, rounding: f64) -> Result<Self, WorldError> {
        for (field, value) in [("radius", radii[0]), ("radius", radii[1]), ("height", height), ("rounding", rounding)] {
            if !(value >= 0.0 && value.is_finite()) {
                return Err(WorldError::BadNumber { field, value, expected: "a length of at least 0" });
            }
        }
        let solid = Self { core: Discs::new([-0.5 * height, 0.5 * height], radii), rounding };
        if solid.moments().volume > 0.0 {
            Ok(solid)
        } else {
            Err(WorldError::BadNumber { field: "volume", value: 0.0, expected: "a positive volume" })
        }
    }

    /// A sharp cylinder.
    ///
    /// # Errors
    /// As [`Frustum::new`].
    pub fn cylinder(radius: f64, height: f64) -> Result<Self, WorldError> {
        Self::new([radius; 2], height, 0.0)
    }

    /// A sharp cone whose tip points along z.
    ///
    /// # Errors
    /// As [`Frustum::new`].
    pub fn cone(radius: f64, height: f64) -> Result<Self, WorldError> {
        Self::new([radius, 0.0], height, 0.0)
    }

    /// All points within `radius` of a segment of this `length` along z.
    ///
    /// # Errors
    /// As [`Frustum::new`].
    pub fn capsule(radius: f64, length: f64) -> Result<Self, WorldError> {
        Self::new([0.0; 2], length, radius)
    }

    /// How far it reaches beyond the hull of the discs, in m.
    #[must_use]
    pub fn rounding(&self) -> f64 {
        self.rounding
    }

    /// Heights and radii of the two discs, the lower first, in m.
    #[must_use]
    pub fn discs(&self) -> [[f64; 2]; 2] {
        [0, 1].map(|k| [self.core.heights[k], self.core.radii[k]])
    }

    /// Least half width, in m.
    pub(crate) fn size(&self) -> f64 {
        let half = 0.5 * (self.core.heights[1] - self.core.heights[0]);
        half.min(self.core.radii[0].max(self.core.radii[1])) + self.rounding
    }

    /// Height of the centre of gravity.
    pub(crate) fn balance(&self) -> f64 {
        let m = self.moments();
        m.first / m.volume
    }

    /// Mass and inertia about the centre of gravity for a uniform density in kg/m³.
    #[must_use]
    pub fn mass_properties(&self, density: f64) -> MassProperties {
        let m = self.moments();
        let upright = m.along - m.first * m.first / m.volume;
        MassProperties {
            mass: m.volume * density,
            inertia: DVec3::new(m.across + upright, m.across + upright, 2.0 * m.across) * density,
        }
    }

    /// By slices: with radius `r(z)` the volume is `∫ π r² dz`, and so on. Along the side, `r` is linear; at the rims,
    /// it is an arc of the rounding.
    fn moments(&self) -> Moments {
        let Discs { heights, radii, normal, length, .. } = self.core;
        let mut sum = Moments::default();
        let turn = math::atan2(normal[1], normal[0]);
        for (k, [from, to]) in [[-FRAC_PI_2, turn], [turn, FRAC_PI_2]].into_iter().enumerate() {
            sum.slices(|s| {
                let (sin, cos) = math::sin_cos(from + (to - from) * s);
                let r = self.rounding;
                (heights[k] + r * sin, radii[k] + r * cos, r * cos * (to - from))
            });
        }
        if length > 0.0 {
            let at = |k: usize| [radii[k] + self.rounding * normal[0], heights[k] + self.rounding * normal[1]];
            let ([r0, z0], [r1, z1]) = (at(0), at(1));
            sum.slices(|s| (z0 + (z1 - z0) * s, r0 + (r1 - r0) * s, z1 - z0));
        }
        sum
    }
}

/// Moments of unit density about its own origin: `∫ dV`, `∫ z dV`, `∫ z² dV` and `∫ x² dV`.
#[derive(Debug, Clone, Copy, Default)]
struct Moments {
    volume: f64,
    first: f64,
    along: f64,
    across: f64,
}

impl Moments {
    /// Adds slices: `at` gives height, radius and the height's rate at a fraction in [0, 1] of the way. Gauss–Legendre
    /// with eight points on four parts: exact to rounding for arcs and lines.
    fn slices(&mut self, at: impl Fn(f64) -> (f64, f64, f64)) {
        const PARTS: usize = 4;
        for part in 0..PARTS {
            for [x, w] in NODES.into_iter().flat_map(|[x, w]| [[-x, w], [x, w]]) {
                let (z, r, rate) = at((part as f64 + 0.5 * (1.0 + x)) / PARTS as f64);
                let disc = PI * r * r * rate * (0.5 * w / PARTS as f64);
                self.volume += disc;
                self.first += z * disc;
                self.along += z * z * disc;
                self.across += 0.25 * r * r * disc;
            }
        }
    }
}

/// Nodes of Gauss–Legendre's rule with eight points, and their weights.
const NODES: [[f64; 2]; 4] = [
    [0.183_434_642_495_649_8, 0.362_683_783_378_362],
    [0.525_532_409_916_329, 0.313_706_645_877_887_27],
    [0.796_666_477_413_626_7, 0.222_381_034_453_374_48],
    [0.960_289_856_497_536_3, 0.101_228_536_290_376_26],
];

impl Discs {
    /// Two discs, the lower first.
    pub(crate) fn new(heights: [f64; 2], radii: [f64; 2]) -> Self {
        let (r, z) = (radii[1] - radii[0], heights[1] - heights[0]);
        let length = (r * r + z * z).sqrt();
        let (normal, along) =
            if length > 0.0 { ([z / length, -r / length], [r / length, z / length]) } else { ([1.0, 0.0], [0.0, 1.0]) };
        Self { heights, radii, normal, along, length }
    }

    /// Unit normal out of the core at its point nearest to `p`, and the distance of `p` from that point; negative
    /// inside.
    #[inline]
    pub(crate) fn project(&self, p: DVec3) -> (DVec3, f64) {
        let [r0, r1] = self.radii;
        let [z0, z1] = self.heights;
        let flat = (p.x * p.x + p.y * p.y).sqrt();
        let (below, above) = (z0 - p.z, p.z - z1);
        let (out, up) = (flat - r0, p.z - z0);
        let beside = if self.length > 0.0 { self.normal[0] * out + self.normal[1] * up } else { f64::NEG_INFINITY };
        let in_plane = |[r, z]: [f64; 2]| {
            let away = if flat > 0.0 { DVec3::new(p.x / flat, p.y / flat, 0.0) } else { DVec3::X };
            DVec3::new(away.x * r, away.y * r, z)
        };
        if below > 0.0 && flat <= r0 {
            return (DVec3::NEG_Z, below);
        }
        if above > 0.0 && flat <= r1 {
            return (DVec3::Z, above);
        }
        if below <= 0.0 && above <= 0.0 && beside <= 0.0 && (self.length > 0.0 || flat <= r0) {
            // Inside, the way out is the shortest one.
            return if beside >= below && beside >= above {
                (in_plane(self.normal), beside)
            } else if above >= below {
                (DVec3::Z, above)
            } else {
                (DVec3::NEG_Z, below)
            };
        }
        let along = self.along[0] * out + self.along[1] * up;
        if beside > 0.0 && along > 0.0 && along < self.length {
            return (in_plane(self.normal), beside);
        }
        let to = |k: usize| [flat - self.radii[k], p.z - self.heights[k]];
        let ([a, b], [c, d]) = (to(0), to(1));
        let (first, second) = (a * a + b * b, c * c + d * d);
        let (offset, square) = if first <= second { ([a, b], first) } else { ([c, d], second) };
        let distance = square.sqrt();
        if distance > 0.0 {
            (in_plane([offset[0] / distance, offset[1] / distance]), distance)
        } else {
            (in_plane(self.normal), 0.0)
        }
    }

    /// How far the core reaches in a direction.
    #[inline]
    pub(crate) fn support(&self, d: DVec3) -> f64 {
        let flat = (d.x * d.x + d.y * d.y).sqrt();
        (self.heights[0] * d.z + self.radii[0] * flat).max(self.heights[1] * d.z + self.radii[1] * flat)
    }

    /// The point of the core that is farthest in a direction.
    pub(crate) fn farthest(&self, d: DVec3) -> DVec3 {
        let flat = (d.x * d.x + d.y * d.y).sqrt();
        let bounding_radius = |k: usize| self.heights[k] * d.z + self.radii[k] * flat;
        let k = usize::from(bounding_radius(1) > bounding_radius(0));
        let (x, y) = if flat > 0.0 { (d.x / flat, d.y / flat) } else { (0.0, 0.0) };
        DVec3::new(x * self.radii[k], y * self.radii[k], self.heights[k])
    }

    /// Largest distance of a point from the origin.
    pub(crate) fn reach(&self) -> f64 {
        let corner = |k: usize| (self.heights[k] * self.heights[k] + self.radii[k] * self.radii[k]).sqrt();
        corner(0).max(corner(1))
    }

    /// A point of a rim. Slot 0 is the point that is farthest in the direction `down`, if there is a unique one; the
    /// other slots are fixed. A rim without radius has one slot.
    pub(crate) fn rim(&self, ring: usize, slot: u8, down: DVec3) -> Option<DVec3> {
        let (r, z) = (self.radii[ring], self.heights[ring]);
        let at = |x: f64, y: f64| Some(DVec3::new(x * r, y * r, z));
        if r == 0.0 {
            return if slot == 0 { at(0.0, 0.0) } else { None };
        }
        match slot {
            0 => {
                let flat = (down.x * down.x + down.y * down.y).sqrt();
                if flat > LEVEL { at(down.x / flat, down.y / flat) } else { None }
            }
            1 => at(1.0, 0.0),
            2 => at(0.0, 1.0),
            3 => at(-1.0, 0.0),
            _ => at(0.0, -1.0),
        }
    }

    /// Sine of the side's normal against the plane across the axis: positive if it points up.
    pub(crate) fn slope(&self) -> Option<f64> {
        (self.length > 0.0 && (self.radii[0] > 0.0 || self.radii[1] > 0.0)).then_some(self.normal[1])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn moments_are_those_of_textbooks() {
        let close = |a: f64, b: f64| assert!((a / b - 1.0).abs() < 1e-12, "{a} for {b}");
        let (r, h) = (0.7, 1.9);
        let cylinder = Frustum::cylinder(r, h).unwrap().mass_properties(2.0);
        close(cylinder.mass, 2.0 * PI * r * r * h);
        close(cylinder.inertia.z, cylinder.mass * r * r / 2.0);
        close(cylinder.inertia.x, cylinder.mass * (3.0 * r * r + h * h) / 12.0);
        let solid = Frustum::cone(r, h).unwrap();
        let cone = solid.mass_properties(2.0);
        close(cone.mass, 2.0 * PI * r * r * h / 3.0);
        close(solid.balance() + 0.5 * h, h / 4.0);
        close(cone.inertia.z, 0.3 * cone.mass * r * r);
        close(cone.inertia.x, cone.mass * (0.15 * r * r + 3.0 / 80.0 * h * h));
        let ball = Frustum::capsule(r, 0.0).unwrap().mass_properties(2.0);
        close(ball.mass, 2.0 * 4.0 / 3.0 * PI * r * r * r);
        close(ball.inertia.x, 0.4 * ball.mass * r * r);
        let capsule = Frustum::capsule(r, h).unwrap().mass_properties(1.0);
        let (tube, ends) = (PI * r * r * h, 4.0 / 3.0 * PI * r * r * r);
        close(capsule.mass, tube + ends);
        close(capsule.inertia.z, 0.5 * tube * r * r + 0.4 * ends * r * r);
    }

    /// Compared with the support function: the projection's plane holds the core, and the projection is on it.
    #[test]
    fn feet_are_on_the_skin() {
        let mut seed = 3_u64;
        let mut next = || {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (seed >> 11) as f64 / (1_u64 << 53) as f64
        };
        for (radii, height) in
            [([0.5, 0.5], 1.0), ([0.5, 0.0], 0.8), ([0.3, 0.9], 0.2), ([0.0, 0.0], 1.0), ([0.6, 0.6], 0.0)]
        {
            let core = Discs::new([-0.4 * height, 0.6 * height], radii);
            let (mut inside, mut outside) = (0, 0);
            for _ in 0..2000 {
                let p = DVec3::new(next() - 0.5, next() - 0.5, next() - 0.5) * 3.0;
                let (normal, distance) = core.project(p);
                assert!((normal.length() - 1.0).abs() < 1e-14);
                let plane = core.support(normal) + distance - normal.dot(p);
                if distance > 0.0 {
                    outside += 1;
                    assert!(plane.abs() < 1e-13, "{p}: {plane}");
                    assert!(core.project(p - normal * distance).1.abs() < 1e-13);
                } else {
                    inside += 1;
                    assert!(plane.abs() < 1e-13 && core.project(p - normal * (distance * 1.001)).1 > 0.0);
                }
            }
            assert!(outside > 100 && (inside > 5 || height * radii[0] == 0.0), "{inside} {outside}");
        }
    }

    #[test]
    fn a_solid_without_volume_is_refused() {
        assert!(Frustum::cylinder(0.0, 1.0).is_err());
        assert!(Frustum::cylinder(1.0, 0.0).is_err());
        assert!(Frustum::cone(-1.0, 1.0).is_err());
        assert!(Frustum::capsule(f64::NAN, 1.0).is_err());
    }
}

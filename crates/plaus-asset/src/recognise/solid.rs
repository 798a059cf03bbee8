//! Balls, boxes, cylinders, cones and capsules about their own middles.

use glam::DVec3;
use plaus_dist::math::hypot;
use std::f64::consts::{FRAC_1_SQRT_2, PI};

/// How deep below a round surface a face between corners on it may lie, as a share of the radius. On straight sides
/// that is a prism of 8 sides (0.076; one of 7 has 0.099); in two directions it is a ball of 8 by 4 faces (0.137; a die
/// of 20 faces has 0.205).
const CHORD: f64 = 0.08;
const ROUND_CHORD: f64 = 0.15;

/// Directions in which round surfaces are looked at.
const AROUND: u32 = 8;

/// A shape that the simulator has a closed form for, about its own middle; round ones but the ball have their axis
/// along z. Lengths are in the unit of the mesh.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Solid {
    /// A ball.
    Ball {
        /// Its radius.
        radius: f64,
    },
    /// A box.
    Box {
        /// Its edges.
        size: DVec3,
    },
    /// A cylinder.
    Cylinder {
        /// Its radius.
        radius: f64,
        /// The distance between its ends.
        height: f64,
    },
    /// A cone whose tip points to +z, with the origin half-way up.
    Cone {
        /// The radius of its base.
        radius: f64,
        /// The distance from base to tip.
        height: f64,
    },
    /// A capsule.
    Capsule {
        /// Its radius.
        radius: f64,
        /// The distance between the centres of its ends.
        length: f64,
    },
}

/// A point of a solid's surface, and how far the mesh may be from it.
pub(super) type Sample = (DVec3, f64);

impl Solid {
    /// What it is called in a scenario.
    #[must_use]
    pub fn name(&self) -> &'static str {
        match self {
            Self::Ball { .. } => "ball",
            Self::Box { .. } => "box",
            Self::Cylinder { .. } => "cylinder",
            Self::Cone { .. } => "cone",
            Self::Capsule { .. } => "capsule",
        }
    }

    /// Its volume.
    #[must_use]
    pub fn volume(&self) -> f64 {
        match *self {
            Self::Ball { radius } => 4.0 / 3.0 * PI * radius * radius * radius,
            Self::Box { size } => size.element_product(),
            Self::Cylinder { radius, height } => PI * radius * radius * height,
            Self::Cone { radius, height } => PI * radius * radius * height / 3.0,
            Self::Capsule { radius, length } => PI * radius * radius * (length + 4.0 / 3.0 * radius),
        }
    }

    /// Its least extent.
    #[must_use]
    pub fn least(&self) -> f64 {
        match *self {
            Self::Ball { radius } | Self::Capsule { radius, .. } => 2.0 * radius,
            Self::Box { size } => size.min_element(),
            Self::Cylinder { radius, height } | Self::Cone { radius, height } => height.min(2.0 * radius),
        }
    }

    /// How far outside its surface a point is; a negative number inside, in a cone a bound.
    pub(super) fn distance(&self, point: DVec3) -> f64 {
        let wide = hypot(point.x, point.y);
        let outside = |over: DVec3| over.max(DVec3::ZERO).length() + over.max_element().min(0.0);
        match *self {
            Self::Ball { radius } => point.length() - radius,
            Self::Box { size } => outside(point.abs() - 0.5 * size),
            Self::Cylinder { radius, height } => {
                let over = DVec3::new(wide - radius, point.z.abs() - 0.5 * height, f64::NEG_INFINITY);
                outside(over)
            }
            Self::Cone { radius, height } => {
                let side = (wide * height + (point.z - 0.5 * height) * radius) / hypot(height, radius);
                side.max(-0.5 * height - point.z)
            }
            Self::Capsule { radius, length } => {
                hypot(wide, point.z - point.z.clamp(-0.5 * length, 0.5 * length)) - radius
            }
        }
    }

    /// How deep below its surface a face between corners on it may lie.
    pub(super) fn chord(&self) -> f64 {
        match *self {
            Self::Box { .. } => 0.0,
            Self::Cylinder { radius, .. } => CHORD * radius,
            Self::Cone { radius, height } => CHORD * radius * height / hypot(height, radius),
            Self::Ball { radius } | Self::Capsule { radius, .. } => ROUND_CHORD * radius,
        }
    }

    /// Points of its surface at which there must be a mesh within the tolerance, and where it is round within that and
    /// a chord: edges, corners and tips, which bevels would cut off, and the middles of faces, of which none may lack.
    /// Edges are looked at where the mesh has corners on them: `rims` are directions from the axis to some.
    pub(super) fn samples(&self, rims: &[DVec3], tolerance: f64) -> Vec<Sample> {
        let chord = tolerance + self.chord();
        let ring = |radius: f64, z: f64, off: f64| {
            (0..AROUND).map(move |k| {
                let quarter = [DVec3::X, DVec3::Y, DVec3::NEG_X, DVec3::NEG_Y];
                let [a, b] = [quarter[k as usize / 2], quarter[(k as usize / 2 + 1) % 4]];
                let way = if k % 2 == 0 { a } else { FRAC_1_SQRT_2 * (a + b) };
                (radius * way + z * DVec3::Z, off)
            })
        };
        let disc = |radius: f64, z: f64| {
            let rims = rims.iter().map(move |&rim| (radius * rim + z * DVec3::Z, tolerance));
            ring(0.5 * radius, z, tolerance).chain([(z * DVec3::Z, tolerance)]).chain(rims).collect::<Vec<_>>()
        };
        match *self {
            Self::Ball { radius } => {
                let low = FRAC_1_SQRT_2 * radius;
                let rings = [-1.0, 1.0].into_iter().flat_map(|side| ring(low, side * low, chord));
                let poles = [-1.0, 1.0].map(|side| (side * radius * DVec3::Z, chord));
                ring(radius, 0.0, chord).chain(rings).chain(poles).collect()
            }
            Self::Box { size } => {
                let signs = [-0.5, 0.0, 0.5];
                let all = signs.into_iter().flat_map(|x| {
                    signs.into_iter().flat_map(move |y| signs.into_iter().map(move |z| DVec3::new(x, y, z)))
                });
                all.filter(|at| *at != DVec3::ZERO).map(|at| (at * size, tolerance)).collect()
            }
            Self::Cylinder { radius, height } => {
                let sides = [-0.25, 0.0, 0.25].into_iter().flat_map(|share| ring(radius, share * height, chord));
                let ends = [-0.5, 0.5].into_iter().flat_map(|share| disc(radius, share * height));
                sides.chain(ends).collect()
            }
            Self::Cone { radius, height } => {
                let side = |share: f64| {
                    let less = 0.5 - share;
                    ring(less * radius, share * height, tolerance + less * self.chord())
                };
                let sides = [-0.25, 0.0, 0.25].into_iter().flat_map(side);
                let tip = [(0.5 * height * DVec3::Z, tolerance)];
                sides.chain(disc(radius, -0.5 * height)).chain(tip).collect()
            }
            Self::Capsule { radius, length } => {
                let sides = [-0.5, 0.0, 0.5].into_iter().flat_map(|share| ring(radius, share * length, chord));
                let low = FRAC_1_SQRT_2 * radius;
                let ends = [-1.0, 1.0].into_iter().flat_map(|side| {
                    ring(low, side * (0.5 * length + low), chord)
                        .chain([(side * (0.5 * length + radius) * DVec3::Z, chord)])
                });
                sides.chain(ends).collect()
            }
        }
    }
}

//! Shapes of bodies.

use super::look::Look;
use glam::DVec3;
use serde::{Deserialize, Serialize};

/// The shape of a body about its origin, in metres.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Shape {
    /// A ball.
    Sphere {
        /// Radius.
        radius: f64,
        /// Whether it has finger holes about its third axis, which make its rotation visible.
        holes: bool,
    },
    /// A coin whose faces point along the third axis: a ball in a two-dimensional world.
    Disc {
        /// Radius.
        radius: f64,
        /// From face to face.
        thickness: f64,
    },
    /// A box.
    Cuboid {
        /// Half its lengths along the body's axes.
        half: DVec3,
        /// Pips on the faces +x, −x, +y, −y, +z, −z, if it is a die.
        pips: Option<[u8; 6]>,
    },
    /// A body of revolution about its third axis: a bowling pin.
    Revolution {
        /// Points (distance from the axis, height along it) from the lowest height to the highest; the body is closed
        /// at both ends.
        profile: Vec<[f64; 2]>,
        /// Painted rings.
        stripes: Vec<Stripe>,
    },
    /// A polyhedron, or several joined into one body: the simulated body is convex, or made of convex pieces.
    Solid {
        /// Corners.
        vertices: Vec<DVec3>,
        /// Three corners each, counter-clockwise as seen from outside.
        triangles: Vec<[u32; 3]>,
    },
}

/// A painted ring of a body of revolution.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Stripe {
    /// Height along the axis where it begins, in metres.
    pub from: f64,
    /// Where it ends.
    pub to: f64,
    /// Its paint.
    pub look: Look,
}

impl Shape {
    /// A plain ball.
    #[must_use]
    pub const fn ball(radius: f64) -> Self {
        Self::Sphere { radius, holes: false }
    }

    /// A die's pips on the faces +x, −x, +y, −y, +z, −z: opposite faces add up to seven.
    pub const PIPS: [u8; 6] = [3, 4, 2, 5, 1, 6];

    /// A die with the usual [pips](Self::PIPS).
    #[must_use]
    pub fn die(edge: f64) -> Self {
        Self::Cuboid { half: DVec3::splat(0.5 * edge), pips: Some(Self::PIPS) }
    }

    /// The point of the body that lies farthest in a direction, in the body's frame.
    #[must_use]
    pub fn support(&self, direction: DVec3) -> DVec3 {
        let across = direction.with_z(0.0).normalize_or_zero();
        match self {
            Self::Sphere { radius, .. } => direction.normalize_or_zero() * *radius,
            Self::Disc { radius, thickness } => across * *radius + DVec3::Z * (0.5 * thickness).copysign(direction.z),
            Self::Cuboid { half, .. } => *half * direction.signum(),
            Self::Revolution { profile, .. } => {
                let points = profile.iter().map(|&[r, h]| across * r + DVec3::Z * h);
                points.max_by(|a, b| a.dot(direction).total_cmp(&b.dot(direction))).unwrap_or_default()
            }
            Self::Solid { vertices, .. } => {
                let points = vertices.iter().copied();
                points.max_by(|a, b| a.dot(direction).total_cmp(&b.dot(direction))).unwrap_or_default()
            }
        }
    }

    /// Radius of the smallest ball about the origin that holds the body.
    #[must_use]
    pub fn reach(&self) -> f64 {
        match self {
            Self::Sphere { radius, .. } => *radius,
            Self::Disc { radius, thickness } => DVec3::new(*radius, 0.5 * thickness, 0.0).length(),
            Self::Cuboid { half, .. } => half.length(),
            Self::Revolution { profile, .. } => {
                profile.iter().map(|&[r, h]| DVec3::new(r, h, 0.0).length()).fold(0.0, f64::max)
            }
            Self::Solid { vertices, .. } => vertices.iter().map(|vertex| vertex.length()).fold(0.0, f64::max),
        }
    }
}

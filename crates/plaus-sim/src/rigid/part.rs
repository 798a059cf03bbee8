//! What stands still: half spaces, boxes, and tables with a spline surface.

use super::glide::Stretch;
use crate::error::WorldError;
use crate::field::Spline;
use crate::material::{Law, Material};
use crate::scenery::{Aabb, Plane};
use glam::DVec3;

/// A fixed part of the world.
#[derive(Debug, Clone)]
pub enum Part {
    /// Everything behind a plane is solid.
    Plane(Plane),
    /// A solid box with edges along the axes.
    Block {
        /// Its extent.
        bounds: Aabb,
        /// What it is made of.
        material: Material,
        /// Stretches along y whose friction is not the material's, in ascending order; empty for none.
        stretches: Vec<Stretch>,
    },
    /// A table with an uneven surface.
    Table(Box<Table>),
}

/// A surface `z = height(x, y)`, solid below.
#[derive(Debug, Clone)]
pub struct Table {
    /// Height in m.
    pub height: Spline,
    /// Restitution over the table, where it is not the material's; its range lies in [0, 1].
    pub restitution: Option<Spline>,
    /// Friction over the table, where it is not the material's; its range lies in [0, ∞).
    pub friction: Option<Spline>,
    /// What it is made of.
    pub material: Material,
}

/// Where a point stands to a part: unit normal towards the point and distance, negative inside.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Foot {
    pub(crate) normal: DVec3,
    pub(crate) distance: f64,
}

impl Table {
    /// A table whose restitution and friction are those of its material.
    #[must_use]
    pub fn new(height: Spline, material: Material) -> Self {
        Self { height, restitution: None, friction: None, material }
    }

    pub(crate) fn fields(&self) -> impl Iterator<Item = &Spline> {
        std::iter::once(&self.height).chain(&self.restitution).chain(&self.friction)
    }

    pub(crate) fn check(&self) -> Result<(), WorldError> {
        for (field, most, expected) in [
            (&self.restitution, 1.0, "a field with values in [0, 1]"),
            (&self.friction, f64::INFINITY, "a field with values in [0, ∞)"),
        ] {
            if let Some(field) = field {
                for value in field.range() {
                    if !(0.0..=most).contains(&value) {
                        return Err(WorldError::BadSurface {
                            surface: "table".into(),
                            field: "range of a field",
                            value,
                            expected,
                        });
                    }
                }
            }
        }
        self.fields().find_map(Spline::fault).map_or(Ok(()), Err)
    }

    /// The foot of the perpendicular for a point near the surface. A ball's centre needs a few rounds, a corner on the surface none.
    #[inline]
    pub(crate) fn foot(&self, p: DVec3, rounds: usize) -> Foot {
        let (mut x, mut y) = (p.x, p.y);
        let mut foot = Foot { normal: DVec3::Z, distance: 0.0 };
        for _ in 0..=rounds {
            let s = self.height.at(x, y);
            let normal = DVec3::new(-s.slope[0], -s.slope[1], 1.0);
            let normal = normal / normal.length();
            foot = Foot { normal, distance: normal.dot(p - DVec3::new(x, y, s.value)) };
            (x, y) = (p.x - normal.x * foot.distance, p.y - normal.y * foot.distance);
        }
        foot
    }

    #[inline]
    pub(crate) fn law(&self, p: DVec3, law: &Law) -> Law {
        let friction = self.friction.as_ref().map_or(law.friction, |f| f.value(p.x, p.y));
        let restitution = self.restitution.as_ref().map_or(law.restitution, |f| f.value(p.x, p.y));
        // Values lie in the fields' ranges but for rounding.
        Law { friction: friction.max(0.0), restitution: restitution.clamp(0.0, 1.0), ..*law }
    }
}

/// How far the length of a plane's normal may be from 1: rounding.
const UNIT: f64 = 1e-12;

/// Rounds of [`Table::foot`] for a ball: each reduces the error by the ratio of its radius to the surface's radius of curvature.
pub(crate) const ROUNDS: usize = 4;

impl Part {
    pub(crate) fn material(&self) -> Material {
        match self {
            Self::Plane(plane) => plane.material,
            Self::Block { material, .. } => *material,
            Self::Table(table) => table.material,
        }
    }

    /// Checks the numbers of the part with this index.
    pub(crate) fn check(&self, index: usize) -> Result<(), WorldError> {
        let bad = |field, value, expected| {
            Err(WorldError::BadSurface { surface: format!("part {index}"), field, value, expected })
        };
        match self {
            Self::Plane(plane) => {
                let length = plane.normal.length();
                if (length - 1.0).abs() > UNIT || length.is_nan() {
                    return bad("length of the normal", length, "1");
                }
                if !plane.offset.is_finite() {
                    return bad("offset", plane.offset, "a finite number");
                }
                Ok(())
            }
            Self::Block { bounds, stretches, .. } => {
                for axis in 0..3 {
                    let (low, high) = (bounds.min[axis], bounds.max[axis]);
                    if low.is_nan() || high.is_nan() || low >= high {
                        return bad("extent along an axis", high - low, "a positive length");
                    }
                }
                let mut last = f64::NEG_INFINITY;
                for s in stretches {
                    if s.from.is_nan() || s.from < last {
                        return bad("begin of a stretch", s.from, "ascending numbers");
                    }
                    if !(s.friction >= 0.0 && s.friction.is_finite()) {
                        return bad("friction of a stretch", s.friction, "a number from 0 on");
                    }
                    last = s.from;
                }
                Ok(())
            }
            Self::Table(table) => table.check(),
        }
    }

    /// Where the centre of a ball of this radius stands.
    #[inline]
    pub(crate) fn foot(&self, p: DVec3, radius: f64) -> Foot {
        match self {
            Self::Plane(plane) => Foot { normal: plane.normal, distance: plane.distance(p) },
            Self::Block { bounds, .. } => block_foot(bounds, p),
            Self::Table(table) => table.foot(p, if radius > 0.0 { ROUNDS } else { 0 }),
        }
    }

    /// Whether any field of it was given a bad value.
    pub(crate) fn fault(&self) -> Option<WorldError> {
        match self {
            Self::Table(table) => table.fields().find_map(Spline::fault),
            _ => None,
        }
    }

    pub(crate) fn is_faulty(&self) -> bool {
        match self {
            Self::Table(table) => table.fields().any(Spline::is_faulty),
            _ => false,
        }
    }
}

fn block_foot(bounds: &Aabb, p: DVec3) -> Foot {
    let nearest = p.clamp(bounds.min, bounds.max);
    let offset = p - nearest;
    let distance = offset.length();
    if distance > 0.0 {
        return Foot { normal: offset / distance, distance };
    }
    // Inside: out through the nearest side.
    let mut foot = Foot { normal: DVec3::Z, distance: f64::NEG_INFINITY };
    for axis in 0..3 {
        for (depth, sign) in [(p[axis] - bounds.max[axis], 1.0), (bounds.min[axis] - p[axis], -1.0)] {
            if depth > foot.distance {
                foot = Foot { normal: DVec3::AXES[axis] * sign, distance: depth };
            }
        }
    }
    foot
}

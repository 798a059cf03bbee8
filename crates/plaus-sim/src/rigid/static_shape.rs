//! Fixed parts: half spaces, boxes, tables with a spline surface, solids of any shape at any angle, triangle meshes,
//! and curved tracks.

use super::tolerances::{NORMAL_LENGTH_ERROR, PROJECTION_ROUNDS, RING_EDGE_ROUNDS, RING_EDGE_STEPS};
use crate::error::{SurfaceId, WorldError};
use crate::field::Spline;
use crate::material::{Law, Laws, Material};
use crate::motion::Parabola;
use crate::scenery::{Aabb, ArcTrack, Mesh, Plane, Surface};
use crate::shape::{Ring, Shape};
use glam::{DMat3, DQuat, DVec3};
use std::f64::consts::FRAC_1_SQRT_2;
use std::sync::Arc;

/// A fixed part of the world.
#[derive(Debug, Clone)]
pub enum StaticShape {
    /// Everything behind a plane is solid.
    Plane(Plane),
    /// A solid box with edges along the axes.
    Block {
        /// Its extent.
        bounds: Aabb,
        /// What it is made of.
        material: Material,
        /// Sections along y with a friction of their own, in ascending order; empty for none.
        sections: Vec<Section>,
    },
    /// A table with an uneven surface.
    Table(Box<Table>),
    /// Any fixed shape, at any angle.
    Solid(Box<StaticSolid>),
    /// A triangle mesh, solid behind its faces. Their corners run anticlockwise as seen from outside, and each triangle
    /// has its material. It need not be closed. Edges between triangles in one plane are not felt.
    Mesh(Arc<Mesh>),
    /// A curved track: the inside of an arc of a cylinder, exactly, with convex pieces behind it.
    Arc(Arc<ArcTrack>),
}

/// A section of a part along y with a friction of its own; it ends where the next begins.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Section {
    /// Where it begins, in m.
    pub from: f64,
    /// Coulomb's coefficient there; `None` for that of the materials.
    pub friction: Option<f64>,
}

/// A fixed shape.
#[derive(Debug, Clone)]
pub struct StaticSolid {
    /// The shape about its centre of gravity.
    pub shape: Shape,
    /// Position of the centre of gravity, in m.
    pub at: DVec3,
    /// Turns the shape's axes into world axes.
    pub turn: DQuat,
    /// What it is made of.
    pub material: Material,
}

/// A surface `z = height(x, y)`, solid below; x, y and z are those of the world unless it is [slanted](Self::slanted).
#[derive(Debug, Clone)]
pub struct Table {
    /// Height in m.
    pub height: Spline,
    /// Restitution over the table, if not the material's; its range lies in [0, 1].
    pub restitution: Option<Spline>,
    /// Friction over the table, if not the material's; its range lies in [0, ∞).
    pub friction: Option<Spline>,
    /// What it is made of.
    pub material: Material,
    slant: Option<Slant>,
}

/// The axes along which a table's surface is given, where these are not the world's.
#[derive(Debug, Clone, Copy)]
struct Slant {
    origin: DVec3,
    /// Turns these axes into those of the world, and back.
    turn: DMat3,
    back: DMat3,
}

/// The position of a point relative to a part: unit normal towards the point and distance, negative inside.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Projection {
    pub(crate) normal: DVec3,
    pub(crate) distance: f64,
}

impl Table {
    /// A table whose restitution and friction are those of its material.
    #[must_use]
    pub fn new(height: Spline, material: Material) -> Self {
        Self { height, restitution: None, friction: None, material, slant: None }
    }

    /// The same at any angle: its fields are over x and y of axes that `turn` turns into the world's, about an origin
    /// at `at` in m.
    #[must_use]
    pub fn slanted(self, at: DVec3, turn: DQuat) -> Self {
        let turn = DMat3::from_quat(turn.normalize());
        Self { slant: Some(Slant { origin: at, turn, back: turn.transpose() }), ..self }
    }

    /// A place along the table's axes.
    #[inline]
    pub(crate) fn place(&self, p: DVec3) -> DVec3 {
        self.slant.map_or(p, |slant| slant.back * (p - slant.origin))
    }

    /// A direction along the table's axes.
    #[inline]
    pub(crate) fn way(&self, way: DVec3) -> DVec3 {
        self.slant.map_or(way, |slant| slant.back * way)
    }

    /// A body's axes along the table's.
    #[inline]
    pub(crate) fn axes(&self, r: DMat3) -> DMat3 {
        self.slant.map_or(r, |slant| slant.back * r)
    }

    /// The table's upward direction.
    #[inline]
    pub(crate) fn up(&self) -> DVec3 {
        self.slant.map_or(DVec3::Z, |slant| slant.turn.z_axis)
    }

    /// How far the table's origin lies along its upward direction, in m.
    pub(crate) fn level(&self) -> f64 {
        self.slant.map_or(0.0, |slant| slant.turn.z_axis.dot(slant.origin))
    }

    /// A motion along the table's axes.
    pub(crate) fn path(&self, path: &Parabola) -> Parabola {
        Parabola { t: path.t, x: self.place(path.x), v: self.way(path.v), a: self.way(path.a) }
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
                            surface: SurfaceId::Table,
                            field: "range of a field",
                            value,
                            expected,
                        });
                    }
                }
            }
        }
        let is_whole = |slant: &Slant| slant.origin.is_finite() && slant.turn.is_finite();
        if !self.slant.as_ref().is_none_or(is_whole) {
            return Err(WorldError::BadSurface {
                surface: SurfaceId::Table,
                field: "slant",
                value: f64::NAN,
                expected: "a place and a turn of finite numbers",
            });
        }
        self.fields().find_map(Spline::fault).map_or(Ok(()), Err)
    }

    /// The foot of the perpendicular for a point near the surface. A ball's centre needs a few rounds, and a corner on
    /// the surface needs none.
    #[inline]
    fn project(&self, p: DVec3, rounds: usize) -> Projection {
        let projection = self.own_projection(self.place(p), rounds);
        self.slant.map_or(projection, |slant| Projection { normal: slant.turn * projection.normal, ..projection })
    }

    /// The same along the table's axes.
    #[inline]
    pub(crate) fn own_projection(&self, p: DVec3, rounds: usize) -> Projection {
        let (mut x, mut y) = (p.x, p.y);
        let mut projection = Projection { normal: DVec3::Z, distance: 0.0 };
        for _ in 0..=rounds {
            let (value, slope) = self.height.slope_at(x, y);
            let normal = DVec3::new(-slope[0], -slope[1], 1.0);
            let normal = normal / normal.length();
            projection = Projection { normal, distance: normal.dot(p - DVec3::new(x, y, value)) };
            (x, y) = (p.x - normal.x * projection.distance, p.y - normal.y * projection.distance);
        }
        projection
    }

    #[inline]
    pub(crate) fn law(&self, p: DVec3, law: &Law) -> Law {
        let p = self.place(p);
        let law = self.friction.as_ref().map_or(*law, |f| law.rubbing(f.value(p.x, p.y)));
        let restitution = self.restitution.as_ref().map_or(law.restitution, |f| f.value(p.x, p.y));
        // Values lie in the fields' ranges, except for rounding.
        Law { friction: law.friction.max(0.0), restitution: restitution.clamp(0.0, 1.0), ..law }
    }
}

impl StaticShape {
    /// The material where the part is touched.
    #[inline]
    pub(crate) fn material(&self, surface: Surface) -> Material {
        match (self, surface) {
            (Self::Plane(plane), _) => plane.material,
            (Self::Block { material, .. }, _) => *material,
            (Self::Table(table), _) => table.material,
            (Self::Solid(solid), _) => solid.material,
            (Self::Mesh(mesh), Surface::Spot { piece, .. }) => mesh.faces[piece as usize].material,
            (Self::Mesh(_), _) => Material(0),
            (Self::Arc(arc), _) => arc.material,
        }
    }

    /// Checks the numbers of the part with this index.
    pub(crate) fn check(&self, index: usize, laws: &Laws) -> Result<(), WorldError> {
        match self {
            Self::Mesh(mesh) => return mesh.faces.iter().try_for_each(|f| laws.require(f.material)),
            _ => laws.require(self.material(Surface::Part { part: 0, point: 0 }))?,
        }
        let bad = |field, value, expected| {
            Err(WorldError::BadSurface { surface: SurfaceId::Part(index), field, value, expected })
        };
        match self {
            Self::Plane(plane) => {
                let length = plane.normal.length();
                if (length - 1.0).abs() > NORMAL_LENGTH_ERROR || length.is_nan() {
                    return bad("length of the normal", length, "1");
                }
                if !plane.offset.is_finite() {
                    return bad("offset", plane.offset, "a finite number");
                }
                Ok(())
            }
            Self::Block { bounds, sections, .. } => {
                for axis in 0..3 {
                    let (low, high) = (bounds.min[axis], bounds.max[axis]);
                    if low.is_nan() || high.is_nan() || low >= high {
                        return bad("extent along an axis", high - low, "a positive length");
                    }
                }
                let mut last = f64::NEG_INFINITY;
                for s in sections {
                    if s.from.is_nan() || s.from < last {
                        return bad("start of a section", s.from, "ascending numbers");
                    }
                    let friction = s.friction.unwrap_or(0.0);
                    if !(friction >= 0.0 && friction.is_finite()) {
                        return bad("friction of a section", friction, "a number of at least 0");
                    }
                    last = s.from;
                }
                Ok(())
            }
            Self::Table(table) => table.check(),
            Self::Solid(solid) => {
                if let Some(value) = solid.at.to_array().into_iter().find(|x| !x.is_finite()) {
                    return bad("place", value, "finite numbers");
                }
                let length = solid.turn.length();
                if length > 0.0 && length.is_finite() { Ok(()) } else { bad("length of its turn", length, "a turn") }
            }
            Self::Mesh(_) | Self::Arc(_) => Ok(()),
        }
    }

    /// The projection of the centre of a ball with this radius.
    #[inline]
    pub(crate) fn project(&self, p: DVec3, radius: f64) -> Projection {
        match self {
            Self::Plane(plane) => Projection { normal: plane.normal, distance: plane.distance(p) },
            Self::Block { bounds, .. } => project_on_box(bounds, p),
            Self::Table(table) => table.project(p, if radius > 0.0 { PROJECTION_ROUNDS } else { 0 }),
            Self::Arc(arc) => {
                let (normal, out) = arc.normal(p);
                Projection { normal, distance: arc.form().radius - out }
            }
            // Their pieces know.
            Self::Solid(_) | Self::Mesh(_) => Projection { normal: DVec3::Z, distance: f64::INFINITY },
        }
    }

    /// The fault, if one of its fields was given a bad value.
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

/// A side of a box, and how far a point is beyond it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct BoxSide {
    pub(crate) axis: usize,
    pub(crate) normal: DVec3,
    pub(crate) beyond: f64,
}

impl BoxSide {
    /// The side of a box at one end of an axis.
    fn of((axis, is_upper): (usize, bool), beyond: f64) -> Self {
        let e = DVec3::AXES[axis];
        Self { axis, normal: if is_upper { e } else { -e }, beyond }
    }
}

/// The side of a box that a point is farthest beyond; none if the point is inside.
pub(crate) fn farthest_side(bounds: &Aabb, x: DVec3) -> Option<BoxSide> {
    let ends = [(true, x - bounds.max), (false, bounds.min - x)];
    let (mut farthest, mut side) = (0.0, None);
    for axis in 0..3 {
        for (is_upper, beyond) in ends {
            if beyond[axis] > farthest {
                (farthest, side) = (beyond[axis], Some((axis, is_upper)));
            }
        }
    }
    side.map(|end| BoxSide::of(end, farthest))
}

/// A lower bound on the distance of a point from a box: its distance beyond the farthest side, negative inside.
pub(crate) fn distance_beyond(bounds: &Aabb, p: DVec3) -> f64 {
    (bounds.min - p).max(p - bounds.max).max_element()
}

/// Whether a point is within the edges of a side of a box.
pub(crate) fn is_over(bounds: &Aabb, axis: usize, p: DVec3) -> bool {
    (0..3).all(|k| k == axis || (p[k] >= bounds.min[k] && p[k] <= bounds.max[k]))
}

/// The direction that counts as up at the point of a ring that is nearest to a box. If that point is over the side that
/// the body is in front of, it is the side's normal. Otherwise it is found from the nearest of eight points.
pub(crate) fn up_at_ring(bounds: &Aabb, ring: &Ring, x: DVec3, r: &DMat3) -> DVec3 {
    let middle = x + r.z_axis * ring.height;
    if let Some(side) = farthest_side(bounds, x) {
        let flat = side.normal - r.z_axis * side.normal.dot(r.z_axis);
        if is_over(bounds, side.axis, middle - flat.normalize_or(r.x_axis) * ring.circle) {
            return side.normal;
        }
    }
    let (a, b) = (r.x_axis * ring.circle, r.y_axis * ring.circle);
    let (c, d) = ((a + b) * FRAC_1_SQRT_2, (a - b) * FRAC_1_SQRT_2);
    let place = |arm: DVec3| (arm, project_on_box(bounds, middle + arm));
    let from = [b, -a, -b, c, d, -c, -d]
        .map(place)
        .into_iter()
        .fold(place(a), |nearest, other| if other.1.distance < nearest.1.distance { other } else { nearest });
    let (arm, at) = down_ring(bounds, ring, [middle, r.z_axis], from);
    let across = DVec3::select(at.normal.cmpeq(DVec3::ZERO), DVec3::ONE, DVec3::ZERO);
    let edge = across - r.z_axis * r.z_axis.dot(across);
    if across.element_sum() == 1.0 && edge != DVec3::ZERO {
        // An edge across the ring has a second such point, mirrored at the line across the edge.
        let other = place(arm - edge * (2.0 * arm.dot(edge) / edge.length_squared()));
        let (other, there) = down_ring(bounds, ring, [middle, r.z_axis], other);
        if there.distance < at.distance {
            return -other;
        }
    }
    -arm
}

/// Follows a ring about this middle and axis to where it is nearest to a box, from a point at this arm from the middle;
/// with what it is from the box there. Newton's method for the square of the distance, as a function of the angle.
fn down_ring(bounds: &Aabb, ring: &Ring, [middle, axis]: [DVec3; 2], from: (DVec3, Projection)) -> (DVec3, Projection) {
    let (mut arm, mut at) = from;
    let mut longest = RING_EDGE_STEPS[1];
    for _ in 0..RING_EDGE_ROUNDS {
        let along = axis.cross(arm);
        // Along the axes in which the point is within the box, its way does not count.
        let counts = DVec3::select(at.normal.cmpeq(DVec3::ZERO), DVec3::ZERO, along).length_squared();
        let (slope, bend) = (at.normal.dot(along), -at.normal.dot(arm));
        let [slope, bend] =
            if at.distance > 0.0 { [slope * at.distance, counts + bend * at.distance] } else { [slope, bend] };
        let step = if bend > 0.0 { (slope / bend).min(longest).max(-longest) } else { longest.copysign(slope) };
        let next = (arm - along * step).normalize_or(arm) * ring.circle;
        let there = project_on_box(bounds, middle + next);
        if there.distance <= at.distance {
            (arm, at) = (next, there);
        } else {
            longest = 0.25 * step.abs();
        }
        if step.abs() <= RING_EDGE_STEPS[0] {
            break;
        }
    }
    (arm, at)
}

/// From a box to a point.
fn project_on_box(bounds: &Aabb, p: DVec3) -> Projection {
    let nearest = p.clamp(bounds.min, bounds.max);
    let offset = p - nearest;
    let distance = offset.length();
    if distance > 0.0 {
        return Projection { normal: offset / distance, distance };
    }
    // Inside, the way out is through the nearest side.
    let mut projection = Projection { normal: DVec3::Z, distance: f64::NEG_INFINITY };
    for axis in 0..3 {
        for (depth, sign) in [(p[axis] - bounds.max[axis], 1.0), (bounds.min[axis] - p[axis], -1.0)] {
            if depth > projection.distance {
                projection = Projection { normal: DVec3::AXES[axis] * sign, distance: depth };
            }
        }
    }
    projection
}

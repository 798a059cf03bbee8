//! Two convex polyhedra, each with a rounding: how far apart they are, where they are nearest, and all the points at
//! which they touch. A ball is a polyhedron with a single corner.
//!
//! The nearest features are named by a [`Feature`], whose exact geometry gives points, normal and gap at this and at
//! other poses.

mod edges;
mod manifold;
mod nearest;
#[cfg(test)]
mod tests;

use super::hull::{On, Polyhedron};
use glam::{DMat3, DVec3};

/// A polyhedron in its place.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Placed<'h> {
    /// Its axes in the world, as columns.
    pub(crate) axes: DMat3,
    pub(crate) core: &'h Polyhedron,
    /// Radius of the rounding around it, in m.
    pub(crate) rounding: f64,
}

/// Two polyhedra, with values that several queries share.
#[derive(Debug)]
pub(crate) struct HullPair<'h> {
    hulls: [Placed<'h>; 2],
    /// From the second centre to the first.
    offset: DVec3,
    /// Where each sees the other's centre, in its own axes.
    other: [DVec3; 2],
    /// Axes of the second in those of the first, as columns, and the transpose.
    across: [DMat3; 2],
    /// Both reaches together.
    size: f64,
}

/// The parts of two polyhedra that meet at a point of contact.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Feature {
    /// A corner of the polyhedron `of` (0 or 1) and what is nearest to it on the other.
    Corner { of: u8, corner: u8, on: On },
    /// An edge of each.
    Edges(u8, u8),
}

/// A point of contact, or of least distance.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Meeting {
    /// Unit normal towards the first.
    pub(crate) normal: DVec3,
    /// From each centre to its skin.
    pub(crate) arms: [DVec3; 2],
    pub(crate) gap: f64,
    pub(crate) feature: Feature,
}

/// Sine of the angle between edges below which they count as parallel. Default 1e-7: the crossing of edges more
/// parallel than that lies within 1e-7 of their length of their corners, and its normal would be exact to 1e-9 only.
const PARALLEL: f64 = 1e-7;

impl<'h> HullPair<'h> {
    /// Two polyhedra; `offset` points from the centre of the second to that of the first.
    #[inline]
    pub(crate) fn new(offset: DVec3, a: Placed<'h>, b: Placed<'h>) -> Self {
        let (ta, tb) = (a.axes.transpose(), b.axes.transpose());
        let across = ta * b.axes;
        let size = a.core.bounding_radius + b.core.bounding_radius;
        Self { hulls: [a, b], offset, other: [-(ta * offset), tb * offset], across: [across, across.transpose()], size }
    }

    /// Both roundings together, in m.
    pub(crate) fn roundings(&self) -> f64 {
        self.hulls[0].rounding + self.hulls[1].rounding
    }

    /// A corner of the polyhedron `of`, in the axes of the other about its centre.
    #[inline]
    fn corner_seen(&self, of: usize, corner: u8) -> DVec3 {
        self.other[1 - of] + self.across[1 - of] * self.hulls[of].core.corner(corner)
    }

    /// How far apart cores are along a direction in the world towards the first.
    fn apart(&self, direction: DVec3) -> f64 {
        let [a, b] = &self.hulls;
        let low = a.core.support(a.axes.transpose() * -direction);
        let high = b.core.support(b.axes.transpose() * direction);
        self.offset.dot(direction) - (low + high)
    }

    /// The meeting of core points `p` and `q` (about their centres) along a normal.
    fn meeting(&self, [p, q]: [DVec3; 2], normal: DVec3, distance: f64, feature: Feature) -> Meeting {
        let [a, b] = &self.hulls;
        let arms = [p - normal * a.rounding, q + normal * b.rounding];
        Meeting { normal, arms, gap: distance - self.roundings(), feature }
    }

    /// The meeting of a corner with a part of the other's surface, wherever they are now; also whether the projection
    /// is on that part.
    fn at_corner(&self, of: usize, corner: u8, on: On) -> (Meeting, bool) {
        let (own, other) = (&self.hulls[of], &self.hulls[1 - of]);
        let seen = self.corner_seen(of, corner);
        let (normal, distance, is_on) = project(other.core, seen, on);
        let p = own.axes * own.core.corner(corner);
        let feature = Feature::Corner { of: of as u8, corner, on };
        if let On::Corner(k) = on
            && distance > 0.0
        {
            // The same bits from both sides: neither corner takes precedence.
            let q = other.axes * other.core.corner(k);
            let points = if of == 0 { [p, q] } else { [q, p] };
            let between = self.offset + (points[0] - points[1]);
            let distance = between.length();
            return (self.meeting(points, between / distance, distance, feature), is_on);
        }
        let (q, normal) = (other.axes * (seen - normal * distance), other.axes * normal);
        let meeting = if of == 0 {
            self.meeting([p, q], normal, distance, feature)
        } else {
            self.meeting([q, p], -normal, distance, feature)
        };
        (meeting, is_on)
    }

    /// The same feature's point at this pose. `towards` is its normal at a pose nearby.
    pub(crate) fn again(&self, feature: Feature, towards: DVec3) -> Meeting {
        match feature {
            Feature::Corner { of, corner, on } => self.at_corner(usize::from(of), corner, on).0,
            Feature::Edges(a, b) => self.at_edges([a, b], towards).0,
        }
    }
}

/// From a part of a core's surface to a point: direction, distance, and whether the projection is on that part.
pub(crate) fn project(core: &Polyhedron, p: DVec3, on: On) -> (DVec3, f64, bool) {
    let above = |face: u8| core.face(face).normal.dot(p) - core.face(face).offset;
    let (away, is_on) = match on {
        On::Face(face) => return (core.face(face).normal, above(face), core.is_over(face, p, 0.0)),
        On::Edge(edge) => {
            let e = core.edge(edge);
            let along = core.along(edge, p);
            let at = core.corner(e.ends[0]) + e.along * along.clamp(0.0, e.length);
            (p - at, (0.0..=e.length).contains(&along))
        }
        On::Corner(corner) => (p - core.corner(corner), true),
    };
    // Among the faces that meet there, the one that the point is farthest beyond.
    let set = core.spanning(on);
    let mut top = (f64::NEG_INFINITY, DVec3::Z);
    for (k, face) in core.faces.iter().enumerate().filter(|(_, f)| f.set & set == set) {
        let beyond = above(k as u8);
        if beyond > top.0 {
            top = (beyond, face.normal);
        }
    }
    let length = away.length();
    if core.faces.is_empty() {
        return (if length > 0.0 { away / length } else { DVec3::Z }, length, is_on);
    }
    if length > 0.0 && (top.0 > 0.0 || !core.has_inside() && !core.is_over(0, p, 0.0)) {
        (away / length, length, is_on)
    } else {
        // Inside all of them, the way out is through the nearest.
        (top.1, top.0, is_on)
    }
}

//! A ball among the triangles of a mesh: where it touches them, and when it first does. Both are known in closed form,
//! as for marbles; the algorithm for convex pieces finds the same points far more slowly.

use super::contact_id::ContactId;
use super::contact_point::ContactPoint;
use super::static_collider::StaticCollider;
use crate::scenery::{Face, Mesh, Surface};
use crate::shape::On;
use crate::shape::convex_pair::{Mark, Meeting};
use crate::shape::hull_pair::Feature;
use glam::DVec3;

/// The name of what a ball touches on a triangle.
pub(crate) fn mark(on: On) -> Mark {
    Mark::Polyhedra(Feature::Corner { of: 0, corner: 0, on })
}

/// What a ball touches under this name.
pub(crate) fn on(mark: Mark) -> Option<On> {
    match mark {
        Mark::Polyhedra(Feature::Corner { of: 0, on, .. }) => Some(on),
        _ => None,
    }
}

/// A meeting of a ball with a part of a triangle, about the ball's centre.
fn meeting(on: On, normal: DVec3, distance: f64, radius: f64) -> Meeting {
    let points = [normal * -radius, normal * -distance];
    Meeting { normal, points, gap: distance - radius, mark: mark(on) }
}

/// From a triangle's corner, or from the line along its side, to `x`; and whether the projection is between the side's
/// ends.
pub(crate) fn offset(mesh: &Mesh, face: &Face, on: On, x: DVec3) -> (DVec3, bool) {
    let corner = |k: usize| mesh.vertices()[face.corners[k % 3] as usize];
    match on {
        On::Face(_) => (face.normal * (face.normal.dot(x) - face.offset), true),
        On::Corner(k) => (x - corner(usize::from(k)), true),
        On::Edge(side) => {
            let from = corner(usize::from(side));
            let (offset, way) = (x - from, corner(usize::from(side) + 1) - from);
            let part = offset.dot(way) / way.length_squared();
            (offset - way * part, part > 0.0 && part < 1.0)
        }
    }
}

impl StaticCollider {
    /// The nearest point of a triangle to a ball with its centre at `x`, if they are within `within` and the point is
    /// one of the mesh; about the ball's centre.
    pub(super) fn under_ball(&self, k: u32, x: DVec3, radius: f64, within: f64) -> Option<Meeting> {
        let mesh = self.mesh()?;
        let face = &mesh.faces[k as usize];
        let height = face.normal.dot(x) - face.offset;
        if height <= 0.0 || height - radius > within {
            return None;
        }
        if self.is_over(k, x, x) {
            return Some(meeting(On::Face(0), face.normal, height, radius));
        }
        let mut best = (On::Corner(0), DVec3::ZERO, f64::INFINITY);
        for side in 0..3 {
            for on in [On::Corner(side), On::Edge(side)] {
                let (offset, is_beside) = offset(mesh, face, on, x);
                if is_beside && offset.length_squared() < best.2 {
                    best = (on, offset, offset.length_squared());
                }
            }
        }
        let (on, offset, distance) = (best.0, best.1, best.2.sqrt());
        if distance - radius > within || distance == 0.0 {
            return None;
        }
        let found = meeting(on, offset / distance, distance, radius);
        self.has(k, &found, x, found.gap).then_some(found)
    }

    /// The point under this name, about the centre of a ball at `x`.
    pub(super) fn ball_again(&self, id: ContactId, x: DVec3, radius: f64) -> Option<Meeting> {
        let (mesh, on) = (self.mesh()?, on(id.mark)?);
        let face = &mesh.faces[id.other as usize];
        if on == On::Face(0) {
            return Some(meeting(on, face.normal, face.normal.dot(x) - face.offset, radius));
        }
        let offset = offset(mesh, face, on, x).0;
        let distance = offset.length_squared().sqrt();
        (distance > 0.0).then(|| meeting(on, offset / distance, distance, radius))
    }

    /// The triangle that a ball touches inside its sides, under this name.
    pub(crate) fn face_of(&self, id: ContactId) -> Option<u32> {
        (self.mesh().is_some() && on(id.mark) == Some(On::Face(0))).then_some(id.other)
    }

    /// The name under which a ball touches a side of a triangle.
    pub(crate) fn side(&self, k: u32, side: usize) -> ContactId {
        ContactId { own: 0, other: k, mark: mark(On::Edge(side as u8)) }
    }

    /// A ball, with its centre at `x`, on the plane of a triangle.
    pub(crate) fn face_under(&self, part: u16, k: u32, x: DVec3, radius: f64) -> ContactPoint {
        let (n, surface) = (self.normal(k), ContactId { own: 0, other: k, mark: mark(On::Face(0)) }.surface(part));
        let gap = self.mesh().map_or(f64::INFINITY, |mesh| n.dot(x) - mesh.faces[k as usize].offset - radius);
        ContactPoint { surface, part, arm: n * -radius, normal: n, gap }
    }

    /// The direction of the edge that a ball touches under this name, and the triangles at it.
    pub(crate) fn edge_under(&self, id: ContactId) -> Option<(DVec3, [Option<u32>; 2])> {
        let (mesh, On::Edge(side)) = (self.mesh()?, on(id.mark)?) else { return None };
        let edge = &mesh.edges[self.edge_of(id.other, usize::from(side))? as usize];
        Some((edge.direction, edge.faces))
    }

    /// The part of the mesh that a ball touches under this name.
    pub(crate) fn surface_of(&self, mesh: &Mesh, id: ContactId) -> Option<Surface> {
        let corners = mesh.faces[id.other as usize].corners;
        match on(id.mark)? {
            On::Face(_) => Some(Surface::Face(id.other)),
            On::Edge(side) => self.edge_of(id.other, usize::from(side)).map(Surface::Edge),
            On::Corner(k) => corners.get(usize::from(k)).map(|&c| Surface::Vertex(c)),
        }
    }
}

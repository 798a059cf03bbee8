//! Flat faces of fixed parts, which are half spaces to a body well over them: faces of a convex solid, and triangles of
//! a mesh that make up one convex face. There, closed forms find when the body comes down, and a face is one face
//! however many triangles it has. Faces that lie flush are one region (see [`super::regions`]).

use crate::rigid::BodyDef;
use crate::rigid::body_state::{Pose, RigidBodyState};
use crate::roots::fall_of_quadratic;
use crate::scenery::{Mesh, Plane};
use crate::shape::PolyhedronFace;
use crate::shape::convex_pair::Mark;
use crate::shape::piece::{Core, Piece};
use glam::DVec3;

/// How far inside the sides of a face a body must be for the face to be a half space to it, over the gap at which it
/// touches: the points that a step lists lie within it. 4: twice that.
pub(super) const INSIDE: f64 = 4.0;

/// Most faces of a mesh that are kept: the largest. 64: each is asked whenever a body is near the mesh.
const MOST_FACES: usize = 64;

/// How far a corner may be outside a convex face, over the length of a side: rounding.
const STRAIGHT: f64 = 1e-9;

/// A half space: a plane, or a fixed part to a body over one of its faces.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Flat {
    pub(crate) normal: DVec3,
    pub(crate) offset: f64,
    /// The face's number in names of points.
    pub(crate) face: u8,
    /// A piece of the part that has this face.
    pub(crate) piece: u32,
}

impl Flat {
    pub(crate) fn of_plane(plane: &Plane) -> Self {
        Self { normal: plane.normal, offset: plane.offset, face: Mark::PLANE, piece: 0 }
    }

    pub(crate) fn distance(&self, x: DVec3) -> f64 {
        self.normal.dot(x) - self.offset
    }
}

/// A side of a face.
#[derive(Debug, Clone, Copy)]
pub(super) struct Side {
    /// Its unit normal in the face's plane.
    pub(super) inward: DVec3,
    pub(super) offset: f64,
    pub(super) ends: [DVec3; 2],
}

impl Side {
    fn new(normal: DVec3, from: DVec3, to: DVec3) -> Self {
        let inward = normal.cross(to - from).normalize();
        Self { inward, offset: inward.dot(from), ends: [from, to] }
    }

    /// How far a point is inside of the line that the side lies on.
    #[inline]
    pub(super) fn inside(&self, x: DVec3) -> f64 {
        self.inward.dot(x) - self.offset
    }

    /// Whether a body is well inside of that line.
    pub(super) fn is_inside(&self, spec: &BodyDef, pose: &Pose) -> bool {
        let inside = self.inside(pose.x) - INSIDE * spec.gap;
        inside > 0.0 && (inside >= spec.bounding_radius || inside >= spec.extent(&pose.r, -self.inward))
    }

    /// Until when after its clock a body is, at most `end`; `None` if it is not. `fastest` is the most that it turns
    /// by a second.
    pub(super) fn inside_until(
        &self,
        spec: &BodyDef,
        (body, pose): (&RigidBodyState, &Pose),
        fastest: f64,
        end: f64,
    ) -> Option<f64> {
        let (path, inside) = (&body.path, self.inside(body.path.x) - INSIDE * spec.gap);
        if inside <= 0.0 {
            return None;
        }
        // The sphere around the body, or as far as the body reaches now and may reach by turning.
        let (bounding_radius, grow) = if inside >= spec.bounding_radius {
            (spec.bounding_radius, 0.0)
        } else {
            (spec.extent(&pose.r, -self.inward), fastest * spec.bounding_radius)
        };
        if inside < bounding_radius {
            return None;
        }
        let fall = [inside - bounding_radius, self.inward.dot(path.v) - grow, 0.5 * self.inward.dot(path.a)];
        Some(fall_of_quadratic(fall, end).unwrap_or(end))
    }

    /// From the nearest point of the side to another, in the plane across `normal`.
    pub(super) fn away(&self, normal: DVec3, x: DVec3) -> DVec3 {
        let [from, to] = self.ends;
        let (along, x) = (to - from, x - normal * normal.dot(x - from));
        x - (from + along * ((x - from).dot(along) / along.length_squared()).clamp(0.0, 1.0))
    }
}

/// A face, with its sides.
#[derive(Debug, Clone)]
pub(super) struct Facet {
    pub(super) flat: Flat,
    pub(super) sides: Vec<Side>,
    /// The pieces of the part that it belongs to, in ascending order.
    pub(super) pieces: Vec<u32>,
}

/// The faces of a part.
#[derive(Debug, Clone, Default)]
pub(crate) struct Facets {
    pub(super) all: Vec<Facet>,
}

impl Facets {
    /// The faces of a fixed piece with this number, if it is a sharp polyhedron with an inside.
    pub(super) fn of_piece(piece: &Piece, number: u32) -> Self {
        let Core::Polyhedron(core) = &piece.core else { return Self::default() };
        if piece.rounding > 0.0 || core.faces.len() < 4 {
            return Self::default();
        }
        let placed = |k: u8| piece.at + piece.turn * core.corner(k);
        let facet = |(k, face): (usize, &PolyhedronFace)| {
            let normal = piece.turn * face.normal;
            let ends = face.corners.iter().zip(face.corners.iter().cycle().skip(1));
            let sides = ends.map(|(&a, &b)| Side::new(normal, placed(a), placed(b))).collect();
            let offset = face.offset + normal.dot(piece.at);
            Facet { flat: Flat { normal, offset, face: k as u8, piece: number }, sides, pieces: vec![number] }
        };
        Self { all: core.faces.iter().enumerate().map(facet).collect() }
    }

    /// The convex faces of a mesh that hold a disc of radius `least`. `flat` is the triangle beyond a side of another,
    /// if it lies in the same plane.
    pub(super) fn of_mesh(mesh: &Mesh, least: f64, flat: impl Fn(u32, usize) -> Option<u32>) -> Self {
        let mut seen = vec![false; mesh.len()];
        let mut found: Vec<(f64, Facet)> = Vec::new();
        for first in 0..mesh.len() as u32 {
            if seen[first as usize] {
                continue;
            }
            seen[first as usize] = true;
            let (mut triangles, mut sides, mut next) = (vec![first], Vec::new(), 0);
            while let Some(&k) = triangles.get(next) {
                next += 1;
                let face = &mesh.faces[k as usize];
                for (i, &(inward, offset)) in face.sides.iter().enumerate() {
                    match flat(k, i).filter(|&j| mesh.faces[j as usize].material == face.material) {
                        Some(j) if !seen[j as usize] => {
                            seen[j as usize] = true;
                            triangles.push(j);
                        }
                        Some(_) => {}
                        None => {
                            let ends = [face.corners[i], face.corners[(i + 1) % 3]];
                            sides.push(Side { inward, offset, ends: ends.map(|c| mesh.vertices()[c as usize]) });
                        }
                    }
                }
            }
            let corners = || triangles.iter().filter_map(|&k| mesh.triangle(k as usize)).flatten();
            let count = 3.0 * triangles.len() as f64;
            let middle = corners().sum::<DVec3>() / count;
            let bounding_radius = corners().map(|c| (c - middle).length()).fold(0.0, f64::max);
            let inside = |p: DVec3| sides.iter().map(|side| side.inside(p)).fold(f64::INFINITY, f64::min);
            let size = inside(middle);
            if size >= least && corners().all(|c| inside(c) >= -STRAIGHT * bounding_radius) {
                let face = &mesh.faces[first as usize];
                let flat = Flat { normal: face.normal, offset: face.offset, face: 0, piece: first };
                triangles.sort_unstable();
                found.push((size, Facet { flat, sides, pieces: triangles }));
            }
        }
        found.sort_by(|a, b| b.0.total_cmp(&a.0));
        found.truncate(MOST_FACES);
        let mut facets = Self { all: found.into_iter().map(|(_, facet)| facet).collect() };
        facets.all.iter_mut().enumerate().for_each(|(k, facet)| facet.flat.face = k as u8);
        facets
    }

    /// The face with that number as a half space.
    pub(crate) fn flat(&self, face: u8) -> Option<Flat> {
        self.all.get(usize::from(face)).map(|facet| facet.flat)
    }

    /// The pieces that belong to a face, in ascending order.
    pub(super) fn pieces(&self, face: u8) -> &[u32] {
        self.all.get(usize::from(face)).map_or(&[], |facet| &facet.pieces)
    }

    /// The face that a body is over, well inside its sides.
    pub(crate) fn below(&self, spec: &BodyDef, pose: &Pose) -> Option<Flat> {
        let is_over = |facet: &&Facet| {
            facet.flat.distance(pose.x) >= 0.0 && facet.sides.iter().all(|side| side.is_inside(spec, pose))
        };
        self.all.iter().find(is_over).map(|facet| facet.flat)
    }

    /// The face that a body is over at its clock, well inside its sides, and until when after that, at most `until`.
    pub(crate) fn until(&self, spec: &BodyDef, body: &RigidBodyState, until: f64) -> Option<(Flat, f64)> {
        let (pose, fastest) = (body.pose(), body.fastest(spec, body.path.t + until));
        self.all.iter().filter(|facet| facet.flat.distance(body.path.x) >= 0.0).find_map(|facet| {
            let mut sides = facet.sides.iter();
            let end = sides.try_fold(until, |end, side| side.inside_until(spec, (body, &pose), fastest, end))?;
            Some((facet.flat, end))
        })
    }
}

//! One sphere on a parabola and one surface.

use crate::motion::Parabola;
use crate::roots::{fall_of_quadratic, falls_of_quartic, squared_distance};
use crate::scenery::{Mesh, Scenery, Surface};
use glam::DVec3;

/// How far a contact point may lie outside a feature of the mesh and still count as on it, in radii. It closes the
/// cracks that rounding leaves between neighbours. Default 1e-9; danger: much larger values catch balls on the
/// invisible continuation of a face.
const SEAM: f64 = 1e-9;

/// A part of a motion whose beginning is needed again and again.
pub(crate) struct Stretch<'p> {
    pub(crate) path: &'p Parabola,
    /// Its start, in seconds after the motion's clock, and centre and velocity then.
    pub(crate) from: f64,
    pub(crate) x: DVec3,
    pub(crate) v: DVec3,
}

impl<'p> Stretch<'p> {
    #[inline]
    pub(crate) fn new(path: &'p Parabola, from: f64) -> Self {
        Self { path, from, x: path.after(from), v: path.velocity_after(from) }
    }
}

/// First time in a stretch until `until` seconds after the motion's clock at which a sphere touches a surface while
/// approaching it.
#[inline]
pub(crate) fn sphere_surface(
    scenery: &Scenery,
    surface: Surface,
    stretch: &Stretch<'_>,
    radius: f64,
    until: f64,
) -> Option<f64> {
    let (path, from) = (stretch.path, stretch.from);
    match surface {
        Surface::Plane(k) => {
            let plane = &scenery.planes()[k as usize];
            // Of the whole motion, so that the time does not depend on where the broad phase came upon the plane.
            let whole = Stretch { path, from: 0.0, x: path.x, v: path.v };
            flat(plane.normal, plane.offset + radius, &whole, until)
        }
        Surface::Dome(k) => dome(scenery, k, path, radius, from, until),
        _ => sphere_on_mesh(scenery.mesh(), surface, stretch, radius, until),
    }
}

/// The same for a triangle, an edge or a vertex.
#[inline]
pub(crate) fn sphere_on_mesh(
    mesh: &Mesh,
    surface: Surface,
    stretch: &Stretch<'_>,
    radius: f64,
    until: f64,
) -> Option<f64> {
    let (path, from) = (stretch.path, stretch.from);
    match surface {
        Surface::Face(k) => {
            let face = &mesh.faces[k as usize];
            // Behind the face's plane all along: it cannot be touched from there.
            let time = flat(face.normal, face.offset + radius, stretch, until)?;
            let x = path.after(time);
            let height = face.normal.dot(x) - face.offset;
            (height > 0.0 && face.inside(x - face.normal * height) >= -SEAM * radius).then_some(time)
        }
        Surface::Edge(k) => edge(mesh, k, path, radius, from, until),
        Surface::Vertex(k) => {
            if !mesh.vertex_active[k as usize] {
                return None;
            }
            let c = squared_distance(path.x - mesh.vertices[k as usize], path.v, path.a, radius);
            falls_of_quartic(&c, from, until, |t| mesh.is_over_vertex(k, path.after(t), SEAM * radius))
        }
        _ => None,
    }
}

#[inline]
fn flat(normal: DVec3, offset: f64, stretch: &Stretch<'_>, until: f64) -> Option<f64> {
    let c = [normal.dot(stretch.x) - offset, normal.dot(stretch.v), 0.5 * normal.dot(stretch.path.a)];
    fall_of_quadratic(c, until - stretch.from).map(|dt| stretch.from + dt)
}

fn dome(scenery: &Scenery, k: u32, path: &Parabola, radius: f64, from: f64, until: f64) -> Option<f64> {
    let dome = &scenery.domes()[k as usize];
    let gap = if dome.hollow { dome.radius - radius } else { dome.radius + radius };
    let mut c = squared_distance(path.x - dome.centre, path.v, path.a, gap);
    if dome.hollow {
        c = c.map(|x| -x);
    }
    falls_of_quartic(&c, from, until, |t| dome.project(path.after(t)).is_some())
}

fn edge(mesh: &Mesh, k: u32, path: &Parabola, radius: f64, from: f64, until: f64) -> Option<f64> {
    let edge = &mesh.edges[k as usize];
    if !edge.active {
        return None;
    }
    let d = edge.direction;
    let across = |u: DVec3| u - d * d.dot(u);
    let offset = path.x - edge.origin;
    let c = squared_distance(across(offset), across(path.v), across(path.a), radius);
    falls_of_quartic(&c, from, until, |t| mesh.is_over_edge(k, path.after(t), SEAM * radius))
}

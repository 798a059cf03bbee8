//! Static scenery: planes, a triangle mesh (also of a height field), curved tracks, bowls and domes, with a broad phase
//! for the bounded ones.

mod aabb;
mod arc_track;
mod dome;
mod grid;
mod heights;
mod mesh;
mod plane;
mod screen;
pub(crate) mod surface;
mod track;

pub use aabb::Aabb;
pub(crate) use aabb::{greater, lesser};
pub use arc_track::{ArcForm, ArcTrack};
pub use dome::Dome;
pub use heights::Heights;
pub use mesh::Mesh;
pub(crate) use mesh::{Edge, Face};
pub use plane::Plane;

pub(crate) use grid::Grid;
pub(crate) use screen::Probe;

use crate::error::WorldError;
use crate::material::Material;
use glam::DVec3;
use screen::Screen;

pub use surface::Surface;

pub(crate) const NO_PARTS: &str = "parts belong to worlds of turning bodies";

/// A ball's centre relative to a surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Projection {
    /// Unit vector from the surface to the centre.
    pub normal: DVec3,
    /// Distance of the centre from the surface in m.
    pub distance: f64,
    /// Radius of curvature of the surface towards the ball: +∞ flat, 0 an edge or vertex, negative a bowl's radius.
    pub curvature_radius: f64,
}

/// All scenery of a world.
#[derive(Debug, Clone)]
pub struct Scenery {
    planes: Vec<Plane>,
    mesh: Mesh,
    domes: Vec<Dome>,
    /// Of planes, faces, domes, edges, vertices in this order: the order in which they are tested.
    boxes: Vec<Aabb>,
    /// The same boxes, rougher and quicker to test.
    screens: Vec<Screen>,
    /// The surface inside each box.
    items: Vec<Surface>,
    grid: Grid,
    reach: f64,
}

/// Nothing at all, for balls of radius up to 1 m.
impl Default for Scenery {
    fn default() -> Self {
        Self::of(Vec::new(), Mesh::default(), Vec::new(), 1.0)
    }
}

impl Scenery {
    /// Scenery for balls of radius up to `reach`.
    ///
    /// # Errors
    /// [`WorldError::BadNumber`] if `reach` is not positive.
    pub fn new(planes: Vec<Plane>, mesh: Mesh, domes: Vec<Dome>, reach: f64) -> Result<Self, WorldError> {
        if !(reach > 0.0 && reach.is_finite()) {
            return Err(WorldError::BadNumber { field: "largest radius", value: reach, expected: "a positive length" });
        }
        Ok(Self::of(planes, mesh, domes, reach))
    }

    fn of(planes: Vec<Plane>, mesh: Mesh, domes: Vec<Dome>, reach: f64) -> Self {
        let caps = domes.iter().map(Dome::bounds);
        let endless = || planes.iter().map(|_| Aabb::EVERYWHERE);
        let bounded = mesh.face_reaches().chain(caps).chain(mesh.edge_reaches()).chain(mesh.vertex_reaches());
        let reaches: Vec<Aabb> = endless().chain(bounded).collect();
        let kinds = [Surface::Plane, Surface::Face, Surface::Dome, Surface::Edge, Surface::Vertex];
        let counts = [planes.len(), mesh.faces.len(), domes.len(), mesh.edges.len(), mesh.vertices.len()];
        let items: Vec<Surface> =
            kinds.iter().zip(counts).flat_map(|(kind, count)| (0..count as u32).map(kind)).collect();
        let grid = Grid::new(&reaches, reach, |item, centres| match items[item as usize] {
            Surface::Plane(k) => planes[k as usize].may_touch(centres, reach),
            Surface::Face(k) => mesh.face_may_touch(k as usize, centres, reach),
            _ => true,
        });
        let faces = (0..mesh.faces.len()).map(|f| mesh.face_bounds(f));
        let edges = (0..mesh.edges.len()).map(|e| mesh.edge_bounds(e));
        let vertices = (0..mesh.vertices.len()).map(|v| mesh.vertex_bounds(v));
        let boxes: Vec<Aabb> =
            endless().chain(faces).chain(domes.iter().map(Dome::tight_bounds)).chain(edges).chain(vertices).collect();
        let screens = boxes.iter().map(Screen::new).collect();
        Self { planes, mesh, domes, boxes, screens, items, grid, reach }
    }

    /// Moves some mesh vertices (see [`Mesh::move_vertices`]).
    ///
    /// # Errors
    /// As [`Mesh::move_vertices`].
    pub fn move_vertices(&mut self, moved: &[(u32, DVec3)]) -> Result<(), WorldError> {
        self.mesh.move_vertices(moved)?;
        let Self { planes, mesh, boxes, screens, domes, .. } = self;
        let first_face = planes.len();
        let first_edge = first_face + mesh.faces.len() + domes.len();
        let first_vertex = first_edge + mesh.edges.len();
        let touched = mesh.touched();
        let mut place = |item: usize, bounds: Aabb| (boxes[item], screens[item]) = (bounds, Screen::new(&bounds));
        touched.faces.iter().for_each(|&f| place(first_face + f as usize, mesh.face_bounds(f as usize)));
        touched.edges.iter().for_each(|&e| place(first_edge + e as usize, mesh.edge_bounds(e as usize)));
        touched.vertices.iter().for_each(|&v| place(first_vertex + v as usize, mesh.vertex_bounds(v as usize)));
        Ok(())
    }

    /// The planes.
    #[must_use]
    pub fn planes(&self) -> &[Plane] {
        &self.planes
    }

    /// The mesh.
    #[must_use]
    pub fn mesh(&self) -> &Mesh {
        &self.mesh
    }

    /// The domes.
    #[must_use]
    pub fn domes(&self) -> &[Dome] {
        &self.domes
    }

    /// Largest ball radius that the broad phase allows for.
    #[must_use]
    pub fn reach(&self) -> f64 {
        self.reach
    }

    pub(crate) fn grid(&self) -> &Grid {
        &self.grid
    }

    #[inline]
    pub(crate) fn bounds(&self, item: u32) -> &Aabb {
        &self.boxes[item as usize]
    }

    /// Whether an item's box may be met; see [`Screen`].
    #[inline]
    pub(crate) fn may_meet(&self, item: u32, probe: &Probe) -> bool {
        self.screens[item as usize].may_meet(probe)
    }

    /// The surface that an item of the broad phase stands for.
    #[inline]
    pub(crate) fn surface(&self, item: u32) -> Surface {
        self.items[item as usize]
    }

    /// The triangle of the mesh that a surface belongs to: for edges and vertices, the first of theirs.
    #[inline]
    #[must_use]
    pub fn triangle(&self, surface: Surface) -> Option<u32> {
        match surface {
            Surface::Face(k) => Some(k),
            Surface::Edge(k) => self.mesh.edges[k as usize].faces[0],
            Surface::Vertex(k) => self.mesh.around_vertex(k).first().copied(),
            _ => None,
        }
    }

    /// The material of a surface; edges and vertices take that of their first face.
    #[inline]
    #[must_use]
    pub fn material(&self, surface: Surface) -> Material {
        match surface {
            Surface::Plane(k) => self.planes[k as usize].material,
            Surface::Dome(k) => self.domes[k as usize].material,
            Surface::Face(_) | Surface::Edge(_) | Surface::Vertex(_) => {
                self.triangle(surface).map_or(Material(0), |f| self.mesh.faces[f as usize].material)
            }
            Surface::Part { .. } | Surface::Spot { .. } => unreachable!("{NO_PARTS}"),
        }
    }

    /// The projection of a ball's centre on a surface.
    #[inline]
    #[must_use]
    pub fn project(&self, surface: Surface, x: DVec3) -> Projection {
        match surface {
            Surface::Plane(k) => {
                let plane = &self.planes[k as usize];
                Projection { normal: plane.normal, distance: plane.distance(x), curvature_radius: f64::INFINITY }
            }
            Surface::Face(k) => {
                let face = &self.mesh.faces[k as usize];
                Projection {
                    normal: face.normal,
                    distance: face.normal.dot(x) - face.offset,
                    curvature_radius: f64::INFINITY,
                }
            }
            Surface::Dome(k) => self.domes[k as usize].stands(x),
            Surface::Edge(k) => {
                let edge = &self.mesh.edges[k as usize];
                let offset = x - edge.origin;
                sharp(offset - edge.direction * edge.direction.dot(offset))
            }
            Surface::Vertex(k) => sharp(x - self.mesh.vertices[k as usize]),
            Surface::Part { .. } | Surface::Spot { .. } => unreachable!("{NO_PARTS}"),
        }
    }
}

fn sharp(offset: DVec3) -> Projection {
    let distance = offset.length();
    let normal = if distance > 0.0 { offset / distance } else { DVec3::Z };
    Projection { normal, distance, curvature_radius: 0.0 }
}

//! Triangle meshes: faces, and those edges and vertices that a sphere can touch.
//!
//! A sphere that meets a concave or flat edge meets a face first. So only convex and open edges are kept, and only the
//! vertices of such edges. Faces are one-sided: their normal points out of the solid.

use crate::error::WorldError;
use crate::material::Material;
use crate::scenery::Aabb;
use glam::DVec3;
use std::collections::BTreeMap;

/// An edge counts as flat if the distance of the neighbour's far corner from the face's plane is within this fraction
/// of the edge's length. Dimensionless; default 1e-12 (a few thousand rounding errors); danger: larger values open
/// cracks of that width.
const FLAT: f64 = 1e-12;

/// Maximum number of triangles: in a world of rigid bodies, each takes about a kilobyte.
const MOST_TRIANGLES: usize = 1 << 20;

/// One triangle.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Face {
    pub(crate) corners: [u32; 3],
    pub(crate) normal: DVec3,
    pub(crate) offset: f64,
    /// Unit normals in the plane, inward, one per side, and their offsets.
    pub(crate) sides: [(DVec3, f64); 3],
    pub(crate) material: Material,
    /// Triangle across each side.
    pub(crate) neighbours: [Option<u32>; 3],
}

impl Face {
    /// Least distance of a point of the plane from the three sides, positive inside.
    #[inline]
    pub(crate) fn inside(&self, p: DVec3) -> f64 {
        let [a, b, c] = self.sides;
        (a.0.dot(p) - a.1).min(b.0.dot(p) - b.1).min(c.0.dot(p) - c.1)
    }
}

/// One edge.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Edge {
    pub(crate) ends: [u32; 2],
    pub(crate) origin: DVec3,
    pub(crate) direction: DVec3,
    pub(crate) length: f64,
    pub(crate) faces: [Option<u32>; 2],
    pub(crate) active: bool,
}

/// A triangle mesh with its topology. The default has no triangles.
#[derive(Debug, Clone, Default)]
pub struct Mesh {
    pub(crate) vertices: Vec<DVec3>,
    made_at: Vec<DVec3>,
    /// How far each vertex may be moved.
    margins: Vec<f64>,
    moved: Touched,
    pub(crate) faces: Vec<Face>,
    pub(crate) edges: Vec<Edge>,
    pub(crate) vertex_active: Vec<bool>,
    around_vertex: Vec<Vec<u32>>,
    edges_at_vertex: Vec<Vec<u32>>,
}

impl Mesh {
    /// A mesh of triangles whose corners run anticlockwise as seen from outside. Vertices may later be moved by up to
    /// `margin` metres without a new broad phase (see [`Mesh::move_vertices`]); 0 if they never move.
    ///
    /// # Errors
    /// [`WorldError`] naming the triangle that is degenerate, names an unknown vertex, or shares an edge it cannot
    /// share; [`WorldError::BadNumber`] for more than 1,048,576 triangles.
    pub fn new(vertices: Vec<DVec3>, triangles: &[([u32; 3], Material)], margin: f64) -> Result<Self, WorldError> {
        let margins = vec![margin; vertices.len()];
        Self::with_margins(vertices, triangles, margins)
    }

    /// The same with a margin for each vertex: surfaces that cannot move are found faster.
    ///
    /// # Errors
    /// As [`Mesh::new`], and if the number of margins is not that of the vertices.
    pub fn with_margins(
        vertices: Vec<DVec3>,
        triangles: &[([u32; 3], Material)],
        margins: Vec<f64>,
    ) -> Result<Self, WorldError> {
        if margins.len() != vertices.len() {
            return Err(WorldError::BadNumber {
                field: "number of margins",
                value: margins.len() as f64,
                expected: "one for each vertex",
            });
        }
        if triangles.len() > MOST_TRIANGLES {
            return Err(WorldError::BadNumber {
                field: "number of triangles",
                value: triangles.len() as f64,
                expected: "at most 1,048,576",
            });
        }
        let bad = margins.iter().copied().find(|margin| !(*margin >= 0.0 && margin.is_finite()));
        if let Some(value) = bad {
            return Err(WorldError::BadNumber {
                field: "mesh margin",
                value,
                expected: "a length that is not negative",
            });
        }
        let mut mesh = Self {
            around_vertex: vec![Vec::new(); vertices.len()],
            edges_at_vertex: vec![Vec::new(); vertices.len()],
            vertex_active: vec![false; vertices.len()],
            made_at: vertices.clone(),
            vertices,
            margins,
            moved: Touched::default(),
            faces: Vec::with_capacity(triangles.len()),
            edges: Vec::with_capacity(triangles.len() * 3 / 2 + 1),
        };
        mesh.add_faces(triangles)?;
        mesh.join_edges()?;
        for f in 0..mesh.faces.len() {
            mesh.place_face(f)?;
        }
        for e in 0..mesh.edges.len() {
            mesh.place_edge(e);
        }
        for v in 0..mesh.vertices.len() {
            mesh.place_vertex(v);
        }
        Ok(mesh)
    }

    fn add_faces(&mut self, triangles: &[([u32; 3], Material)]) -> Result<(), WorldError> {
        for (k, &(corners, material)) in triangles.iter().enumerate() {
            for c in corners {
                let list = self.around_vertex.get_mut(c as usize).ok_or(WorldError::UnknownVertex {
                    triangle: k,
                    vertex: c as usize,
                    vertices: self.vertices.len(),
                })?;
                list.push(k as u32);
            }
            let nothing = (DVec3::ZERO, 0.0);
            self.faces.push(Face {
                corners,
                normal: DVec3::ZERO,
                offset: 0.0,
                sides: [nothing; 3],
                material,
                neighbours: [None; 3],
            });
        }
        Ok(())
    }

    fn join_edges(&mut self) -> Result<(), WorldError> {
        let mut known: BTreeMap<(u32, u32), usize> = BTreeMap::new();
        for k in 0..self.faces.len() {
            for side in 0..3 {
                let corners = self.faces[k].corners;
                let (from, to) = (corners[side], corners[(side + 1) % 3]);
                let bad = WorldError::BadEdge { triangle: k, from: from as usize, to: to as usize };
                let Some(&e) = known.get(&(from.min(to), from.max(to))) else {
                    known.insert((from.min(to), from.max(to)), self.edges.len());
                    for v in [from, to] {
                        self.edges_at_vertex[v as usize].push(self.edges.len() as u32);
                    }
                    let faces = [Some(k as u32), None];
                    self.edges.push(Edge {
                        ends: [from, to],
                        origin: DVec3::ZERO,
                        direction: DVec3::X,
                        length: 0.0,
                        faces,
                        active: true,
                    });
                    continue;
                };
                let edge = &mut self.edges[e];
                if edge.faces[1].is_some() || edge.ends != [to, from] {
                    return Err(bad);
                }
                edge.faces[1] = Some(k as u32);
                let Some(other) = edge.faces[0] else { return Err(bad) };
                self.faces[k].neighbours[side] = Some(other);
                let there = self.faces[other as usize].corners;
                let their_side = (0..3).find(|&s| there[s] == to && there[(s + 1) % 3] == from).ok_or(bad)?;
                self.faces[other as usize].neighbours[their_side] = Some(k as u32);
            }
        }
        Ok(())
    }

    fn place_face(&mut self, f: usize) -> Result<(), WorldError> {
        let corners = self.faces[f].corners;
        let p = corners.map(|c| self.vertices[c as usize]);
        let cross = (p[1] - p[0]).cross(p[2] - p[0]);
        let doubled = cross.length();
        let longest =
            (p[1] - p[0]).length_squared().max((p[2] - p[0]).length_squared()).max((p[2] - p[1]).length_squared());
        if !(doubled > 1e-12 * longest && doubled.is_finite()) {
            return Err(WorldError::DegenerateTriangle { triangle: f, area: 0.5 * doubled });
        }
        let face = &mut self.faces[f];
        face.normal = cross / doubled;
        face.offset = face.normal.dot(p[0]);
        for side in 0..3 {
            let along = p[(side + 1) % 3] - p[side];
            let inward = face.normal.cross(along) / along.length();
            face.sides[side] = (inward, inward.dot(p[side]));
        }
        Ok(())
    }

    fn place_edge(&mut self, e: usize) {
        let [a, b] = self.edges[e].ends.map(|v| self.vertices[v as usize]);
        let along = b - a;
        let length = along.length();
        let active = self.is_convex(e, length);
        let edge = &mut self.edges[e];
        edge.origin = a;
        edge.direction = along / length;
        edge.length = length;
        edge.active = active;
    }

    fn place_vertex(&mut self, v: usize) {
        self.vertex_active[v] = self.edges_at_vertex[v].iter().any(|&e| self.edges[e as usize].active);
    }

    fn is_convex(&self, e: usize, length: f64) -> bool {
        let [Some(first), Some(second)] = self.edges[e].faces else { return true };
        let (first, second) = (&self.faces[first as usize], &self.faces[second as usize]);
        let far = second
            .corners
            .iter()
            .find(|c| !self.edges[e].ends.contains(c))
            .map_or(DVec3::ZERO, |&c| self.vertices[c as usize]);
        first.normal.dot(far) - first.offset < -FLAT * length
    }

    /// Moves vertices in place: `moved` gives the index and the new position. The topology and the broad phase stay, so
    /// a scene whose draws differ by small offsets builds its mesh only once.
    ///
    /// # Errors
    /// [`WorldError::MovedTooFar`] beyond the mesh's margin, [`WorldError::DegenerateTriangle`] if a triangle
    /// collapses, [`WorldError::UnknownVertex`] for an index that the mesh lacks. The mesh is then only partly moved:
    /// drop it or move the vertices back.
    pub fn move_vertices(&mut self, moved: &[(u32, DVec3)]) -> Result<(), WorldError> {
        for &(v, to) in moved {
            let home = *self.made_at.get(v as usize).ok_or(WorldError::UnknownVertex {
                triangle: usize::MAX,
                vertex: v as usize,
                vertices: self.vertices.len(),
            })?;
            let distance = (to - home).length();
            let margin = self.margins[v as usize];
            if distance.is_nan() || distance > margin {
                return Err(WorldError::MovedTooFar { vertex: v as usize, distance, margin });
            }
            self.vertices[v as usize] = to;
        }
        let mut touched = std::mem::take(&mut self.moved);
        touched.find(self, moved);
        let placed = touched.faces.iter().try_for_each(|&f| self.place_face(f as usize));
        touched.edges.iter().for_each(|&e| self.place_edge(e as usize));
        touched.vertices.iter().for_each(|&v| self.place_vertex(v as usize));
        self.moved = touched;
        placed
    }

    /// The parts of the mesh that the last move touched.
    pub(crate) fn touched(&self) -> &Touched {
        &self.moved
    }

    /// The mesh's vertices where they are now.
    #[must_use]
    pub fn vertices(&self) -> &[DVec3] {
        &self.vertices
    }

    /// Corners of a triangle.
    #[must_use]
    pub fn triangle(&self, k: usize) -> Option<[DVec3; 3]> {
        self.faces.get(k).map(|f| f.corners.map(|c| self.vertices[c as usize]))
    }

    /// How many triangles there are.
    #[must_use]
    pub fn len(&self) -> usize {
        self.faces.len()
    }

    /// Whether there are no triangles.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.faces.is_empty()
    }

    /// Largest margin of some vertices.
    fn margin_of(&self, vertices: &[u32]) -> f64 {
        vertices.iter().map(|&v| self.margins[v as usize]).fold(0.0, f64::max)
    }

    /// Boxes of all faces, wherever they can ever be.
    pub(crate) fn face_reaches(&self) -> impl Iterator<Item = Aabb> + '_ {
        (0..self.faces.len()).map(|f| self.face_bounds(f).grown(self.margin_of(&self.faces[f].corners)))
    }

    /// Boxes of all edges, wherever they can ever be; empty for an edge that can never become convex.
    pub(crate) fn edge_reaches(&self) -> impl Iterator<Item = Aabb> + '_ {
        (0..self.edges.len()).map(|e| {
            if self.edge_may_count(e) {
                Aabb::around(self.edges[e].ends.map(|v| self.vertices[v as usize]))
                    .grown(self.margin_of(&self.edges[e].ends))
            } else {
                Aabb::EMPTY
            }
        })
    }

    /// Boxes of all vertices, wherever they can ever be; empty for a vertex whose edges can never become convex.
    pub(crate) fn vertex_reaches(&self) -> impl Iterator<Item = Aabb> + '_ {
        (0..self.vertices.len()).map(|v| {
            let counts = self.edges_at_vertex[v].iter().any(|&e| self.edge_may_count(e as usize));
            if counts { Aabb::around([self.vertices[v]]).grown(self.margins[v]) } else { Aabb::EMPTY }
        })
    }

    /// Whether a ball of radius up to `reach` whose centre is in a box can touch a face. It cannot if the box is
    /// entirely behind the face or beyond reach.
    pub(crate) fn face_may_touch(&self, f: usize, centres: &Aabb, reach: f64) -> bool {
        let face = &self.faces[f];
        if self.margin_of(&face.corners) > 0.0 || !centres.min.is_finite() || !centres.max.is_finite() {
            return true;
        }
        let middle = face.normal.dot(0.5 * (centres.min + centres.max)) - face.offset;
        let half = face.normal.abs().dot(0.5 * (centres.max - centres.min));
        middle + half >= 0.0 && middle - half <= reach * (1.0 + 1e-6)
    }

    fn edge_may_count(&self, e: usize) -> bool {
        let edge = &self.edges[e];
        edge.active || edge.faces.iter().flatten().any(|&f| self.margin_of(&self.faces[f as usize].corners) > 0.0)
    }

    pub(crate) fn around_vertex(&self, v: u32) -> &[u32] {
        &self.around_vertex[v as usize]
    }

    pub(crate) fn edges_at_vertex(&self, v: u32) -> &[u32] {
        &self.edges_at_vertex[v as usize]
    }

    /// From a vertex along one of its edges to the other end.
    pub(crate) fn along_edge(&self, edge: u32, from: u32) -> DVec3 {
        let [a, b] = self.edges[edge as usize].ends;
        self.vertices[if a == from { b } else { a } as usize] - self.vertices[from as usize]
    }

    pub(crate) fn edge_between(&self, a: u32, b: u32) -> Option<u32> {
        self.edges_at_vertex[a as usize].iter().copied().find(|&e| self.edges[e as usize].ends.contains(&b))
    }

    pub(crate) fn face_bounds(&self, f: usize) -> Aabb {
        Aabb::around(self.faces[f].corners.map(|c| self.vertices[c as usize]))
    }

    /// Box of an edge; empty while it is not convex.
    pub(crate) fn edge_bounds(&self, e: usize) -> Aabb {
        let edge = &self.edges[e];
        if edge.active { Aabb::around(edge.ends.map(|v| self.vertices[v as usize])) } else { Aabb::EMPTY }
    }

    /// Box of a vertex; empty while none of its edges is convex.
    pub(crate) fn vertex_bounds(&self, v: usize) -> Aabb {
        if self.vertex_active[v] { Aabb::around([self.vertices[v]]) } else { Aabb::EMPTY }
    }
}

/// The parts of the mesh that a move of vertices touches; kept, because scenes move the same vertices again and again.
#[derive(Debug, Clone, Default)]
pub(crate) struct Touched {
    moved: Vec<u32>,
    pub(crate) faces: Vec<u32>,
    pub(crate) edges: Vec<u32>,
    pub(crate) vertices: Vec<u32>,
}

impl Touched {
    fn find(&mut self, mesh: &Mesh, moved: &[(u32, DVec3)]) {
        if self.moved.len() == moved.len() && self.moved.iter().zip(moved).all(|(a, b)| *a == b.0) {
            return;
        }
        let unique = |mut list: Vec<u32>| {
            list.sort_unstable();
            list.dedup();
            list
        };
        self.moved = moved.iter().map(|m| m.0).collect();
        self.faces = unique(self.moved.iter().flat_map(|&v| &mesh.around_vertex[v as usize]).copied().collect());
        // An edge's convexity depends on both of its faces, so every edge of a touched face is examined.
        self.vertices = unique(self.faces.iter().flat_map(|&f| mesh.faces[f as usize].corners).collect());
        self.edges = unique(self.vertices.iter().flat_map(|&v| &mesh.edges_at_vertex[v as usize]).copied().collect());
        self.vertices = unique(self.edges.iter().flat_map(|&e| mesh.edges[e as usize].ends).collect());
    }
}

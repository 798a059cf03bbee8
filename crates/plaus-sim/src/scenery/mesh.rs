//! Triangle meshes: faces, and of the edges and vertices those that a sphere can touch.
//!
//! A sphere that meets a concave or flat edge meets a face first, so only convex and open edges are kept, and only the vertices of such edges. Faces are
//! one-sided: their normal points out of the solid.

use crate::error::WorldError;
use crate::material::Material;
use crate::scenery::Aabb;
use glam::DVec3;
use std::collections::BTreeMap;

/// An edge counts as flat where the neighbour's far corner is within this part of the edge's length of the face's plane. Dimensionless; default 1e-12 (a
/// few thousand rounding errors); danger: larger values open cracks of that width.
const FLAT: f64 = 1e-12;

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

/// A triangle mesh with its topology.
#[derive(Debug, Clone)]
pub struct Mesh {
    pub(crate) vertices: Vec<DVec3>,
    made_at: Vec<DVec3>,
    margin: f64,
    pub(crate) faces: Vec<Face>,
    pub(crate) edges: Vec<Edge>,
    pub(crate) vertex_active: Vec<bool>,
    around_vertex: Vec<Vec<u32>>,
    edges_at_vertex: Vec<Vec<u32>>,
}

impl Mesh {
    /// A mesh of triangles whose corners run counter-clockwise seen from outside. Vertices may later be moved by up to `margin` metres without a new
    /// broad phase (see [`Mesh::move_vertices`]); 0 where they never move.
    ///
    /// # Errors
    /// [`WorldError`] naming the triangle that is degenerate, names an unknown vertex, or shares an edge it cannot share.
    pub fn new(vertices: Vec<DVec3>, triangles: &[([u32; 3], Material)], margin: f64) -> Result<Self, WorldError> {
        if !(margin >= 0.0 && margin.is_finite()) {
            return Err(WorldError::BadNumber { field: "mesh margin", value: margin, expected: "a length that is not negative" });
        }
        let mut mesh = Self {
            around_vertex: vec![Vec::new(); vertices.len()],
            edges_at_vertex: vec![Vec::new(); vertices.len()],
            vertex_active: vec![false; vertices.len()],
            made_at: vertices.clone(),
            vertices,
            margin,
            faces: Vec::with_capacity(triangles.len()),
            edges: Vec::with_capacity(triangles.len() * 3 / 2 + 1),
        };
        mesh.add_faces(triangles)?;
        mesh.join_edges()?;
        for f in 0..mesh.faces.len() {
            mesh.place_face(f)?;
        }
        mesh.place_edges(0..mesh.edges.len());
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
            self.faces.push(Face { corners, normal: DVec3::ZERO, offset: 0.0, sides: [nothing; 3], material, neighbours: [None; 3] });
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
                    self.edges.push(Edge { ends: [from, to], origin: DVec3::ZERO, direction: DVec3::X, length: 0.0, faces, active: true });
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
        let longest = (p[1] - p[0]).length_squared().max((p[2] - p[0]).length_squared()).max((p[2] - p[1]).length_squared());
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

    fn place_edges(&mut self, edges: impl IntoIterator<Item = usize>) {
        for e in edges {
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
        for v in 0..self.vertices.len() {
            self.vertex_active[v] = self.edges_at_vertex[v].iter().any(|&e| self.edges[e as usize].active);
        }
    }

    fn is_convex(&self, e: usize, length: f64) -> bool {
        let [Some(first), Some(second)] = self.edges[e].faces else { return true };
        let (first, second) = (&self.faces[first as usize], &self.faces[second as usize]);
        let far = second.corners.iter().find(|c| !self.edges[e].ends.contains(c)).map_or(DVec3::ZERO, |&c| self.vertices[c as usize]);
        first.normal.dot(far) - first.offset < -FLAT * length
    }

    /// Moves vertices in place: `moved` gives the index and the new position. The topology and the broad phase stay, so a scene whose draws differ in
    /// small offsets builds its mesh once.
    ///
    /// # Errors
    /// [`WorldError::MovedTooFar`] beyond the mesh's margin, [`WorldError::DegenerateTriangle`] where a triangle collapses,
    /// [`WorldError::UnknownVertex`] for an index that the mesh lacks. The mesh is then only partly moved: drop it or move the vertices back.
    pub fn move_vertices(&mut self, moved: &[(u32, DVec3)]) -> Result<(), WorldError> {
        for &(v, to) in moved {
            let home = *self.made_at.get(v as usize).ok_or(WorldError::UnknownVertex {
                triangle: usize::MAX,
                vertex: v as usize,
                vertices: self.vertices.len(),
            })?;
            let distance = (to - home).length();
            if !(distance <= self.margin) {
                return Err(WorldError::MovedTooFar { vertex: v as usize, distance, margin: self.margin });
            }
            self.vertices[v as usize] = to;
        }
        let mut faces: Vec<u32> = moved.iter().flat_map(|&(v, _)| self.around_vertex[v as usize].iter().copied()).collect();
        faces.sort_unstable();
        faces.dedup();
        for &f in &faces {
            self.place_face(f as usize)?;
        }
        // An edge's convexity rests on both of its faces, so every edge of a touched face is looked at.
        let corners = faces.iter().flat_map(|&f| self.faces[f as usize].corners);
        let mut edges: Vec<usize> = corners.flat_map(|v| self.edges_at_vertex[v as usize].iter().map(|&e| e as usize)).collect();
        edges.sort_unstable();
        edges.dedup();
        self.place_edges(edges);
        Ok(())
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

    pub(crate) fn margin(&self) -> f64 {
        self.margin
    }

    pub(crate) fn around_vertex(&self, v: u32) -> &[u32] {
        &self.around_vertex[v as usize]
    }

    pub(crate) fn edge_between(&self, a: u32, b: u32) -> Option<u32> {
        self.edges_at_vertex[a as usize].iter().copied().find(|&e| self.edges[e as usize].ends.contains(&b))
    }

    pub(crate) fn face_bounds(&self, f: usize) -> Aabb {
        Aabb::around(self.faces[f].corners.map(|c| self.vertices[c as usize]))
    }
}

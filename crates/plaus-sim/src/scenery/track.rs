//! Following a lasting contact over a mesh: from a face to its edge, from there to the next face.

use super::{Mesh, Projection, Scenery, Surface};
use glam::DVec3;

impl Mesh {
    /// Unit vector from a part of the mesh to the centre of a ball at `x`.
    pub(crate) fn normal(&self, surface: Surface, x: DVec3) -> DVec3 {
        match surface {
            Surface::Face(k) => self.faces[k as usize].normal,
            Surface::Edge(k) => {
                let edge = &self.edges[k as usize];
                let offset = x - edge.origin;
                (offset - edge.direction * edge.direction.dot(offset)).normalize_or_zero()
            }
            Surface::Vertex(k) => (x - self.vertices[k as usize]).normalize_or_zero(),
            _ => DVec3::ZERO,
        }
    }

    /// Whether an edge is nearer to `x` than the insides of its faces, up to `slack`.
    pub(crate) fn is_over_edge(&self, k: u32, x: DVec3, slack: f64) -> bool {
        let edge = &self.edges[k as usize];
        let along = edge.direction.dot(x - edge.origin);
        let beyond = |&f: &u32| {
            let face = &self.faces[f as usize];
            let height = face.normal.dot(x) - face.offset;
            height >= 0.0 && face.inside(x - face.normal * height) > slack
        };
        along >= -slack && along <= edge.length + slack && !edge.faces.iter().flatten().any(beyond)
    }

    /// Whether a vertex is nearer to `x` than the insides of its edges and faces, up to `slack`.
    pub(crate) fn is_over_vertex(&self, k: u32, x: DVec3, slack: f64) -> bool {
        let at = self.vertices[k as usize];
        let away = |&e: &u32| {
            let edge = &self.edges[e as usize];
            let outward = if edge.ends[0] == k { edge.direction } else { -edge.direction };
            let along = outward.dot(x - at);
            along <= slack || along > edge.length
        };
        self.edges_at_vertex(k).iter().all(away)
    }
}

impl Scenery {
    /// The surface that a ball in contact with `surface` touches now, with its centre at `x`: the same as long as the
    /// foot of the perpendicular stays on it, otherwise the nearest face, edge or vertex around. `None` if a dome has
    /// been left.
    pub(crate) fn track(&self, surface: Surface, x: DVec3) -> Option<Surface> {
        match surface {
            Surface::Plane(_) => Some(surface),
            Surface::Dome(k) => self.domes[k as usize].project(x).map(|_| surface),
            Surface::Face(k) => {
                let face = &self.mesh.faces[k as usize];
                let projection = x - face.normal * (face.normal.dot(x) - face.offset);
                if face.inside(projection) >= 0.0 { Some(surface) } else { self.nearest(face.corners, x) }
            }
            Surface::Edge(k) => self.around_edge(k, x),
            Surface::Vertex(k) => self.nearest([k], x),
            Surface::Part { .. } | Surface::Spot { .. } => None,
        }
    }

    /// The surface that [`Scenery::track`] finds, and the centre's projection on it.
    #[inline]
    pub(crate) fn follow(&self, surface: Surface, x: DVec3) -> Option<(Surface, Projection)> {
        if let Surface::Dome(k) = surface {
            let dome = &self.domes[k as usize];
            let projection = dome.stands(x);
            return dome.clip.contains(x - projection.normal * projection.distance).then_some((surface, projection));
        }
        let surface = self.track(surface, x)?;
        Some((surface, self.project(surface, x)))
    }

    /// The projection of a ball's centre on the surface that a contact with `surface` has become at `x`. The offset of
    /// a convex corner has no kinks, whichever feature is nearest.
    #[inline]
    pub(crate) fn project_near(&self, surface: Surface, x: DVec3) -> Projection {
        if matches!(surface, Surface::Plane(_) | Surface::Dome(_)) {
            return self.project(surface, x);
        }
        self.project(self.track(surface, x).unwrap_or(surface), x)
    }

    /// The edge itself, unless the ball has come over one of its faces or beyond one of its ends.
    fn around_edge(&self, k: u32, x: DVec3) -> Option<Surface> {
        let edge = &self.mesh.edges[k as usize];
        let along = edge.direction.dot(x - edge.origin);
        if along < 0.0 {
            return self.nearest([edge.ends[0]], x);
        }
        if along > edge.length {
            return self.nearest([edge.ends[1]], x);
        }
        let over = edge.faces.iter().flatten().find(|&&f| {
            let face = &self.mesh.faces[f as usize];
            let height = face.normal.dot(x) - face.offset;
            height >= 0.0 && face.inside(x - face.normal * height) > 0.0
        });
        Some(over.map_or(Surface::Edge(k), |&f| Surface::Face(f)))
    }

    /// Nearest feature of the triangles around some vertices; the lowest triangle where several are equally near.
    fn nearest<const N: usize>(&self, vertices: [u32; N], x: DVec3) -> Option<Surface> {
        let mut best: Option<(f64, Surface)> = None;
        for v in vertices {
            for &f in self.mesh.around_vertex(v) {
                let (squared, surface) = self.nearest_on(f, x);
                let better = best.is_none_or(|(d, s)| squared < d || (squared == d && surface < s));
                if better {
                    best = Some((squared, surface));
                }
            }
        }
        best.map(|(_, s)| s)
    }

    /// Squared distance of `x` from a triangle, and its nearest part. A point behind the face counts as far, because
    /// its solid is there.
    fn nearest_on(&self, f: u32, x: DVec3) -> (f64, Surface) {
        let face = &self.mesh.faces[f as usize];
        let height = face.normal.dot(x) - face.offset;
        let projection = x - face.normal * height;
        if face.inside(projection) >= 0.0 {
            let squared = if height >= 0.0 { height * height } else { f64::INFINITY };
            return (squared, Surface::Face(f));
        }
        let mut best = (f64::INFINITY, Surface::Face(f));
        for side in 0..3 {
            let (a, b) = (face.corners[side], face.corners[(side + 1) % 3]);
            let (p, q) = (self.mesh.vertices[a as usize], self.mesh.vertices[b as usize]);
            let along = q - p;
            let part = (x - p).dot(along) / along.length_squared();
            let (squared, surface) = if part <= 0.0 {
                ((x - p).length_squared(), Surface::Vertex(a))
            } else if part >= 1.0 {
                ((x - q).length_squared(), Surface::Vertex(b))
            } else {
                let Some(e) = self.mesh.edge_between(a, b) else { continue };
                ((x - p - along * part).length_squared(), Surface::Edge(e))
            };
            if squared < best.0 {
                best = (squared, surface);
            }
        }
        best
    }

    /// Deepest overlap of a ball with the scenery: a surface and the depth in m, if any. For checking worlds and
    /// results, not for stepping.
    #[must_use]
    pub fn deepest_overlap(&self, x: DVec3, radius: f64) -> Option<(Surface, f64)> {
        let mut worst: Option<(Surface, f64)> = None;
        let mut note = |surface, depth: f64| {
            if depth > 0.0 && worst.is_none_or(|(_, d)| depth > d) {
                worst = Some((surface, depth));
            }
        };
        for (k, plane) in self.planes.iter().enumerate() {
            note(Surface::Plane(k as u32), radius - plane.distance(x));
        }
        for &item in self.grid.items(self.grid.cell_of(x)) {
            match self.surface(item) {
                Surface::Face(f) => {
                    let (squared, surface) = self.nearest_on(f, x);
                    // Behind a face, but nearer to it than to its back: the centre itself is inside the solid.
                    let face = &self.mesh.faces[f as usize];
                    let height = face.normal.dot(x) - face.offset;
                    if squared.is_finite() {
                        note(surface, radius - squared.sqrt());
                    } else if height > -radius
                        && face.inside(x - face.normal * height) > 0.0
                        && !self.is_shielded(f, x, -height)
                    {
                        note(surface, radius - height);
                    }
                }
                Surface::Dome(k) => {
                    let dome = &self.domes[k as usize];
                    if dome.project(x).is_some() {
                        note(Surface::Dome(k), radius - dome.normal_and_distance(x).1);
                    }
                }
                _ => {}
            }
        }
        worst
    }

    /// Whether another face that faces the other way lies in front of `x`, nearer than `depth`: then `x` is outside,
    /// beyond a thin wall.
    fn is_shielded(&self, f: u32, x: DVec3, depth: f64) -> bool {
        let behind = self.mesh.faces[f as usize].normal;
        self.grid.items(self.grid.cell_of(x)).iter().any(|&item| match self.surface(item) {
            Surface::Face(g) if g != f => {
                let face = &self.mesh.faces[g as usize];
                let height = face.normal.dot(x) - face.offset;
                face.normal.dot(behind) < 0.0
                    && height >= 0.0
                    && height < depth
                    && face.inside(x - face.normal * height) >= 0.0
            }
            _ => false,
        })
    }
}

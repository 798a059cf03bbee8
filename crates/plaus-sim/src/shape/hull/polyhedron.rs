//! A convex polyhedron: corners, edges, faces, and which of them meet.

use super::wrap::{around, newell};
use glam::DVec3;

/// Maximum number of corners of a polyhedron: sets of them are the bits of a number.
pub(crate) const MOST_CORNERS: usize = 64;

/// Maximum number of edges: that of a surface of triangles only, `3n − 6`.
pub(crate) const MOST_EDGES: usize = 3 * MOST_CORNERS - 6;

/// Maximum number of faces, `2n − 4`.
pub(crate) const MOST_FACES: usize = 2 * MOST_CORNERS - 4;

/// A face: `normal · x ≤ offset` within the polyhedron.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Face {
    pub(crate) normal: DVec3,
    pub(crate) offset: f64,
    /// Its corners, anticlockwise as seen from outside.
    pub(crate) corners: Vec<u8>,
    /// The same as a set.
    pub(crate) set: u64,
}

/// An edge from its first corner to its second, anticlockwise about its first face.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Edge {
    pub(crate) ends: [u8; 2],
    pub(crate) faces: [u8; 2],
    /// Unit vector.
    pub(crate) along: DVec3,
    pub(crate) length: f64,
}

/// A convex polyhedron about the origin of its axes; or a single point, the core of a ball.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Polyhedron {
    pub(crate) corners: Vec<DVec3>,
    pub(crate) faces: Vec<Face>,
    pub(crate) edges: Vec<Edge>,
    /// Largest distance of a corner from the origin, and least distance of a face's plane.
    pub(crate) bounding_radius: f64,
    pub(crate) inner_radius: f64,
    /// The coordinates of the corners, in fours, of which the last may hold the last corner several times.
    fours: Vec<[[f64; 4]; 3]>,
    /// Half the edges, if it is a cuboid along its axes: corner k is at the upper end of axis i if bit i of k is set.
    half: Option<DVec3>,
}

/// Distance over the size up to which a point behind a face's plane still counts as seen from the face: above what a
/// face's corners may be off its plane. Default 1e-8.
const VISIBLE: f64 = 1e-8;

/// The part of a polyhedron that is nearest to a point.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum On {
    Face(u8),
    Edge(u8),
    Corner(u8),
}

impl Polyhedron {
    /// From corners (at most [`MOST_CORNERS`]) and loops of their indices that form a closed surface.
    pub(crate) fn new(corners: Vec<DVec3>, loops: &[Vec<usize>]) -> Self {
        let mut edges: Vec<Edge> = Vec::new();
        for (k, face) in loops.iter().enumerate() {
            for (a, b) in around(face) {
                let ends = [a as u8, b as u8];
                match edges.iter_mut().find(|e| e.ends == [ends[1], ends[0]]) {
                    Some(edge) => edge.faces[1] = k as u8,
                    None => {
                        let way = corners[b] - corners[a];
                        let length = way.length();
                        edges.push(Edge { ends, faces: [k as u8; 2], along: way / length, length });
                    }
                }
            }
        }
        let face = |face: &Vec<usize>| {
            let normal = newell(&corners, face);
            let offset = face.iter().map(|&k| normal.dot(corners[k])).fold(f64::NEG_INFINITY, f64::max);
            let set = face.iter().fold(0, |set, &k| set | 1 << k);
            Face { normal, offset, corners: face.iter().map(|&k| k as u8).collect(), set }
        };
        let faces: Vec<Face> = loops.iter().map(face).collect();
        let bounding_radius = corners.iter().map(|c| c.length()).fold(0.0, f64::max);
        let inner_radius = faces.iter().map(|f| f.offset).fold(f64::INFINITY, f64::min).max(0.0);
        let four = |four: &[DVec3]| {
            let at = |k: usize| four[k.min(four.len() - 1)];
            std::array::from_fn(|axis| std::array::from_fn(|k| at(k)[axis]))
        };
        let fours = corners.chunks(4).map(four).collect();
        Self { corners, faces, edges, bounding_radius, inner_radius, fours, half: None }
    }

    /// The core of a ball.
    pub(crate) fn point() -> Self {
        Self { inner_radius: 0.0, ..Self::new(vec![DVec3::ZERO], &[]) }
    }

    /// A cuboid with these half edges along the axes.
    pub(crate) fn cuboid(half: DVec3) -> Self {
        let corner = |k: usize| {
            DVec3::from_array(std::array::from_fn(|axis| if k >> axis & 1 == 1 { half[axis] } else { -half[axis] }))
        };
        // Each side runs anticlockwise: along the next axis first if the side is at the upper end.
        let side = |axis: usize, upper: usize| {
            let (i, j) = (1 << ((axis + 1) % 3), 1 << ((axis + 2) % 3));
            let base = upper << axis;
            if upper == 1 {
                vec![base, base | i, base | i | j, base | j]
            } else {
                vec![base, base | j, base | i | j, base | i]
            }
        };
        let loops: Vec<Vec<usize>> = (0..6).map(|k| side(k / 2, k % 2)).collect();
        Self { half: Some(half), ..Self::new((0..8).map(corner).collect(), &loops) }
    }

    /// Half the edges of a cuboid.
    #[inline]
    pub(crate) fn half(&self) -> Option<DVec3> {
        self.half
    }

    /// Whether it is a single point: the core of a ball.
    #[inline]
    pub(crate) fn is_point(&self) -> bool {
        self.faces.is_empty()
    }

    /// How far the polyhedron reaches in a direction.
    #[inline]
    pub(crate) fn support(&self, direction: DVec3) -> f64 {
        if let Some(half) = self.half {
            return half.dot(direction.abs());
        }
        let mut most = [f64::NEG_INFINITY; 4];
        for [x, y, z] in &self.fours {
            for k in 0..4 {
                let along = x[k] * direction.x + y[k] * direction.y + z[k] * direction.z;
                most[k] = if along > most[k] { along } else { most[k] };
            }
        }
        most[0].max(most[1]).max(most[2].max(most[3]))
    }

    /// The corner farthest in a direction, and how far; the first one if several are equally far.
    #[inline]
    pub(crate) fn farthest(&self, direction: DVec3) -> (u8, f64) {
        if let Some(half) = self.half {
            let bit = |axis: usize| u8::from(direction[axis] > 0.0) << axis;
            return (bit(0) | bit(1) | bit(2), half.dot(direction.abs()));
        }
        let most = self.support(direction);
        let first = self.corners.iter().position(|c| c.dot(direction) >= most);
        (first.unwrap_or(0) as u8, most)
    }

    pub(crate) fn corner(&self, k: u8) -> DVec3 {
        self.corners[usize::from(k)]
    }

    pub(crate) fn face(&self, k: u8) -> &Face {
        &self.faces[usize::from(k)]
    }

    pub(crate) fn edge(&self, k: u8) -> &Edge {
        &self.edges[usize::from(k)]
    }

    /// Whether a point over a face is within its sides, or beyond them by at most `slack`.
    #[inline]
    pub(crate) fn is_over(&self, face: u8, p: DVec3, slack: f64) -> bool {
        let f = self.face(face);
        let ends = f.corners.iter().zip(f.corners.iter().cycle().skip(1));
        ends.into_iter().all(|(&a, &b)| {
            let (a, b) = (self.corner(a), self.corner(b));
            let out = (b - a).cross(f.normal);
            out.dot(p - a) <= slack * (b - a).length()
        })
    }

    /// Where on an edge's line the projection of a point is, from its first end, in m.
    #[inline]
    pub(crate) fn along(&self, edge: u8, p: DVec3) -> f64 {
        let e = self.edge(edge);
        (p - self.corner(e.ends[0])).dot(e.along)
    }

    /// The edge or corner that is nearest to a point, and the square of the distance.
    pub(crate) fn nearest_edge(&self, p: DVec3) -> (On, f64) {
        self.nearest_edge_of(p, |_| true, |_| true)
    }

    /// The same among some corners and edges.
    fn nearest_edge_of(
        &self,
        p: DVec3,
        is_corner: impl Fn(usize) -> bool,
        is_edge: impl Fn(&Edge) -> bool,
    ) -> (On, f64) {
        let mut best = (On::Corner(0), f64::INFINITY);
        for (k, c) in self.corners.iter().enumerate().filter(|(k, _)| is_corner(*k)) {
            let squared = (p - *c).length_squared();
            if squared < best.1 {
                best = (On::Corner(k as u8), squared);
            }
        }
        for (k, e) in self.edges.iter().enumerate().filter(|(_, e)| is_edge(e)) {
            let from = p - self.corner(e.ends[0]);
            let along = from.dot(e.along);
            if along > 0.0 && along < e.length {
                let squared = (from - e.along * along).length_squared();
                if squared < best.1 {
                    best = (On::Edge(k as u8), squared);
                }
            }
        }
        best
    }

    /// How far a point is beyond the plane of each face; negative inside.
    #[inline]
    pub(crate) fn beyond<'r>(&self, p: DVec3, room: &'r mut [f64; MOST_FACES]) -> &'r [f64] {
        for (face, beyond) in self.faces.iter().zip(room.iter_mut()) {
            *beyond = face.normal.dot(p) - face.offset;
        }
        &room[..self.faces.len()]
    }

    /// The part that is nearest to a point outside.
    pub(crate) fn nearest(&self, p: DVec3) -> On {
        self.nearest_of(p, self.beyond(p, &mut [0.0; MOST_FACES]))
    }

    /// The same if it is known how far the point is beyond each face.
    pub(crate) fn nearest_of(&self, p: DVec3, beyond: &[f64]) -> On {
        for (k, &above) in beyond.iter().enumerate() {
            if above > 0.0 && self.is_over(k as u8, p, 0.0) {
                return On::Face(k as u8);
            }
        }
        // What is nearest belongs to a face that sees the point.
        let level = -VISIBLE * self.bounding_radius;
        let corners = self.faces.iter().zip(beyond).filter(|(_, b)| **b > level).fold(0, |set, (f, _)| set | f.set);
        if corners == 0 {
            return self.nearest_edge(p).0;
        }
        let sees = |e: &Edge| e.faces.iter().any(|&f| beyond[usize::from(f)] > level);
        self.nearest_edge_of(p, |k| corners >> k & 1 == 1, sees).0
    }

    /// The face whose plane a point is farthest beyond, and how far; negative inside.
    pub(crate) fn farthest_face(&self, p: DVec3) -> Option<(u8, f64)> {
        farthest(self.faces.iter().map(|face| face.normal.dot(p) - face.offset))
    }

    /// Whether it has an inside. A triangle has none: a point in its plane is on the inner side of both its faces, also
    /// if it is far beside it.
    pub(crate) fn has_inside(&self) -> bool {
        self.faces.len() > 2
    }

    /// The corners that span a part of the surface, as a set.
    pub(crate) fn spanning(&self, on: On) -> u64 {
        match on {
            On::Face(k) => self.face(k).set,
            On::Edge(k) => self.edge(k).ends.iter().fold(0, |set, &end| set | 1 << end),
            On::Corner(k) => 1 << k,
        }
    }

    /// Points on edges and faces, no farther apart than about `spacing`, without the corners; at most 16 intervals per
    /// edge.
    pub(crate) fn between(&self, spacing: f64) -> Vec<DVec3> {
        let intervals = |length: f64| (length / spacing).ceil().clamp(1.0, 16.0) as usize;
        let mut points = Vec::new();
        for e in &self.edges {
            let (from, n) = (self.corner(e.ends[0]), intervals(e.length));
            points.extend((1..n).map(|k| from + e.along * (e.length * (k as f64 / n as f64))));
        }
        for f in &self.faces {
            let first = self.corner(f.corners[0]);
            let rest = &f.corners[1..];
            for (k, pair) in rest.windows(2).enumerate() {
                let (p, q) = (self.corner(pair[0]) - first, self.corner(pair[1]) - first);
                let n = intervals(p.length().max(q.length()).max((p - q).length()));
                let at = |i: usize, j: usize| first + (p * i as f64 + q * j as f64) / n as f64;
                for i in 1..n {
                    // The inside of each triangle, and the diagonal towards the next.
                    points.extend((1..n - i).map(|j| at(i, j)));
                    if k + 2 < rest.len() {
                        points.push(at(0, i));
                    }
                }
            }
        }
        points
    }
}

/// The face that a point is farthest beyond, and how far; of those that are equally far, the first.
pub(crate) fn farthest(beyond: impl Iterator<Item = f64>) -> Option<(u8, f64)> {
    let mut best: Option<(u8, f64)> = None;
    for (k, beyond) in beyond.enumerate() {
        if best.is_none_or(|(_, most)| beyond > most) {
            best = Some((k as u8, beyond));
        }
    }
    best
}

//! Edges against edges.

use super::nearest::SLACK;
use super::{Feature, HullPair, Meeting, PARALLEL};
use crate::shape::hull::{Face, MOST_EDGES, MOST_FACES};
use glam::DVec3;

/// An edge in the world: its direction, its middle about its polyhedron's centre, and half its length.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct PlacedEdge {
    along: DVec3,
    middle: DVec3,
    half: f64,
}

/// The nearest points of two edges' lines.
#[derive(Debug)]
pub(super) struct NearestOnLines {
    /// From the second's middle to the first's.
    between: DVec3,
    cross: DVec3,
    /// The square of the sine of the angle between them.
    pub(super) sine: f64,
    /// The points, as distances from the middles.
    at: [f64; 2],
    /// By how much they are within the ends of their edges, in m.
    pub(super) within: f64,
}

impl HullPair<'_> {
    /// An edge in the world.
    #[inline]
    pub(super) fn edge(&self, of: usize, edge: u8) -> PlacedEdge {
        let hull = &self.hulls[of];
        let edge = hull.core.edge(edge);
        let half = 0.5 * edge.length;
        // From the middle, so that both ends are equally exact.
        let middle = hull.axes * (hull.core.corner(edge.ends[0]) + edge.along * half);
        PlacedEdge { along: hull.axes * edge.along, middle, half }
    }

    /// Whether points of two edges may be within `reach` of each other.
    #[inline]
    pub(super) fn may_cross(&self, e: &PlacedEdge, g: &PlacedEdge, reach: f64) -> bool {
        let most = (e.half + g.half + reach) * (1.0 + SLACK);
        (self.offset + (e.middle - g.middle)).length_squared() <= most * most
    }

    /// The nearest points of the lines of two edges.
    #[inline]
    pub(super) fn nearest_on_lines(&self, e: &PlacedEdge, g: &PlacedEdge) -> NearestOnLines {
        let between = self.offset + (e.middle - g.middle);
        let (cross, cosine) = (e.along.cross(g.along), e.along.dot(g.along));
        let sine = cross.length_squared();
        let (along_e, along_g) = (between.dot(e.along), between.dot(g.along));
        let s = (cosine * along_g - along_e) / sine;
        let t = (along_g - cosine * along_e) / sine;
        let within = (e.half - s.abs()).min(g.half - t.abs());
        NearestOnLines { between, cross, sine, at: [s, t], within: if within.is_nan() { -1.0 } else { within } }
    }

    /// The meeting of two edges as lines, its normal on the side of `towards`; also by how much the points are within
    /// the ends of their edges, in m.
    pub(super) fn at_edges(&self, [i, j]: [u8; 2], towards: DVec3) -> (Meeting, f64) {
        let (e, g) = (self.edge(0, i), self.edge(1, j));
        let lines = self.nearest_on_lines(&e, &g);
        (self.at_lines([(i, &e), (j, &g)], &lines, towards), lines.within)
    }

    /// The meeting of two edges whose lines' nearest points are known.
    pub(super) fn at_lines(
        &self,
        [(i, e), (j, g)]: [(u8, &PlacedEdge); 2],
        lines: &NearestOnLines,
        towards: DVec3,
    ) -> Meeting {
        let NearestOnLines { between, cross, sine, at: [s, t], .. } = *lines;
        let normal = if sine < PARALLEL * PARALLEL {
            towards
        } else {
            cross * (if cross.dot(towards) < 0.0 { -1.0 } else { 1.0 } / cross.length())
        };
        let clamped = |x: f64, most: f64| if x.is_nan() { 0.0 } else { x.clamp(-most, most) };
        let points = [e.middle + e.along * clamped(s, e.half), g.middle + g.along * clamped(t, g.half)];
        self.meeting(points, normal, normal.dot(between), Feature::Edges(i, j))
    }

    /// The pair of edges whose common perpendicular keeps the cores farthest apart, if farther than `least`; also that
    /// direction, towards the first.
    ///
    /// Only pairs whose perpendicular is a normal of both surfaces count: on the sphere of normals, the arcs between
    /// the faces of the edges must cross (Gregorius, "The separating axis test between convex polyhedra", GDC 2013).
    pub(super) fn best_edges(&self, least: f64) -> Option<(f64, [u8; 2], DVec3)> {
        // As little room as will do: clearing room for the largest polyhedra takes longer than a box needs in all.
        let b = self.hulls[1].core;
        match (b.edges.len(), b.faces.len()) {
            (..=12, ..=8) => self.best_edges_in::<12, 8>(least),
            (..=48, ..=32) => self.best_edges_in::<48, 32>(least),
            _ => self.best_edges_in::<MOST_EDGES, MOST_FACES>(least),
        }
    }

    /// The same if the second has at most `E` edges and `F` faces.
    ///
    /// A normal between those of an edge's two faces, with the cosine `c` of the angle between them, keeps the cores no
    /// farther apart than `√(2/(1 + c))` times how far the other's centre is beyond the farther face, less the radius
    /// of a ball about that centre within the other. So edges on the sides that face away are left out at once.
    fn best_edges_in<const E: usize, const F: usize>(&self, least: f64) -> Option<(f64, [u8; 2], DVec3)> {
        let [a, b] = self.hulls.map(|h| h.core);
        let flat = [a, b].map(|h| h.faces.len() == 2);
        let into = &self.across[0];
        let slack = SLACK * self.size;
        let inner = [b.inner_radius, a.inner_radius];
        let may_win = |of: usize, [n, m]: [DVec3; 2], [x, y]: [f64; 2]| {
            let most = x.max(y).max(0.0) * (2.0 / (1.0 + n.dot(m))).sqrt() - inner[of];
            most >= least - slack || most.is_nan()
        };
        let beyond = |of: usize, face: &Face| face.normal.dot(self.other[of]) - face.offset;
        // The second's normals in the first's axes, and how far the first's centre is beyond its faces.
        let (mut normals, mut seen) = ([DVec3::ZERO; F], [0.0; F]);
        for (k, face) in b.faces.iter().enumerate() {
            normals[k] = *into * face.normal;
            seen[k] = beyond(1, face);
        }
        // Its edges that count, their directions and their first corners.
        let (mut counting, mut along, mut from) = ([0_u8; E], [DVec3::ZERO; E], [DVec3::ZERO; E]);
        let mut count = 0;
        for (k, e) in b.edges.iter().enumerate() {
            let faces = e.faces.map(usize::from);
            if flat[1] || may_win(1, faces.map(|f| b.faces[f].normal), faces.map(|f| seen[f])) {
                counting[count] = k as u8;
                along[count] = *into * e.along;
                from[count] = self.other[0] + *into * b.corner(e.ends[0]);
                count += 1;
            }
        }
        let mut best = None;
        let mut most = least;
        let mut slants = [0.0; F];
        for (i, e) in a.edges.iter().enumerate() {
            let faces = e.faces.map(|f| a.face(f));
            if !flat[0] && !may_win(0, faces.map(|f| f.normal), faces.map(|f| beyond(0, f))) {
                continue;
            }
            for (slant, normal) in slants.iter_mut().zip(&normals[..b.faces.len()]) {
                *slant = normal.dot(e.along);
            }
            let [n, m] = faces.map(|f| f.normal);
            let start = a.corner(e.ends[0]);
            for (j, &edge) in counting[..count].iter().enumerate() {
                let g = b.edge(edge);
                let [x, y] = g.faces.map(|k| slants[usize::from(k)]);
                if x * y >= 0.0 {
                    continue;
                }
                let (u, v) = (n.dot(along[j]), m.dot(along[j]));
                let is_flat = flat[0] || flat[1];
                if u * v >= 0.0 || (!is_flat && x * v >= 0.0) {
                    continue;
                }
                let cross = e.along.cross(along[j]);
                let sine = cross.length_squared();
                if sine < PARALLEL * PARALLEL {
                    continue;
                }
                // The normals at an edge of a triangle fill half a circle about the outward direction in the triangle's
                // plane.
                let outward = if flat[0] { e.along.cross(n) } else { n + m };
                let out = if cross.dot(outward) < 0.0 { -cross } else { cross };
                if is_flat {
                    let [n, m] = g.faces.map(|k| normals[usize::from(k)]);
                    if out.dot(if flat[1] { along[j].cross(n) } else { n + m }) >= 0.0 {
                        continue;
                    }
                }
                let apart = (from[j] - start).dot(out);
                // Where it cannot win, the root is not taken.
                if most > 0.0 && (apart <= 0.0 || apart * apart <= most * most * sine) {
                    continue;
                }
                let apart = apart / sine.sqrt();
                if apart > most {
                    most = apart;
                    best = Some((apart, [i as u8, edge], out));
                }
            }
        }
        best.map(|(apart, edges, out)| (apart, edges, self.hulls[0].axes * -out))
    }
}

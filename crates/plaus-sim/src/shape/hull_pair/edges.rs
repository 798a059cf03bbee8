//! Edges against edges.

use super::{Feature, HullPair, Meeting, PARALLEL};
use crate::shape::hull::{Face, MOST_EDGES, MOST_FACES};
use glam::DVec3;

impl HullPair<'_> {
    /// The directions of one edge of each polyhedron, in the world.
    pub(super) fn along(&self, [i, j]: [u8; 2]) -> [DVec3; 2] {
        let [a, b] = &self.hulls;
        [a.axes * a.core.edge(i).along, b.axes * b.core.edge(j).along]
    }

    /// The meeting of two edges as lines, its normal on the side of `towards`; also by how much the points are within
    /// the ends of their edges, in m.
    pub(super) fn at_edges(&self, [i, j]: [u8; 2], towards: DVec3) -> (Meeting, f64) {
        let [a, b] = &self.hulls;
        let [e, g] = self.along([i, j]);
        let (first, second) = (a.core.edge(i), b.core.edge(j));
        // From the middles, so that both ends are equally exact.
        let p = a.axes * (a.core.corner(first.ends[0]) + first.along * (0.5 * first.length));
        let q = b.axes * (b.core.corner(second.ends[0]) + second.along * (0.5 * second.length));
        let between = self.offset + (p - q);
        let (cross, cosine) = (e.cross(g), e.dot(g));
        let sine = cross.length_squared();
        let normal = if sine < PARALLEL * PARALLEL {
            towards
        } else {
            cross * (if cross.dot(towards) < 0.0 { -1.0 } else { 1.0 } / cross.length())
        };
        let (along_e, along_g) = (between.dot(e), between.dot(g));
        let s = (cosine * along_g - along_e) / sine;
        let t = (along_g - cosine * along_e) / sine;
        let (most_s, most_t) = (0.5 * first.length, 0.5 * second.length);
        let within = (most_s - s.abs()).min(most_t - t.abs());
        let clamped = |x: f64, most: f64| if x.is_nan() { 0.0 } else { x.clamp(-most, most) };
        let points = [p + e * clamped(s, most_s), q + g * clamped(t, most_t)];
        let feature = Feature::Edges(i, j);
        (self.meeting(points, normal, normal.dot(between), feature), if within.is_nan() { -1.0 } else { within })
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
    /// No normal between those of an edge's two faces keeps the cores farther apart than the other's centre is beyond
    /// both faces, if it is beyond neither. So edges on the sides that face away are left out at once.
    fn best_edges_in<const E: usize, const F: usize>(&self, least: f64) -> Option<(f64, [u8; 2], DVec3)> {
        let [a, b] = self.hulls.map(|h| h.core);
        let flat = [a, b].map(|h| h.faces.len() == 2);
        let into = &self.across[0];
        let cut = least.min(0.0);
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
            if flat[1] || e.faces.iter().any(|&f| seen[usize::from(f)] > cut) {
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
            if !flat[0] && e.faces.iter().all(|&f| beyond(0, a.face(f)) <= cut) {
                continue;
            }
            for (slant, normal) in slants.iter_mut().zip(&normals[..b.faces.len()]) {
                *slant = normal.dot(e.along);
            }
            let [n, m] = e.faces.map(|k| a.face(k).normal);
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

//! All points at which two polyhedra touch: corners near the other's surface, and crossings of edges near the plane of
//! contact.

use super::edges::PlacedEdge;
use super::{HullPair, Meeting, PARALLEL};
use crate::shape::Within;
use crate::shape::hull::{MOST_EDGES, MOST_FACES, On, farthest};
use glam::DVec3;

/// Cosine of the largest angle between a point's own normal and that of the nearest points. Default ½; points with a
/// larger angle belong to sides that do not face each other.
const FACING: f64 = 0.5;

/// Sine of the slope against the plane of contact up to which an edge's crossings are examined: a steeper edge touches
/// at its corner. Default ½.
const STEEP: f64 = 0.5;

impl HullPair<'_> {
    /// Calls `each` for the points `within` a gap, given the nearest points. There is at least one if the nearest
    /// points are that near.
    pub(crate) fn touching(&self, nearest: &Meeting, within: impl Into<Within>, mut each: impl FnMut(Meeting)) {
        let within = within.into();
        if nearest.gap > within.gap {
            return;
        }
        let mut found = false;
        let mut take = |m: Meeting| {
            if m.gap <= within.gap && m.normal.dot(nearest.normal) > FACING {
                found = true;
                each(m);
            }
        };
        for of in 0..2 {
            // The level up to which a corner can be near the other polyhedron.
            let [own, other] = [&self.hulls[of], &self.hulls[1 - of]];
            let out = if of == 0 { nearest.normal } else { -nearest.normal };
            let other_out = other.axes.transpose() * out;
            let level = other.core.support(other_out)
                + within.gap
                + self.roundings()
                + self.other[of].dot(own.axes.transpose() * out);
            let own_out = own.axes.transpose() * out;
            for corner in 0..own.core.corners.len() as u8 {
                if own.core.corner(corner).dot(own_out) <= level
                    && let Some(on) = self.region(of, corner, nearest, within)
                {
                    take(self.at_corner(of, corner, on).0);
                }
            }
        }
        self.crossings(nearest.normal, FACING, [within.gap, within.beside], &mut take);
        if !found {
            each(*nearest);
        }
    }

    /// The part of the other polyhedron that a corner is near, if it can be near. A corner hardly beyond a face counts
    /// as above the face next to it.
    fn region(&self, of: usize, corner: u8, nearest: &Meeting, within: Within) -> Option<On> {
        let other = self.hulls[1 - of].core;
        let seen = self.corner_seen(of, corner);
        // A corner may also be beside a face by as much, of whose edge two others are as far.
        let beyond = (within.gap + self.roundings()).max(0.0) + 2.0 * within.beside.max(0.0);
        if seen.length() > other.bounding_radius + beyond {
            return None;
        }
        let mut room = [0.0; MOST_FACES];
        let above = other.beyond(seen, &mut room);
        let on = match farthest(above.iter().copied()) {
            // The core of a ball.
            None => On::Corner(0),
            Some((_, top)) if top > within.gap + self.roundings() => return None,
            // Beside a triangle, which has no faces there.
            Some((face, _)) if other.faces.len() == 2 && !other.is_over(face, seen, within.beside) => {
                other.nearest_edge(seen).0
            }
            Some((_, top)) => {
                let mut sides = (0..above.len()).filter(|&k| above[k] > within.beside);
                match (sides.next(), sides.next()) {
                    (None, _) => {
                        // On the skin of the core or inside: among the faces no deeper than the nearest points are, the
                        // one that faces the other polyhedron most.
                        let deepest = top.min(nearest.gap + self.roundings()) - within.beside;
                        let out = self.hulls[1 - of].axes.transpose() * nearest.normal;
                        let out = if of == 0 { out } else { -out };
                        let faces = |k: usize| other.faces[k].normal.dot(out);
                        let near = (0..other.faces.len()).filter(|&k| above[k] >= deepest);
                        On::Face(near.max_by(|&k, &l| faces(k).total_cmp(&faces(l)))? as u8)
                    }
                    // Beyond a sharp edge, a point can be above one face only and yet not over it.
                    (Some(only), None) if other.is_over(only as u8, seen, within.beside) => On::Face(only as u8),
                    _ => other.nearest_of(seen, above),
                }
            }
        };
        // Two corners that meet are found from both sides.
        (of == 0 || !matches!(on, On::Corner(_))).then_some(on)
    }

    /// Calls `take` for the crossings of edges near the plane of contact that are inside the ends of both edges by more
    /// than `margin`; of those whose normal has at least the cosine `facing` with the plane's.
    pub(super) fn crossings(
        &self,
        normal: DVec3,
        facing: f64,
        [within, margin]: [f64; 2],
        mut take: impl FnMut(Meeting),
    ) {
        // Heights along the normal about the second centre.
        let base = self.offset.dot(normal);
        let lowest = base - self.hulls[0].core.support(self.hulls[0].axes.transpose() * -normal);
        let highest = self.hulls[1].core.support(self.hulls[1].axes.transpose() * normal);
        let bounding_radius = within + self.roundings();
        let mut edges = [[0_u8; MOST_EDGES]; 2];
        let mut counts = [0; 2];
        for of in 0..2 {
            let hull = &self.hulls[of];
            let lever = hull.axes.transpose() * normal;
            let is_near = |corner: u8| {
                let height = hull.core.corner(corner).dot(lever);
                if of == 0 { base + height - bounding_radius <= highest } else { lowest - bounding_radius <= height }
            };
            let near = (0..hull.core.corners.len() as u8).fold(0_u64, |set, c| set | u64::from(is_near(c)) << c);
            for (k, e) in hull.core.edges.iter().enumerate() {
                if e.ends.iter().any(|&end| near >> end & 1 == 1) && e.along.dot(lever).abs() <= STEEP {
                    edges[of][counts[of]] = k as u8;
                    counts[of] += 1;
                }
            }
        }
        // In an overlap, edges are no deeper in each other along the plane's normal than the cores are.
        let reach = bounding_radius.max((highest - lowest) / facing) - 2.0 * margin.min(0.0);
        let placed = [0, 1].map(|of| &edges[of][..counts[of]]);
        // As little room as will do, as in `best_edges`.
        match counts[1] {
            ..=12 => self.crossings_of::<12>(placed, normal, [reach, margin], &mut take),
            13..=48 => self.crossings_of::<48>(placed, normal, [reach, margin], &mut take),
            _ => self.crossings_of::<MOST_EDGES>(placed, normal, [reach, margin], &mut take),
        }
    }

    /// The same for some edges, of which the second has at most `E`.
    fn crossings_of<const E: usize>(
        &self,
        edges: [&[u8]; 2],
        normal: DVec3,
        [reach, margin]: [f64; 2],
        take: &mut impl FnMut(Meeting),
    ) {
        let mut others = [(0_u8, PlacedEdge::default()); E];
        for (other, &j) in others.iter_mut().zip(edges[1]) {
            *other = (j, self.edge(1, j));
        }
        for &i in edges[0] {
            let e = self.edge(0, i);
            for (j, g) in &others[..edges[1].len()] {
                if !self.may_cross(&e, g, reach) {
                    continue;
                }
                let lines = self.nearest_on_lines(&e, g);
                // At the end of an edge, its corner is examined instead.
                if lines.sine >= PARALLEL * PARALLEL && lines.within > margin {
                    take(self.at_lines([(i, &e), (*j, g)], &lines, normal));
                }
            }
        }
    }
}

//! All points at which two cuboids touch.

use super::{CuboidPair, Edge, Meeting, PARALLEL};
use crate::shape::Within;
use glam::DVec3;

/// Cosine of the largest angle between a point's own normal and that of the nearest points. Default ½; points with a
/// larger angle belong to sides that do not face each other.
const FACING: f64 = 0.5;

/// Sine of the slope against the plane of contact up to which an edge's crossings are examined: a steeper edge touches
/// at its corner. Default ½.
const STEEP: f64 = 0.5;

/// Maximum number of edges of one cuboid that can be near the plane of contact.
const MOST_EDGES: usize = 12;

impl CuboidPair {
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
            for corner in 0..8 {
                if let Some(region) = self.region(of, corner, nearest, within) {
                    take(self.at_corner(of, corner, region));
                }
            }
        }
        self.crossings(nearest.normal, within, &mut take);
        if !found {
            each(*nearest);
        }
    }

    /// The sides of the other cuboid that a corner is beyond, if it can be near. A corner hardly beyond a side counts
    /// as above the face next to it.
    fn region(&self, of: usize, corner: u8, nearest: &Meeting, within: Within) -> Option<[i8; 3]> {
        let other = &self.cuboids[1 - of];
        let seen = self.corner_seen(of, corner);
        let beyond = seen.abs() - other.core;
        let top = beyond.max_element();
        if top > within.gap + self.roundings() {
            return None;
        }
        let side = |k: usize| if seen[k] < 0.0 { -1 } else { 1 };
        let mut region = [0; 3];
        let mut sides = 0;
        for k in 0..3 {
            if beyond[k] > within.beside {
                region[k] = side(k);
                sides += 1;
            }
        }
        if sides == 0 {
            // On the skin of the core or inside: among the sides no deeper than the nearest points are, the one that
            // faces the other cuboid most.
            let deepest = top.min(nearest.gap + self.roundings()) - within.beside;
            let faces = |k: usize| {
                let cosine = other.axes.col(k).dot(nearest.normal) * f64::from(side(k));
                if of == 0 { cosine } else { -cosine }
            };
            let axis = (0..3).filter(|&k| beyond[k] >= deepest).max_by(|&k, &l| faces(k).total_cmp(&faces(l)))?;
            region[axis] = side(axis);
        }
        // Two corners that meet are found from both sides.
        (sides < 3 || of == 0).then_some(region)
    }

    /// Crossings of edges near the plane of contact.
    fn crossings(&self, normal: DVec3, within: Within, take: &mut impl FnMut(Meeting)) {
        let [a, b] = &self.cuboids;
        let levers = self.cuboids.map(|c| c.axes.transpose() * normal * c.core);
        let height = normal.dot(self.offset) - self.roundings() - within.gap;
        let lowest = height - levers[0].abs().element_sum();
        let highest = levers[1].abs().element_sum();
        let mut edges = [[Edge { axis: 0, corner: 0 }; MOST_EDGES]; 2];
        let mut counts = [0; 2];
        for of in 0..2 {
            let lever = levers[of];
            let at = |corner: u8| super::corner_at(lever, corner);
            let near = |corner: u8| {
                let h = at(corner).element_sum();
                if of == 0 { height + h <= highest } else { lowest <= h }
            };
            let near: u8 = (0..8).fold(0, |mask, c| mask | u8::from(near(c)) << c);
            for axis in 0..3_u8 {
                let k = usize::from(axis);
                if lever[k].abs() > STEEP * self.cuboids[of].core[k] {
                    continue;
                }
                for corner in (0..8_u8).filter(|c| c >> axis & 1 == 0) {
                    if near >> corner & 1 == 1 || near >> (corner | 1 << axis) & 1 == 1 {
                        edges[of][counts[of]] = Edge { axis, corner };
                        counts[of] += 1;
                    }
                }
            }
        }
        for &e in &edges[0][..counts[0]] {
            for &g in &edges[1][..counts[1]] {
                let (i, j) = (usize::from(e.axis), usize::from(g.axis));
                if self.sine_squared(i, j) < PARALLEL * PARALLEL {
                    continue;
                }
                let (meeting, [s, t]) = self.at_edges(e, g, normal);
                // At the end of an edge, its corner is examined instead.
                if s.abs() < a.core[i] - within.beside && t.abs() < b.core[j] - within.beside {
                    take(meeting);
                }
            }
        }
    }
}

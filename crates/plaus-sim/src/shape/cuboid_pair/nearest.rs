//! The distance of two cuboids.

use super::{CuboidPair, Edge, Meeting, PARALLEL, Placed};
use glam::DVec3;

/// By how much, over their size, an axis of two edges must keep cores farther apart than faces do in order to be
/// chosen: so that rounding decides nothing. Default 1e-12.
const SLACK: f64 = 1e-12;

/// Distance over the size below which cores count as touching, because the direction between their nearest points is
/// then meaningless. Default 1e-11.
const TOUCHING: f64 = 1e-11;

/// Distance over the size by which nearest points may be farther apart than the planes that separate the cores. Default
/// 1e-10, above rounding.
const TIE: f64 = 1e-10;

impl CuboidPair {
    /// The nearest points of two cuboids; for cores that overlap, the points along the axis of least overlap.
    pub(crate) fn nearest(&self) -> Meeting {
        let [a, b] = &self.cuboids;
        let size = a.core.element_sum() + b.core.element_sum();
        let (face, of, axis) = self.best_face();
        let edges = self.best_edges(face + SLACK * size);
        let best = edges.map_or(face, |(s, _, _)| s);
        if best <= TOUCHING * size {
            return match edges {
                Some((_, i, j)) => self.support_edges(i, j).0,
                None => self.support_corner(of, axis),
            };
        }
        if let Some((_, i, j)) = edges {
            let (meeting, [s, t]) = self.support_edges(i, j);
            if s.abs() <= a.core[i] && t.abs() <= b.core[j] {
                return meeting;
            }
        }
        let (corner_of, corner, region) = self.nearest_corner();
        let meeting = self.at_corner(corner_of, corner, region);
        if meeting.gap + self.roundings() <= self.apart(meeting.normal) + TIE * size {
            return meeting;
        }
        // Faces are so parallel that edges cross without an axis of their own: the face's axis keeps cores as far apart
        // as they are.
        self.support_corner(of, axis)
    }

    /// How far apart cores are along a direction.
    fn apart(&self, direction: DVec3) -> f64 {
        let half = |k: usize| {
            let Placed { axes, core, .. } = &self.cuboids[k];
            (axes.transpose() * direction * *core).abs().element_sum()
        };
        self.offset.dot(direction) - (half(0) + half(1))
    }

    /// The face whose normal keeps the cores farthest apart: how far, of which cuboid, along which axis.
    fn best_face(&self) -> (f64, usize, usize) {
        let mut best = (f64::NEG_INFINITY, 0, 0);
        for of in 0..2 {
            let (own, other) = (&self.cuboids[of], &self.cuboids[1 - of]);
            // Rows: the other's axes as seen along each of its own axes.
            let c = &self.across[of];
            let across = c.x_axis.abs() * other.core.x + c.y_axis.abs() * other.core.y + c.z_axis.abs() * other.core.z;
            let apart = self.other[of].abs() - own.core - across;
            for axis in 0..3 {
                if apart[axis] > best.0 {
                    best = (apart[axis], of, axis);
                }
            }
        }
        best
    }

    /// The pair of edges whose common perpendicular keeps the cores farthest apart, if farther than `least`.
    fn best_edges(&self, least: f64) -> Option<(f64, usize, usize)> {
        let [a, b] = &self.cuboids;
        let c = |i: usize, j: usize| self.across[0].col(j)[i];
        let d = -self.other[0];
        let mut best = None;
        let mut most = least;
        for i in 0..3 {
            let (k, l) = ((i + 1) % 3, (i + 2) % 3);
            for j in 0..3 {
                let (m, n) = ((j + 1) % 3, (j + 2) % 3);
                let sine = self.sine_squared(i, j);
                if sine < PARALLEL * PARALLEL {
                    continue;
                }
                let apart = (d[l] * c(k, j) - d[k] * c(l, j)).abs()
                    - (a.core[k] * c(l, j).abs() + a.core[l] * c(k, j).abs())
                    - (b.core[m] * c(i, n).abs() + b.core[n] * c(i, m).abs());
                // Where it cannot win, the root is not taken.
                if apart > 0.0 && apart * apart <= most * most * sine && most > 0.0 {
                    continue;
                }
                let apart = apart / sine.sqrt();
                if apart > most {
                    most = apart;
                    best = Some((apart, i, j));
                }
            }
        }
        best
    }

    /// The edges along two axes that face each other.
    fn support_edges(&self, i: usize, j: usize) -> (Meeting, [f64; 2]) {
        let [a, b] = &self.cuboids;
        let cross = a.axes.col(i).cross(b.axes.col(j));
        let normal = if cross.dot(self.offset) < 0.0 { -cross } else { cross };
        let low = self.side(0, -normal) & !(1 << i);
        let high = self.side(1, normal) & !(1 << j);
        let edge = |axis: usize, corner| Edge { axis: axis as u8, corner };
        self.at_edges(edge(i, low), edge(j, high), normal)
    }

    /// The corner of a cuboid farthest in a direction.
    fn side(&self, of: usize, direction: DVec3) -> u8 {
        let axes = &self.cuboids[of].axes;
        (0..3).fold(0, |corner, k| corner | u8::from(axes.col(k).dot(direction) > 0.0) << k)
    }

    /// The corner of the other cuboid that is deepest below a face.
    fn support_corner(&self, of: usize, axis: usize) -> Meeting {
        let side = if self.other[of][axis] < 0.0 { -1 } else { 1 };
        let mut region = [0; 3];
        region[axis] = side;
        let normal = self.cuboids[of].axes.col(axis) * f64::from(side);
        self.at_corner(1 - of, self.side(1 - of, -normal), region)
    }

    /// If cores are apart: the corner that is nearest to the other cuboid.
    fn nearest_corner(&self) -> (usize, u8, [i8; 3]) {
        let (mut least, mut best) = (f64::INFINITY, (0, 0, DVec3::ZERO));
        for of in 0..2 {
            let core = self.cuboids[1 - of].core;
            for corner in 0..8 {
                let seen = self.corner_seen(of, corner);
                let away = seen - seen.clamp(-core, core);
                let squared = away.length_squared();
                if squared < least {
                    least = squared;
                    best = (of, corner, away);
                }
            }
        }
        let (of, corner, away) = best;
        let side = |x: f64| i8::from(x > 0.0) - i8::from(x < 0.0);
        (of, corner, away.to_array().map(side))
    }
}

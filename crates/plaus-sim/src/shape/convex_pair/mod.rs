//! Two convex pieces of any kind: how far apart they are, where they are nearest, and the points at which they touch.
//! This algorithm serves all pairs that have no other.
//!
//! The signed distance from a point to a core is known in closed form and is a convex function of the point; so is the
//! core's support function. The nearest features of two cores are a corner, an edge or a rim of one of them against the
//! other, or they lie along the normal of a face or of two sides. So the distance is the least over corners (closed
//! form), edges (the root of a monotone function), rims (the same between samples), and those normals: no simplex, and
//! no tolerance at which an iteration ends. Two polyhedra have a search of their own (`hull_pair`). If cores overlap,
//! the depth is that along the best of the same directions.
//!
//! If a direction keeps the cores as far apart as two of their points, these points are proved to be the nearest. The
//! tests use this proof, and compare with another library.

mod edge;
mod manifold;
mod mark;
mod nearest;
#[cfg(test)]
mod tests;

pub(crate) use mark::{BITS, Mark};
pub(crate) use nearest::{nearest, nearest_from};

use super::piece::Placed;
use glam::DVec3;

/// Points of two pieces that meet, in axes and about an origin that both share.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Meeting {
    /// Unit normal towards the first.
    pub(crate) normal: DVec3,
    /// On the skins.
    pub(crate) points: [DVec3; 2],
    pub(crate) gap: f64,
    pub(crate) mark: Mark,
}

/// Two pieces where they are.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Both<'p> {
    pub(crate) first: Placed<'p>,
    pub(crate) second: Placed<'p>,
}

impl<'p> Both<'p> {
    pub(crate) fn piece(&self, of: usize) -> &Placed<'p> {
        if of == 0 { &self.first } else { &self.second }
    }

    /// Both reaches together: the unit of slack.
    pub(crate) fn size(&self) -> f64 {
        self.first.bounding_radius + self.second.bounding_radius
    }

    pub(crate) fn roundings(&self) -> f64 {
        self.first.rounding + self.second.rounding
    }

    /// How far a unit vector towards the first keeps the cores apart.
    pub(crate) fn apart(&self, normal: DVec3) -> f64 {
        -self.first.support(-normal) - self.second.support(normal)
    }

    /// Whether no direction that is quickly found keeps them farther apart than a gap.
    pub(crate) fn may_be_within(&self, gap: f64) -> bool {
        nearest::polyhedra(self).map_or_else(|| !self.are_beyond(gap), |pair| pair.may_be_within(gap))
    }

    /// A lower bound on the gap, and the unit vector towards the first along which it holds: the best of the pieces'
    /// axes, which are the normals of a box's faces. Far cheaper than the nearest points.
    pub(crate) fn separated(&self) -> (f64, DVec3) {
        let best = |best: (f64, DVec3), next: (f64, DVec3)| if next.0 > best.0 { next } else { best };
        self.gaps_along_axes().fold((f64::NEG_INFINITY, DVec3::ZERO), best)
    }

    /// Whether one of the pieces' axes keeps them farther apart than a gap.
    pub(crate) fn are_beyond(&self, gap: f64) -> bool {
        self.gaps_along_axes().any(|along| along.0 > gap)
    }

    fn gaps_along_axes(&self) -> impl Iterator<Item = (f64, DVec3)> {
        let offset = self.first.centre - self.second.centre;
        let axes = [self.first.axes, self.second.axes].into_iter().flat_map(|m| [m.x_axis, m.y_axis, m.z_axis]);
        let normals = axes.map(move |a| if a.dot(offset) < 0.0 { -a } else { a });
        normals.map(|n| (self.apart(n) - self.roundings(), n))
    }

    /// The meeting of core points along a normal, along which the cores are `distance` apart.
    fn meeting(&self, [p, q]: [DVec3; 2], normal: DVec3, distance: f64, mark: Mark) -> Meeting {
        let points = [p - normal * self.first.rounding, q + normal * self.second.rounding];
        Meeting { normal, points, gap: distance - self.roundings(), mark }
    }

    /// The meeting of a point of the core `of` with its projection on the other core.
    fn at_point(&self, of: usize, p: DVec3, mark: Mark) -> Meeting {
        let (out, distance) = self.piece(1 - of).project(p);
        let q = p - out * distance;
        if of == 0 { self.meeting([p, q], out, distance, mark) } else { self.meeting([q, p], -out, distance, mark) }
    }
}

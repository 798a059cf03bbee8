//! Convex polyhedra against each other, cuboids and balls, as the search for contact and the steps of lasting contact
//! see them.
//!
//! Here a cuboid is the polyhedron of its corners, and a ball is a point with a rounding.

use super::body::{Pose, Turning};
use super::convex::{ConvexPair, Quest};
use super::rows::Row;
use super::{Rigid, Spec};
use crate::shape::hull_pair::{Feature, HullPair, Meeting, Placed};
use crate::shape::{MOST_CORNERS, Polyhedron, Shape};
use glam::DVec3;
use std::sync::Arc;

/// Where corners are along two directions.
pub(super) struct Along {
    places: [(f64, f64); MOST_CORNERS],
    count: usize,
}

impl AsRef<[(f64, f64)]> for Along {
    fn as_ref(&self) -> &[(f64, f64)] {
        &self.places[..self.count]
    }
}

impl ConvexPair for HullPair<'_> {
    type Feature = Feature;
    type Sets = [u64; MOST_CORNERS];
    type Along = Along;

    fn no_sets() -> Self::Sets {
        [0; MOST_CORNERS]
    }

    fn nearest(&self, last: Option<&Meeting>) -> Meeting {
        self.nearest(last.map(|m| (m.feature, m.normal)))
    }

    fn touching(&self, nearest: &Meeting, within: f64, each: impl FnMut(Meeting)) {
        self.touching(nearest, within, each);
    }

    fn turning(&self, feature: Feature, normal: DVec3, spins: [DVec3; 2]) -> DVec3 {
        self.turning(feature, normal, spins)
    }

    fn corners(&self, feature: Feature) -> [u64; 2] {
        self.corners(feature)
    }

    fn corners_along(&self, of: usize, first: DVec3, second: DVec3) -> Along {
        let mut along = Along { places: [(0.0, 0.0); MOST_CORNERS], count: 0 };
        self.corners_along(of, first, second, |place| {
            along.places[along.count] = place;
            along.count += 1;
        });
        along
    }

    fn offset_along(&self, direction: DVec3) -> f64 {
        self.offset_along(direction)
    }

    fn roundings(&self) -> f64 {
        self.roundings()
    }
}

/// A body's core as a polyhedron, and the rounding around it, if it has one; only asked for where it meets a
/// polyhedron.
pub(super) fn core(shape: &Shape) -> Option<(Arc<Polyhedron>, f64)> {
    match shape {
        Shape::Ball(radius) => Some((Arc::new(Polyhedron::point()), *radius)),
        Shape::Cuboid(c) => Some((Arc::new(Polyhedron::cuboid(c.half() - c.rounding())), c.rounding())),
        Shape::Hull(h) => Some((Arc::new(h.core.clone()), h.rounding())),
        Shape::Revolution(_) | Shape::Compound(_) => None,
    }
}

fn placed<'s>(spec: &'s Spec, pose: &Pose) -> Option<Placed<'s>> {
    let (core, rounding) = spec.core.as_ref()?;
    Some(Placed { axes: pose.r, core, rounding: *rounding })
}

impl Rigid {
    /// Both bodies as polyhedra, if at least one is one.
    #[inline]
    pub(super) fn hulls(&self, pair: [usize; 2], [a, b]: [&Pose; 2]) -> Option<HullPair<'_>> {
        if self.row(pair) != Row::Hulls {
            return None;
        }
        let [s, t] = pair.map(|k| &self.specs[k]);
        Some(HullPair::new(a.x - b.x, placed(s, a)?, placed(t, b)?))
    }

    /// First time in `[from, until]` at which two bodies, one of them a polyhedron, touch while approaching, as for
    /// cuboids.
    pub(super) fn first_of_hulls(
        &self,
        pair: [usize; 2],
        bodies: [&Turning; 2],
        [from, until]: [f64; 2],
        linked: bool,
    ) -> Option<f64> {
        let arms = pair.map(|k| self.specs[k].core.as_ref().map_or(0.0, |c| c.0.reach));
        let (specs, level) = (pair.map(|k| &self.specs[k]), self.pair_gap(pair));
        let quest = Quest { specs, bodies, level, from, until, linked, arms };
        quest.first(|poses| self.hulls(pair, poses))
    }
}

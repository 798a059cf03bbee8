//! Two cuboids, as the search for contact and the steps of lasting contact see them.

use super::body::{Pose, Turning};
use super::convex::{ConvexPair, Quest};
use super::{Rigid, Skin};
use crate::shape::cuboid_pair::{CuboidPair, Feature, Meeting, Placed};
use glam::DVec3;

impl ConvexPair for CuboidPair {
    type Feature = Feature;
    type Sets = [u64; 8];
    type Along = [(f64, f64); 8];

    fn no_sets() -> Self::Sets {
        [0; 8]
    }

    #[inline]
    fn nearest(&self, _last: Option<&Meeting>) -> Meeting {
        self.nearest()
    }

    #[inline]
    fn touching(&self, nearest: &Meeting, within: f64, each: impl FnMut(Meeting)) {
        self.touching(nearest, within, each);
    }

    #[inline]
    fn turning(&self, feature: Feature, normal: DVec3, spins: [DVec3; 2]) -> DVec3 {
        self.turning(feature, normal, spins)
    }

    fn corners(&self, feature: Feature) -> [u64; 2] {
        feature.corners().map(u64::from)
    }

    #[inline]
    fn corners_along(&self, of: usize, first: DVec3, second: DVec3) -> Self::Along {
        self.corners_along(of, first, second)
    }

    #[inline]
    fn offset_along(&self, direction: DVec3) -> f64 {
        self.offset_along(direction)
    }

    #[inline]
    fn roundings(&self) -> f64 {
        self.roundings()
    }
}

impl Rigid {
    /// Both bodies as cuboids, if they are.
    #[inline]
    pub(super) fn cuboids(&self, [i, j]: [usize; 2], [a, b]: [&Pose; 2]) -> Option<CuboidPair> {
        let placed = |k: usize, pose: &Pose| match self.specs[k].skin {
            Skin::Cuboid { half, rounding } => Some(Placed { axes: pose.r, core: half - rounding, rounding }),
            _ => None,
        };
        Some(CuboidPair::new(a.x - b.x, placed(i, a)?, placed(j, b)?))
    }

    /// First time in `[from, until]` at which two cuboids touch while approaching. For bodies in lasting contact
    /// (`linked`), only points that are not yet part of it count.
    pub(super) fn first_of_cuboids(
        &self,
        pair: [usize; 2],
        bodies: [&Turning; 2],
        [from, until]: [f64; 2],
        linked: bool,
    ) -> Option<f64> {
        let arms = pair.map(|k| self.specs[k].reach);
        let (specs, level) = (pair.map(|k| &self.specs[k]), self.pair_gap(pair));
        let quest = Quest { specs, bodies, level, from, until, linked, arms };
        quest.first(|poses| self.cuboids(pair, poses))
    }
}

//! All points at which two bodies touch, the same points at other poses, and which of them an impact is at.

use super::Rigid;
use super::body::Pose;
use super::pair::{Feature, PairTouch};

impl Rigid {
    /// Calls `each` for the points at which two bodies touch: all of two cuboids or polyhedra, the nearest of others.
    pub(super) fn for_pair_touches(
        &self,
        pair: [usize; 2],
        poses: [&Pose; 2],
        within: f64,
        mut each: impl FnMut(PairTouch),
    ) {
        if let Some(cuboids) = self.cuboids(pair, poses) {
            return cuboids.touching(&cuboids.nearest(), within, |m| each(m.into()));
        }
        if let Some(hulls) = self.hulls(pair, poses) {
            return hulls.touching(&hulls.nearest(None), within, |m| each(m.into()));
        }
        let touch = self.pair_touch(pair, poses);
        if touch.gap <= within {
            each(touch);
        }
    }

    /// The same point of contact at other poses.
    pub(super) fn pair_again(&self, pair: [usize; 2], poses: [&Pose; 2], touch: &PairTouch) -> PairTouch {
        let again = match touch.feature {
            Some(Feature::Cuboids(f)) => self.cuboids(pair, poses).map(|c| c.again(f, touch.normal).into()),
            Some(Feature::Hulls(f)) => self.hulls(pair, poses).map(|h| h.again(f, touch.normal).into()),
            None => None,
        };
        again.unwrap_or_else(|| self.pair_touch(pair, poses))
    }
}

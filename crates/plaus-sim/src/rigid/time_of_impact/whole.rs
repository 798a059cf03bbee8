//! Whether two bodies stay apart as wholes: where they have several pieces, most searches end with this, in a part of
//! the time that a look at all pairs of pieces takes.

use super::advancement::{Along, PosePair, SeparationBound};
use super::convex::TimeOfImpact;
use crate::rigid::BodyDef;
use crate::rigid::body_state::Pose;
use crate::special_case::SpecialCase;
use glam::DVec3;

impl TimeOfImpact<'_> {
    /// Whether the best of the bodies' axes keeps two bodies of several pieces apart for `span` seconds. `m` bounds the
    /// acceleration of gaps.
    pub(super) fn stays_apart(&self, scene: &PosePair, m: f64, span: f64) -> bool {
        let Some((other, _)) =
            self.other().filter(|(s, _)| SpecialCase::Whole.is_on() && s.pieces.len() * self.spec.pieces.len() > 1)
        else {
            return false;
        };
        let (first, second) = (|d| reach(self.spec, &scene.a, d), |d| reach(other, &scene.b, d));
        let offset = scene.a.x - scene.b.x;
        let axes = [scene.a.r, scene.b.r].into_iter().flat_map(|r| [r.x_axis, r.y_axis, r.z_axis]);
        let mut best = (0.0, DVec3::ZERO);
        for axis in axes.chain(offset.try_normalize()) {
            let n = if axis.dot(offset) < 0.0 { -axis } else { axis };
            let room = n.dot(offset) - first(-n) - second(n) - self.level;
            if room > best.0 {
                best = (room, n);
            }
        }
        best.0 > 0.0 && SeparationBound::new(best.0, Along::fixed(best.1, m), scene).holds(span, first, second)
    }
}

/// How far a body reaches in a direction from its centre of gravity. Roundings are balls, which reach as far in all
/// directions.
fn reach(spec: &BodyDef, pose: &Pose, d: DVec3) -> f64 {
    let d = pose.r.transpose() * d;
    let reaches = spec.pieces.iter().map(|p| p.at.dot(d) + p.core.support(p.turn.transpose() * d) + p.rounding);
    reaches.fold(f64::NEG_INFINITY, f64::max)
}

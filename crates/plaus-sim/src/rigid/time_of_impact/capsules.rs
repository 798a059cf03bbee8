//! The capsules around two bodies, which are tested before their skins.

use super::advancement::Advance;
use super::advancement::PosePair;
use super::convex::TimeOfImpact;
use crate::rigid::BodyDef;
use crate::rigid::body_state::Pose;
use crate::rigid::narrow_phase::capsules::{ends, nearest_on_segments};
use crate::rigid::narrow_phase::static_collider::StaticCollider;
use crate::rigid::tolerances::SEPARATING_AXIS_DISTANCE;
use crate::roots::earliest;
use crate::special_case::SpecialCase;
use glam::DVec3;

/// Distance of the capsules around two bodies, a lower bound on their gap, and a time within which they do not come
/// nearer than `level`. During that time, no end of one comes so near to an end of the other along the direction
/// between them; accelerations are at most `m`.
pub(super) fn capsules([s, t]: [&BodyDef; 2], [a, b]: [&Pose; 2], level: f64, m: f64) -> (f64, f64) {
    let (first, second) = (ends(s, a), ends(t, b));
    let [p, q] = nearest_on_segments(first, second);
    let between = p - q;
    let distance = between.length();
    let normal = between / distance;
    let radii = s.capsule[2] + t.capsule[2];
    let mut safe = f64::INFINITY;
    for p in first {
        for q in second {
            let rate = (a.velocity(p - a.x) - b.velocity(q - b.x)).dot(normal);
            safe = safe.min(earliest((p - q).dot(normal) - radii - level, rate, m));
        }
    }
    (distance - radii, safe)
}

impl TimeOfImpact<'_> {
    /// Whether the capsule around a body of many pieces is beyond a fixed piece, along one of the piece's axes.
    pub(super) fn is_capsule_off(
        &self,
        scene: &PosePair,
        collider: &StaticCollider,
        other: u32,
        m: f64,
        next: &mut Advance,
    ) -> bool {
        if !SpecialCase::Capsules.is_on() {
            return false;
        }
        let ([low, high, radius], piece) = (self.spec.capsule, &collider.pieces[other as usize]);
        let second = piece.about(scene.a.x);
        let ends = [scene.a.r.z_axis * low, scene.a.r.z_axis * high];
        let mut longest: Option<f64> = None;
        for n in [second.axes.x_axis, second.axes.y_axis, second.axes.z_axis].into_iter().flat_map(|n| [n, -n]) {
            let base = second.support(n) + second.rounding + radius;
            if ends[0].dot(n).min(ends[1].dot(n)) - base > SEPARATING_AXIS_DISTANCE * self.spec.size {
                let time = |end: &DVec3| earliest(self.room(end.dot(n) - base), scene.a.velocity(*end).dot(n), m);
                let both = time(&ends[0]).min(time(&ends[1]));
                longest = Some(longest.map_or(both, |l| l.max(both)));
            }
        }
        if let Some(apart) = longest {
            next.step = next.step.min(apart);
        }
        longest.is_some()
    }
}

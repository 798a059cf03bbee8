//! The capsules around two bodies, which are tested before their skins.

use super::convex::{Next, TimeOfImpact};
use super::separation_bound::PosePair;
use crate::rigid::BodyDef;
use crate::rigid::body_state::Pose;
use crate::rigid::narrow_phase::static_collider::StaticCollider;
use crate::rigid::tolerances::SEPARATING_AXIS_DISTANCE;
use crate::roots::earliest;
use glam::{DMat3, DVec3};

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

/// The distance alone.
pub(crate) fn capsule_gap([s, t]: [&BodyDef; 2], [a, b]: [&Pose; 2]) -> f64 {
    let [p, q] = nearest_on_segments(ends(s, a), ends(t, b));
    (p - q).length() - (s.capsule[2] + t.capsule[2])
}

/// The ends of the axis of the capsule around a body.
fn ends(spec: &BodyDef, pose: &Pose) -> [DVec3; 2] {
    [pose.x + pose.r.z_axis * spec.capsule[0], pose.x + pose.r.z_axis * spec.capsule[1]]
}

/// Nearest points of two segments (Ericson, *Real-Time Collision Detection*, §5.1.9).
fn nearest_on_segments([p1, q1]: [DVec3; 2], [p2, q2]: [DVec3; 2]) -> [DVec3; 2] {
    let (d1, d2, r) = (q1 - p1, q2 - p2, p1 - p2);
    let (a, e, f) = (d1.length_squared(), d2.length_squared(), d2.dot(r));
    let part = |x: f64, of: f64| if of > 0.0 { (x / of).clamp(0.0, 1.0) } else { 0.0 };
    let (c, b) = (d1.dot(r), d1.dot(d2));
    let mut s = part(b * f - c * e, a * e - b * b);
    let mut t = if e > 0.0 { (b * s + f) / e } else { 0.0 };
    if !(0.0..=1.0).contains(&t) {
        t = t.clamp(0.0, 1.0);
    }
    s = if a > 0.0 { ((b * t - c) / a).clamp(0.0, 1.0) } else { s };
    [p1 + d1 * s, p2 + d2 * t]
}

impl TimeOfImpact<'_> {
    /// Whether the capsule around a body of many pieces is beyond a fixed piece, along one of the piece's axes.
    pub(super) fn is_capsule_off(
        &self,
        scene: &PosePair,
        collider: &StaticCollider,
        other: u32,
        m: f64,
        next: &mut Next,
    ) -> bool {
        let ([low, high, radius], piece) = (self.spec.capsule, &collider.pieces[other as usize]);
        let second = piece.placed(&DMat3::IDENTITY, -scene.a.x);
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

//! The capsules around bodies.

use crate::rigid::BodyDef;
use crate::rigid::body_state::Pose;
use glam::DVec3;

/// Distance of the capsules around two bodies, a lower bound on their gap.
pub(super) fn capsule_gap([s, t]: [&BodyDef; 2], [a, b]: [&Pose; 2]) -> f64 {
    let [p, q] = nearest_on_segments(ends(s, a), ends(t, b));
    (p - q).length() - (s.capsule[2] + t.capsule[2])
}

/// The ends of the axis of the capsule around a body.
pub(crate) fn ends(spec: &BodyDef, pose: &Pose) -> [DVec3; 2] {
    [pose.x + pose.r.z_axis * spec.capsule[0], pose.x + pose.r.z_axis * spec.capsule[1]]
}

/// Nearest points of two segments (Ericson, *Real-Time Collision Detection*, §5.1.9).
pub(crate) fn nearest_on_segments([p1, q1]: [DVec3; 2], [p2, q2]: [DVec3; 2]) -> [DVec3; 2] {
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

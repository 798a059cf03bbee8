//! Shared by all searches for a first contact: the time before two bodies can meet, and bisection.

use crate::rigid::body_state::RigidBodyState;
use crate::rigid::tolerances::LEAST_FLIGHT_ADVANCE;
use crate::roots::earliest;

/// How long, in s, two bodies may move from `time` on without being examined. The balls around them are `away` metres
/// apart, beyond the gap `level` at which they touch; `gravity` is their relative acceleration in m/s². That distance
/// is convex in time, so it falls no faster than its rate and gravity allow.
#[inline]
pub(super) fn free_flight_bound(bodies: [&RigidBodyState; 2], time: f64, away: f64, level: f64, gravity: f64) -> f64 {
    let [p, q] = bodies.map(|b| &b.path);
    let offset = p.at(time) - q.at(time);
    let dv = p.velocity_after(time - p.t) - q.velocity_after(time - q.t);
    let safe = earliest(away, offset.dot(dv) / offset.length(), gravity);
    safe + LEAST_FLIGHT_ADVANCE * level / (dv.length() + (gravity * level).sqrt()).max(f64::MIN_POSITIVE)
}

/// The end of the last of `halvings` halves of an interval in which `is` becomes true.
pub(super) fn bisect(halvings: usize, mut low: f64, mut high: f64, mut is: impl FnMut(f64) -> bool) -> f64 {
    for _ in 0..halvings {
        let middle = 0.5 * (low + high);
        if is(middle) { high = middle } else { low = middle }
    }
    high
}

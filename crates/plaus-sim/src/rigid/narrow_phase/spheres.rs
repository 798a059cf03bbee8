//! Two bodies: how near they are, when they touch, and their impact.
//!
//! `dispatch.rs` says which algorithm serves which pair. Here, balls and bodies of revolution are treated as the balls
//! and rings of their skins. First contacts are found by advancement with a second-order bound on the approach of the
//! nearest points. If another pair of points comes first, the overlap is noticed, and the time is found by bisection.

use super::contact_point::PairContactPoint;
use glam::DVec3;

/// Two balls, in world axes about the two centres of gravity.
pub(crate) fn balls(offset: DVec3, [p, q]: [DVec3; 2], [r, s]: [f64; 2]) -> PairContactPoint {
    // `offset` points from the second centre of gravity to the first.
    let between = offset + p - q;
    let distance = between.length();
    let normal = if distance > 0.0 { between / distance } else { DVec3::Z };
    PairContactPoint { normal, arms: [p - normal * r, q + normal * s], gap: distance - r - s, id: None }
}

pub(super) fn nearer(best: &mut Option<PairContactPoint>, other: PairContactPoint) {
    if best.is_none_or(|b| other.gap < b.gap) {
        *best = Some(other);
    }
}

pub(super) fn swapped(t: PairContactPoint) -> PairContactPoint {
    PairContactPoint { normal: -t.normal, arms: [t.arms[1], t.arms[0]], ..t }
}

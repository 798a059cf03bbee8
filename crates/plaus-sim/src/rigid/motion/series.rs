//! Free rotation of a body with three different moments over a short time: a Taylor series of Euler's equations and of
//! the quaternion. Over longer times, `asymmetric_top.rs` costs less.

use super::inertia::Inertia;
use glam::{DQuat, DVec3};

/// Terms of the series at most. Within [`MOST_TURN`], the first term left out is below `0.3¹⁶/16! ≈ 2e-22` times a
/// small power of the ratio of moments.
const ORDER: usize = 16;

/// Fewer terms are taken where those left out stay below this. Default 1e-18; rounding is 1e-16.
pub(crate) const LEFT_OUT: f64 = 1e-18;

/// Largest angle in radians (times the ratio of moments where that exceeds 1) that the series is for.
const MOST_TURN: f64 = 0.3;

/// Orientation and angular velocity in body axes after a time; `None` if it is too long for the series. Terms below
/// `left_out` are left out.
pub(super) fn series(inertia: &Inertia, turn: DQuat, w: DVec3, dt: f64, left_out: f64) -> Option<(DQuat, DVec3)> {
    let i = inertia.moments;
    // |ω| in free rotation is at most √(2 E / I_min).
    let most = ((i * w).dot(w) / i.min_element()).sqrt() * dt.abs();
    let ratio = (i.max_element() / i.min_element()).min(4.0);
    let is_short = most * ratio <= MOST_TURN;
    if !is_short {
        return None;
    }
    // The n-th terms are at most `angleⁿ/n!` for the orientation and `growthⁿ` for the angular velocity.
    let (angle, growth) = (most * ratio, most * inertia.anisotropy());
    let (mut order, mut turned, mut grown) = (0, 1.0_f64, 1.0_f64);
    while order < ORDER && turned.max(grown) > left_out {
        order += 1;
        (turned, grown) = (turned * angle / order as f64, grown * growth);
    }
    let c = DVec3::new((i.y - i.z) / i.x, (i.z - i.x) / i.y, (i.x - i.y) / i.z);
    let mut rates = [DVec3::ZERO; ORDER + 1];
    let mut turns = [DQuat::from_xyzw(0.0, 0.0, 0.0, 0.0); ORDER + 1];
    rates[0] = w;
    turns[0] = turn;
    for n in 0..order {
        let (mut products, mut turned) = (DVec3::ZERO, DQuat::from_xyzw(0.0, 0.0, 0.0, 0.0));
        for k in 0..=n {
            let (a, b) = (rates[k], rates[n - k]);
            products += DVec3::new(a.y * b.z, a.z * b.x, a.x * b.y);
            turned += turns[k] * DQuat::from_xyzw(b.x, b.y, b.z, 0.0);
        }
        let next = dt / (n + 1) as f64;
        rates[n + 1] = c * products * next;
        turns[n + 1] = turned * (0.5 * next);
    }
    // Smallest terms first.
    let w = rates[..=order].iter().rev().fold(DVec3::ZERO, |sum, &t| sum + t);
    let turn = turns[..=order].iter().rev().fold(DQuat::from_xyzw(0.0, 0.0, 0.0, 0.0), |sum, &t| sum + t);
    Some((turn.normalize(), w))
}

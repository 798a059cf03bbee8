//! Outlines of round shapes, as they are drawn.

use plaus_dist::math;
use plaus_sim::shape::Frustum;
use std::f64::consts::FRAC_PI_2;

/// Points of a drawn quarter circle.
const ARC: usize = 8;

/// The outline of a solid of revolution, from the lowest height to the highest: its rounding as arcs.
pub(super) fn profile(frustum: &Frustum) -> Vec<[f64; 2]> {
    let [[low, wide], [high, narrow]] = frustum.discs();
    let rounding = frustum.rounding();
    if rounding == 0.0 {
        return vec![[0.0, low], [wide, low], [narrow, high], [0.0, high]];
    }
    let arc = |height: f64, radius: f64, from: f64| {
        (0..=ARC).map(move |k| {
            let (sin, cos) = math::sin_cos(from + FRAC_PI_2 * k as f64 / ARC as f64);
            [radius + rounding * cos.max(0.0), height + rounding * sin]
        })
    };
    arc(low, wide, -FRAC_PI_2).chain(arc(high, narrow, 0.0)).collect()
}

//! The point of an edge, or of a rim, nearest to a core: the root of a derivative.

use crate::shape::frustum::Discs;
use crate::shape::piece::Core;
use glam::DVec3;
use plaus_dist::math;
use std::f64::consts::TAU;

/// Maximum number of rounds of approaching a root. Each halves the bracket at least every other time; with the secant,
/// about eight are taken.
const ROUNDS: usize = 120;

/// Samples of a rim between which its nearest points are sought. Default 16.
const SAMPLES: usize = 16;

/// Fraction of its bracket's size to which a root is found: rounding.
const FINE: f64 = 4e-16;

/// The root of a function that is negative at `low` and positive at `high` (Illinois method, with bisections where that
/// is slow).
fn root(mut low: (f64, f64), mut high: (f64, f64), scale: f64, f: impl Fn(f64) -> f64) -> f64 {
    let mut side = 0;
    for round in 0..ROUNDS {
        if high.0 - low.0 <= FINE * scale {
            break;
        }
        let middle = 0.5 * (low.0 + high.0);
        let chord = low.0 + (high.0 - low.0) * (low.1 / (low.1 - high.1));
        let at = if round % 3 == 2 || chord <= low.0 || chord >= high.0 { middle } else { chord };
        if at <= low.0 || at >= high.0 {
            break;
        }
        let value = f(at);
        if value == 0.0 {
            return at;
        }
        if value < 0.0 {
            low = (at, value);
            if side == -1 {
                high.1 *= 0.5;
            }
            side = -1;
        } else {
            high = (at, value);
            if side == 1 {
                low.1 *= 0.5;
            }
            side = 1;
        }
    }
    0.5 * (low.0 + high.0)
}

/// A corner, with the distance and direction of a core from it.
#[derive(Debug, Clone, Copy)]
pub(super) struct End {
    pub(super) at: DVec3,
    pub(super) out: DVec3,
    pub(super) distance: f64,
}

/// The point inside an edge that is nearest to a core, in the core's axes, if it can be nearer than `least` and neither
/// end is.
pub(super) fn on_edge(core: &Core, [a, b]: [&End; 2], along: DVec3, length: f64, least: f64) -> Option<DVec3> {
    let (down, up) = (a.out.dot(along), b.out.dot(along));
    if down >= 0.0 || up <= 0.0 {
        return None;
    }
    // All of the core is within its reach of its origin.
    let near = a.at + along * (-a.at.dot(along)).clamp(0.0, length);
    if near.length() - core.reach() >= least {
        return None;
    }
    // The distance is convex, so it lies above both tangents.
    let cross = (b.distance - up * length - a.distance) / (down - up);
    if a.distance + down * cross >= least {
        return None;
    }
    let t = root((0.0, down), (length, up), length, |t| core.project(a.at + along * t).0.dot(along));
    Some(a.at + along * t)
}

/// Calls `each` for the points of a rim that are nearer to a core than the points beside them. `place` turns points in
/// the rim's axes into those of the core, and `turned` does the same for directions.
pub(super) fn on_rim(
    core: &Core,
    discs: &Discs,
    ring: usize,
    place: impl Fn(DVec3) -> DVec3,
    turned: impl Fn(DVec3) -> DVec3,
    mut each: impl FnMut(DVec3),
) {
    let (radius, height) = (discs.radii[ring], discs.heights[ring]);
    if radius == 0.0 {
        return each(place(DVec3::new(0.0, 0.0, height)));
    }
    let at = |angle: f64| {
        let (s, c) = math::sin_cos(angle);
        (place(DVec3::new(radius * c, radius * s, height)), turned(DVec3::new(-s, c, 0.0)))
    };
    let slope = |angle: f64| {
        let (p, tangent) = at(angle);
        core.project(p).0.dot(tangent)
    };
    let angle = |k: usize| TAU * (k as f64 / SAMPLES as f64);
    let slopes: [f64; SAMPLES] = std::array::from_fn(|k| slope(angle(k)));
    let mut any = false;
    for k in 0..SAMPLES {
        let (before, after) = (slopes[k], slopes[(k + 1) % SAMPLES]);
        if before < 0.0 && after >= 0.0 {
            any = true;
            each(at(root((angle(k), before), (angle(k + 1), after), TAU, slope)).0);
        }
    }
    if !any {
        // The distance is the same all around.
        each(at(0.0).0);
    }
}

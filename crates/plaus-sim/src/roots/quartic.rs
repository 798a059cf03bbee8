//! Quartics `Σ c_k t^k`: squared distances along parabolas (edges, vertices, domes, and spheres one of which rolls).

use super::{fall_of_quadratic, refine, roots_of_quadratic};
use glam::DVec3;

/// Coefficients of `|p + v t + a t²/2|² − d²`.
#[inline]
#[must_use]
pub fn squared_distance(p: DVec3, v: DVec3, a: DVec3, d: f64) -> [f64; 5] {
    [p.length_squared() - d * d, 2.0 * p.dot(v), v.length_squared() + p.dot(a), v.dot(a), 0.25 * a.length_squared()]
}

#[inline]
fn value(c: &[f64; 5], t: f64) -> f64 {
    c[0] + t * (c[1] + t * (c[2] + t * (c[3] + t * c[4])))
}

#[inline]
fn slope(c: &[f64; 5], t: f64) -> f64 {
    c[1] + t * (2.0 * c[2] + t * (3.0 * c[3] + t * 4.0 * c[4]))
}

#[inline]
fn curvature(c: &[f64; 5], t: f64) -> f64 {
    2.0 * c[2] + t * (6.0 * c[3] + t * 12.0 * c[4])
}

/// Whether the Bernstein coefficients over `[from, until]` are all positive, which proves that there is no root. This
/// test is quick and settles most calls.
#[inline]
fn surely_positive(c: &[f64; 5], from: f64, until: f64) -> bool {
    let width = until - from;
    let (f, d) = (value(c, from), slope(c, from) * width);
    let second = 0.5 * curvature(c, from) * width * width;
    let third = (c[3] + 4.0 * c[4] * from) * width * width * width;
    f > 0.0
        && f + 0.25 * d > 0.0
        && f + 0.5 * d + second * (1.0 / 6.0) > 0.0
        && f + 0.75 * d + 0.5 * second + 0.25 * third > 0.0
        && value(c, until) > 0.0
}

/// Ascending zeros of the slope inside `(from, until)`, at most three, filled up with `until`.
fn turning_points(c: &[f64; 5], from: f64, until: f64) -> [f64; 3] {
    let inflections = roots_of_quadratic([2.0 * c[2], 6.0 * c[3], 12.0 * c[4]]).unwrap_or([f64::INFINITY; 2]);
    let mut ends = [from, until, until, until];
    let mut count = 1;
    for t in inflections {
        if t > ends[count - 1] && t < until {
            ends[count] = t;
            count += 1;
        }
    }
    let mut turns = [until; 3];
    let mut found = 0;
    for k in 0..count {
        let (low, high) = (ends[k], ends[k + 1]);
        let (at_low, at_high) = (slope(c, low), slope(c, high));
        // A slope that is 0 exactly at an inner end belongs to the interval that ends there.
        if (at_low > 0.0 && at_high <= 0.0) || (at_low < 0.0 && at_high >= 0.0) {
            turns[found] = refine(|t| (slope(c, t), curvature(c, t)), low, high, at_low > 0.0);
            found += 1;
        }
    }
    turns
}

/// First time in `[from, until]` at which the quartic is not positive and falls (see the module). `from` is at least 0.
/// `until` may be infinite only if the quartic is in fact a quadratic.
#[inline]
#[must_use]
pub fn fall_of_quartic(c: &[f64; 5], from: f64, until: f64) -> Option<f64> {
    if c[3] == 0.0 && c[4] == 0.0 && from == 0.0 {
        return fall_of_quadratic([c[0], c[1], c[2]], until);
    }
    falls_of_quartic(c, from, until, |_| true)
}

/// The fall of a quartic in `[0, until]`, sought as the first in `[0, horizon]`, so that its last bits do not depend on
/// `until`.
#[inline]
pub(crate) fn first_fall_of_quartic(c: &[f64; 5], until: f64, horizon: f64) -> Option<f64> {
    if c[3] == 0.0 && c[4] == 0.0 {
        return fall_of_quadratic([c[0], c[1], c[2]], until);
    }
    if surely_positive(c, 0.0, until) {
        return None;
    }
    falls_of_quartic(c, 0.0, horizon, |_| true)
}

/// The first fall of the quartic that `accept` agrees to; the others are passed over.
#[inline]
#[must_use]
pub fn falls_of_quartic(c: &[f64; 5], from: f64, until: f64, mut accept: impl FnMut(f64) -> bool) -> Option<f64> {
    if surely_positive(c, from, until) {
        return None;
    }
    let known = match bend(c, from, until) {
        Bend::Up => fall_of_convex(c, from, until),
        Bend::Down => fall_of_concave(c, from, until),
        Bend::Unknown => None,
    };
    match known {
        // If the bend has a single sign, there is at most one fall.
        Some(fall) => fall.filter(|&time| accept(time)),
        None => fall_in_pieces(c, from, until, accept),
    }
}

/// Sign of the second derivative over an interval.
enum Bend {
    Up,
    Down,
    Unknown,
}

/// The bend as far as the Bernstein coefficients of the second derivative tell.
#[inline]
fn bend(c: &[f64; 5], from: f64, until: f64) -> Bend {
    let (first, last) = (curvature(c, from), curvature(c, until));
    let middle = first + (3.0 * c[3] + 12.0 * c[4] * from) * (until - from);
    if (first > 0.0) & (middle > 0.0) & (last > 0.0) {
        Bend::Up
    } else if (first < 0.0) & (middle < 0.0) & (last < 0.0) {
        Bend::Down
    } else {
        Bend::Unknown
    }
}

/// Whether there is a fall, and when; [`None`] if that is not known.
type KnownFall = Option<Option<f64>>;

/// Maximum number of steps of Newton's method without a bracket: grazing takes about 30, everything else up to eight.
/// After that, the general method takes over.
const MOST_STEPS: usize = 64;

/// The fall of a quartic that is convex over the interval. Newton's method from the left never passes the root, so it
/// needs no bracket, and it notices if there is no root.
#[inline]
fn fall_of_convex(c: &[f64; 5], from: f64, until: f64) -> KnownFall {
    let mut t = from;
    for _ in 0..MOST_STEPS {
        let (f, s) = (value(c, t), slope(c, t));
        if s >= 0.0 {
            // It rises from here on.
            return Some(None);
        }
        if f <= 0.0 {
            return Some(Some(t));
        }
        let next = t - f / s;
        if next > until {
            return Some(None);
        }
        // A step of one or two last bits, which rounding may reverse.
        if next - t <= f64::EPSILON * next {
            return Some(Some(next));
        }
        t = next;
    }
    None
}

/// The fall of a quartic that is concave over the interval, by Newton's method from the right, which never passes the
/// last root. Not known if the quartic is nowhere positive but rises at first: then it falls from its turning point on,
/// which is not sought here.
#[inline]
fn fall_of_concave(c: &[f64; 5], from: f64, until: f64) -> KnownFall {
    let (mut f, mut s) = (value(c, until), slope(c, until));
    if f > 0.0 || s >= 0.0 {
        // It is above zero at its end, and if it was not before, it has only risen; or it rises all the way.
        return Some(None);
    }
    if value(c, from) <= 0.0 && slope(c, from) <= 0.0 {
        return Some(Some(from));
    }
    let mut t = until;
    for _ in 0..MOST_STEPS {
        let next = t - f / s;
        if next < from {
            break;
        }
        if t - next <= f64::EPSILON * next {
            return Some(Some(next));
        }
        t = next;
        (f, s) = (value(c, t), slope(c, t));
        if s >= 0.0 {
            break;
        }
    }
    None
}

fn fall_in_pieces(c: &[f64; 5], from: f64, until: f64, mut accept: impl FnMut(f64) -> bool) -> Option<f64> {
    let turns = turning_points(c, from, until);
    let mut low = from;
    let mut at_low = value(c, low);
    for high in [turns[0], turns[1], turns[2], until] {
        if high <= low {
            continue;
        }
        let at_high = value(c, high);
        if at_high < at_low && at_high <= 0.0 {
            let time = if at_low <= 0.0 { low } else { refine(|t| (value(c, t), slope(c, t)), low, high, true) };
            if accept(time) {
                return Some(time);
            }
        }
        (low, at_low) = (high, at_high);
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Coefficients of (t − r0)(t − r1)(t² + p t + q).
    fn from_roots(r0: f64, r1: f64, p: f64, q: f64) -> [f64; 5] {
        let (s, m) = (-(r0 + r1), r0 * r1);
        [m * q, s * q + m * p, q + s * p + m, p + s, 1.0]
    }

    #[test]
    fn a_known_quartic_falls_at_its_first_root() {
        let c = from_roots(1.0, 2.0, 0.0, 1.0);
        let t = fall_of_quartic(&c, 0.0, 10.0).unwrap();
        assert!((t - 1.0).abs() < 1e-14, "{t}");
        assert_eq!(fall_of_quartic(&c, 0.0, 0.5), None);
        assert_eq!(fall_of_quartic(&c, 2.5, 10.0), None);
    }

    #[test]
    fn exact_grazing_is_found_or_harmless() {
        // Two spheres that touch at one instant: min gap 0 exactly representable.
        let c = squared_distance(DVec3::new(-1.0, 1.0, 0.0), DVec3::X, DVec3::ZERO, 1.0);
        let t = fall_of_quartic(&c, 0.0, 10.0).unwrap();
        assert_eq!(t, 1.0);
    }

    proptest! {
        /// Compares the short methods for one sign of the bend with the general one, over intervals that begin and end
        /// anywhere. Both give the same fall, or none, except where the quartic only just touches zero, which rounding
        /// decides.
        #[test]
        fn short_methods_agree_with_the_general_one(
            p in prop::array::uniform3(-2.0..2.0_f64), v in prop::array::uniform3(-3.0..3.0_f64),
            a in prop::array::uniform3(-10.0..10.0_f64), d in 0.01..3.0_f64, hollow in any::<bool>(),
            from in 0.0..0.5_f64, width in 0.001..1.0_f64, on_surface in any::<bool>(),
        ) {
            let mut c = squared_distance(DVec3::from(p), DVec3::from(v), DVec3::from(a), d);
            if hollow {
                c = c.map(|x| -x);
            }
            let until = from + width;
            if on_surface {
                // As after a bounce: a rounding error away from touching.
                c[0] -= value(&c, from) * (1.0 - 1e-15);
            }
            let short = match bend(&c, from, until) {
                Bend::Up => fall_of_convex(&c, from, until),
                Bend::Down => fall_of_concave(&c, from, until),
                Bend::Unknown => None,
            };
            let general = fall_in_pieces(&c, from, until, |_| true);
            let scale = c.iter().map(|x| x.abs()).fold(0.0, f64::max);
            // The times may differ by the effect, at that slope, of a few roundings in the value.
            match (short, general) {
                (None, _) | (Some(None), None) => {}
                (Some(Some(s)), Some(g)) => {
                    let rounding = 1e-14 * scale;
                    prop_assert!((s - g).abs() * slope(&c, g).abs().max(slope(&c, s).abs()) <= rounding + 1e-15 * s || (value(&c, s).abs() <= rounding && value(&c, g).abs() <= rounding), "{s} {g}");
                }
                (Some(Some(t)), None) | (Some(None), Some(t)) => prop_assert!(
                    value(&c, t).abs() <= 1e-14 * scale
                        && (slope(&c, t).abs() <= 1e-6 * scale || t >= until - 1e-14 || t <= from + 1e-14),
                    "{short:?} {general:?} {}", value(&c, t)
                ),
            }
        }

        /// Compared with a dense scan: no fall is invented, and none is missed by more than the scan can resolve.
        #[test]
        fn agrees_with_a_scan(
            p in prop::array::uniform3(-2.0..2.0_f64), v in prop::array::uniform3(-3.0..3.0_f64),
            a in prop::array::uniform3(-10.0..10.0_f64), d in 0.01..1.5_f64,
        ) {
            let c = squared_distance(DVec3::from(p), DVec3::from(v), DVec3::from(a), d);
            let until = 2.0;
            let found = fall_of_quartic(&c, 0.0, until);
            if let Some(t) = found {
                let scale = c.iter().map(|x| x.abs()).fold(0.0, f64::max);
                prop_assert!(value(&c, t) <= 1e-12 * scale);
                prop_assert!(slope(&c, t) <= 1e-6 * scale);
            }
            let steps = 20_000;
            let mut last = value(&c, 0.0);
            for k in 1..=steps {
                let t = until * f64::from(k) / f64::from(steps);
                let now = value(&c, t);
                if now < last && now < -1e-9 {
                    let first = found.expect("the scan sees a fall");
                    prop_assert!(first <= t, "{first} after {t}");
                    break;
                }
                last = now;
            }
        }
    }
}

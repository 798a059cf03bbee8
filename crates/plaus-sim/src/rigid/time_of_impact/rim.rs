//! The lowest point of a ring that turns with its body. It is not a fixed point of the body, so its own second
//! derivative has no bound, but every point of the ring has one.

use super::advancement::bisect;
use crate::rigid::tolerances::{RIM_BISECTIONS, RIM_ROOT_ROUNDS};
use crate::roots::earliest;
use crate::special_case::SpecialCase;
use glam::DVec2;

/// A ring over a plane. A point of it in direction `u` (in body axes, across the axis) has the gap
/// `middle + circle p·u`, its rate is `rate + circle q·u`, and its acceleration towards the plane is at most `m`. So
/// after `τ` every point, including the lowest, is at least as high as
/// `g(τ) = middle + rate τ − circle |p + q τ| − m τ²/2`, which is concave.
#[derive(Debug, Clone, Copy)]
pub(crate) struct LowestRimPoint {
    pub(crate) middle: f64,
    pub(crate) rate: f64,
    pub(crate) circle: f64,
    pub(crate) p: DVec2,
    pub(crate) q: DVec2,
    pub(crate) m: f64,
}

impl LowestRimPoint {
    /// The bound on the gap after `t`.
    pub(crate) fn at(&self, t: f64) -> f64 {
        self.middle + (self.rate - 0.5 * self.m * t) * t - self.circle * (self.p + self.q * t).length()
    }

    fn slope_at(&self, t: f64) -> f64 {
        let p = self.p + self.q * t;
        let length = p.length();
        let turned = if length > 0.0 { p.dot(self.q) / length } else { self.q.length() };
        self.rate - self.m * t - self.circle * turned
    }

    /// A time before which the ring cannot touch while it sinks, limited to `limit`.
    pub(super) fn earliest(&self, limit: f64) -> f64 {
        let (f, slope) = (self.at(0.0), self.slope_at(0.0));
        if f <= 0.0 {
            return self.sinks(slope);
        }
        // Below the parabola of the point that is lowest now, above that of the fastest point.
        let mut low = earliest(f, self.rate - self.circle * self.q.length(), self.m);
        if !SpecialCase::Rim.is_on() {
            return low.min(limit);
        }
        let mut high = earliest(f, slope, self.m).min(limit);
        if low >= high || self.at(high) > 0.0 {
            return high.max(low);
        }
        let mut at_low = self.at(low);
        for _ in 0..RIM_ROOT_ROUNDS {
            if high - low <= 1e-3 * low || at_low <= 0.0 {
                break;
            }
            // The chord of a concave function lies below it, the tangent above.
            let at_high = self.at(high);
            let chord = low + (high - low) * (at_low / (at_low - at_high));
            let falls = self.slope_at(high);
            if falls < 0.0 {
                high = (high - at_high / falls).clamp(low, high);
            }
            low = chord.clamp(low, high);
            at_low = self.at(low);
        }
        low
    }

    /// Overlapping but rising: a time before which no point of the ring can sink again while the overlap lasts.
    fn sinks(&self, slope: f64) -> f64 {
        let fastest = self.rate - self.circle * self.q.length();
        if fastest >= 0.0 {
            return earliest(self.at(0.0), fastest, self.m);
        }
        let end = if self.m > 0.0 { slope / self.m } else { self.p.length() / self.q.length() };
        bisect(RIM_BISECTIONS, 0.0, end, |time| self.slope_at(time) < 0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use plaus_dist::math;

    /// Compared with a scan of the bound itself: never late, and not so early that the surrounding search would crawl.
    #[test]
    fn the_first_root_is_not_overshot() {
        let mut found = 0;
        for k in 0..4000 {
            let part = |step: f64| (f64::from(k) * step) % 1.0;
            let lean = part(0.618_033_988_749) * part(0.618_033_988_749) * 0.5;
            let turn = 6.3 * part(0.324_717_957_244);
            let low = LowestRimPoint {
                middle: 0.03 * lean + 0.01 * part(0.754_877_666_246) + 1e-7,
                rate: 2.0 * part(0.569_840_290_998) - 1.0,
                circle: 0.03,
                p: DVec2::new(lean, 0.0),
                q: DVec2::new(math::cos(turn), math::sin(turn)) * (20.0 * part(0.220_744_084_605)),
                m: 10.0 + 30.0 * part(0.819_172_513_396),
            };
            let limit = 0.1;
            let time = low.earliest(limit);
            let steps = 2000;
            let first = (1..=steps).map(|i| limit * f64::from(i) / f64::from(steps)).find(|&t| low.at(t) < 0.0);
            if let Some(first) = first {
                found += 1;
                assert!(time <= first, "{low:?}: {time} after {first}");
                assert!(time >= 0.5 * first - 2.0 * limit / f64::from(steps), "{low:?}: {time} long before {first}");
            } else {
                assert!(low.at(time.min(limit)) >= -1e-15, "{low:?}");
            }
        }
        assert!(found > 2000, "{found}");
    }

    #[test]
    fn an_overlap_that_opens_can_sink_when_the_ring_has_levelled() {
        // Leaning by 0.1 and levelling at 2 rad/s: the lowest point rises until the other side comes down, after 0.05 s
        // except for the bound's own fall.
        let low = LowestRimPoint {
            middle: 0.03 * 0.1 - 1e-9,
            rate: 0.0,
            circle: 0.03,
            p: DVec2::new(0.1, 0.0),
            q: DVec2::new(-2.0, 0.0),
            m: 1e-6,
        };
        let time = low.earliest(1.0);
        // The bracket is 0.06/m = 6e4 s long: 2⁻⁴⁰ of it.
        assert!((time - 0.05).abs() < 1e-7, "{time}");
    }
}

//! A lower bound on the gap of two pieces along a direction while their bodies move, for conservative advancement (see
//! `convex.rs`).

use crate::rigid::body_state::Pose;
use crate::rigid::tolerances::BOUND_ROOT_ROUNDS;
use crate::roots::earliest;
use glam::DVec3;

/// Where both bodies are.
pub(crate) struct PosePair {
    pub(crate) a: Pose,
    pub(crate) b: Pose,
}

/// A direction, how it turns, and a bound on the acceleration of gaps along it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Along {
    pub(crate) normal: DVec3,
    /// Its rate of change; 0 for one that is fixed.
    pub(crate) across: DVec3,
    pub(crate) m: f64,
}

impl Along {
    pub(crate) fn fixed(normal: DVec3, m: f64) -> Self {
        Self { normal, across: DVec3::ZERO, m }
    }
}

/// The lower bound on a gap along a direction.
pub(crate) struct SeparationBound {
    f: f64,
    normal: DVec3,
    /// How the direction turns as each body sees it.
    turns: [DVec3; 2],
    rate: f64,
    m: f64,
}

impl SeparationBound {
    pub(crate) fn new(f: f64, along: Along, scene: &PosePair) -> Self {
        let Along { normal, across, m } = along;
        let turns = [across + normal.cross(scene.a.w), across + normal.cross(scene.b.w)];
        let rate = normal.dot(scene.a.v - scene.b.v) + across.dot(scene.a.x - scene.b.x);
        Self { f, normal, turns, rate, m }
    }

    /// Whether the bound is positive for this time.
    pub(crate) fn holds(&self, time: f64, first: impl Fn(DVec3) -> f64, second: impl Fn(DVec3) -> f64) -> bool {
        let n = self.normal;
        let start = first(-n) + second(n);
        let low = first(-(n + self.turns[0] * time)) + second(n + self.turns[1] * time) - start;
        // It is concave.
        self.f > 0.0 && self.f - low + (self.rate - 0.5 * self.m * time) * time > 0.0
    }

    /// A time up to which the bound is positive, limited to `limit`. `rate` is that of the nearest points, whose own
    /// bound is higher; the supports are about the centres of gravity.
    pub(crate) fn root(
        &self,
        rate: f64,
        limit: f64,
        first: impl Fn(DVec3) -> f64,
        second: impl Fn(DVec3) -> f64,
    ) -> f64 {
        let mut high = earliest(self.f, rate, self.m).min(limit);
        if self.f <= 0.0 {
            return high;
        }
        let n = self.normal;
        let start = first(-n) + second(n);
        let at = |t: f64| {
            let low = first(-(n + self.turns[0] * t)) + second(n + self.turns[1] * t) - start;
            self.f - low + (self.rate - 0.5 * self.m * t) * t
        };
        let mut at_high = at(high);
        if at_high >= 0.0 {
            return high;
        }
        // The chord of a concave function lies below it.
        let (mut low, mut at_low) = (0.0, self.f);
        for _ in 0..BOUND_ROOT_ROUNDS {
            let chord = low + (high - low) * (at_low / (at_low - at_high));
            (low, at_low) = (chord, at(chord));
            if at_low <= 0.0 || high - low <= 0.01 * low {
                break;
            }
            let middle = 0.5 * (low + high);
            let at_middle = at(middle);
            if at_middle > 0.0 { (low, at_low) = (middle, at_middle) } else { (high, at_high) = (middle, at_middle) }
        }
        low
    }
}

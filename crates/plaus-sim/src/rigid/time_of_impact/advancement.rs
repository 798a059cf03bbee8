//! What searches for a first contact share: lower bounds on gaps, how far a search may advance, and what it remembers
//! of pairs of pieces.

use crate::rigid::body_state::{Pose, RigidBodyState};
use crate::rigid::narrow_phase::contact_id::ContactId;
use crate::rigid::tolerances::{BOUND_ROOT_ROUNDS, LEAST_FLIGHT_ADVANCE, PAIR_LOOKAHEAD, PAIR_SOON};
use crate::roots::earliest;
use crate::shape::convex_pair::Mark;
use crate::shape::piece::Placed;
use crate::special_case::SpecialCase;
use glam::DVec3;

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

/// Where both bodies are.
pub(crate) struct PosePair {
    pub(crate) a: Pose,
    pub(crate) b: Pose,
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
    /// Along a direction, for gaps that are accelerated by at most `m`.
    pub(crate) fn new(f: f64, normal: DVec3, m: f64, scene: &PosePair) -> Self {
        let turns = [normal.cross(scene.a.w), normal.cross(scene.b.w)];
        Self { f, normal, turns, rate: normal.dot(scene.a.v - scene.b.v), m }
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

/// How pieces that are examined go on.
pub(super) struct Advance {
    /// For how long at least nothing new touches.
    pub(super) step: f64,
    /// The point that approaches fastest, and its rate.
    pub(super) struck: Option<(f64, ContactId)>,
    /// The nearest points, if nothing else was found.
    pub(super) nearest: Option<(f64, ContactId)>,
}

/// What the last look at a pair of pieces of two bodies found: the direction along which they were apart, 0 if none is
/// known; the elements that were nearest; and the time up to which nothing new touches there, so that looks before it
/// leave the pair out.
#[derive(Debug, Clone, Copy)]
pub(super) struct PairCache {
    pub(super) along: DVec3,
    pub(super) mark: Option<Mark>,
    pub(super) until: f64,
}

/// What is known of all pairs of pieces.
pub(super) struct PairCaches<'w> {
    pub(super) all: Vec<PairCache>,
    /// The second body's pieces where they are now, as far as they were asked for.
    pub(super) seconds: Vec<Option<Placed<'w>>>,
    /// When pairs were last looked at.
    seen: Option<f64>,
    /// How long the bounds hold by which pairs are proved to be apart.
    pub(super) longest: f64,
}

impl PairCache {
    pub(super) const UNKNOWN: Self = Self { along: DVec3::ZERO, mark: None, until: f64::NEG_INFINITY };
    /// Kept apart for as long as the look says.
    pub(super) const APART: Self = Self { until: f64::INFINITY, ..Self::UNKNOWN };
}

impl PairCaches<'_> {
    /// Nothing is known.
    pub(super) fn new(longest: f64) -> Self {
        Self { all: Vec::new(), seconds: Vec::new(), seen: None, longest }
    }

    /// Begins a look. Returns a time: a pair that is known to be apart only up to then, hardly longer than the last
    /// step, is looked at together with the others.
    pub(super) fn begin(&mut self, time: f64, step: f64) -> f64 {
        self.seconds.clear();
        let last = self.seen.replace(time).map_or(step, |seen| step.min(time - seen));
        time + PAIR_SOON * last
    }
}

impl Advance {
    /// Looks at a pair of pieces, unless nothing new is known to touch there for now.
    pub(super) fn examine(
        &mut self,
        cache: &mut PairCache,
        [time, soon, longest]: [f64; 3],
        look: impl FnOnce(&mut Self, PairCache) -> PairCache,
    ) {
        if SpecialCase::Remembered.is_on() && cache.until > soon {
            self.step = self.step.min(cache.until - time);
            return;
        }
        let step = self.step;
        self.step = (step * PAIR_LOOKAHEAD).min(longest);
        let found = look(self, *cache);
        *cache = PairCache { until: found.until.min(time + self.step), ..found };
        self.step = step.min(self.step);
    }

    pub(super) fn touches(&mut self, rate: f64, id: ContactId) {
        if rate < 0.0 && self.struck.is_none_or(|s| rate < s.0) {
            self.struck = Some((rate, id));
        }
    }
}

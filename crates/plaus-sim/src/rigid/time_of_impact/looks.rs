//! What looks at pairs of pieces find, and how long it holds.

use crate::rigid::narrow_phase::contact_id::ContactId;
use crate::rigid::tolerances::{PAIR_LOOKAHEAD, PAIR_SOON};
use crate::shape::convex_pair::Mark;
use crate::shape::piece::Placed;
use glam::DVec3;

/// How pieces that are examined go on.
pub(super) struct Next {
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
pub(super) struct Side {
    pub(super) along: DVec3,
    pub(super) mark: Option<Mark>,
    pub(super) until: f64,
}

/// What is known of all pairs of pieces.
pub(super) struct Sides<'w> {
    pub(super) all: Vec<Side>,
    /// The second body's pieces where they are now, as far as they were asked for.
    pub(super) seconds: Vec<Option<Placed<'w>>>,
    /// When pairs were last looked at.
    seen: Option<f64>,
    /// How long the bounds hold by which pairs are proved to be apart.
    pub(super) longest: f64,
}

impl Side {
    pub(super) const UNKNOWN: Self = Self { along: DVec3::ZERO, mark: None, until: f64::NEG_INFINITY };
    /// Kept apart for as long as the look says.
    pub(super) const APART: Self = Self { until: f64::INFINITY, ..Self::UNKNOWN };
}

impl Sides<'_> {
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

impl Next {
    /// Looks at a pair of pieces, unless nothing new is known to touch there for now.
    pub(super) fn look_at(
        &mut self,
        side: &mut Side,
        [time, soon, longest]: [f64; 3],
        look: impl FnOnce(&mut Self, Side) -> Side,
    ) {
        if side.until > soon {
            self.step = self.step.min(side.until - time);
            return;
        }
        let step = self.step;
        self.step = (step * PAIR_LOOKAHEAD).min(longest);
        let found = look(self, *side);
        *side = Side { until: found.until.min(time + self.step), ..found };
        self.step = step.min(self.step);
    }

    pub(super) fn touches(&mut self, rate: f64, id: ContactId) {
        if rate < 0.0 && self.struck.is_none_or(|s| rate < s.0) {
            self.struck = Some((rate, id));
        }
    }
}

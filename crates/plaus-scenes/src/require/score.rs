//! How well something is met, and what it can still come to.

use serde::{Deserialize, Serialize};

/// The largest absolute value of a margin, in nats. An event that never happens has a margin this far below 0.
pub const FAR: f64 = 1e6;

/// How well a requirement is met.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Mark {
    /// The margin in nats: at least 0 if it is met.
    pub margin: f64,
    /// Its contribution to the log density, in nats: usually the margin if that is negative, else 0.
    pub log: f64,
}

impl Mark {
    /// A margin; if it is negative, the state loses as much.
    #[must_use]
    pub fn of(margin: f64) -> Self {
        let margin = margin.clamp(-FAR, FAR);
        Self { margin, log: margin.min(0.0) }
    }

    /// Of things that are each right or wrong: so many are wrong, with so many faults together. The margin lies half a
    /// thing beyond, so that no number lies on an edge.
    #[must_use]
    pub fn of_faults(wrong: u32, faults: u32, nats_each: f64) -> Self {
        Self { margin: nats_each * (0.5 - f64::from(wrong)), log: -nats_each * f64::from(faults) }
    }

    /// Of what a scene itself asks for: if that is not met, minus the number of things that are wrong; `None` if the
    /// simulation did not come to its end.
    #[must_use]
    pub fn of_own(met: bool, wrong: Option<usize>) -> Self {
        Self::of(if met { 0.0 } else { wrong.map_or(-FAR, |wrong| -(wrong as f64)) })
    }

    /// Whether it is met.
    #[must_use]
    pub fn met(&self) -> bool {
        self.margin >= 0.0
    }
}

/// The range of marks that a requirement may end up with, whatever the unknown part of a motion does. If the motion is
/// known to its end, both ends are the same.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reach {
    /// The worst possible mark.
    pub least: Mark,
    /// The best possible mark.
    pub most: Mark,
}

impl Reach {
    /// Margins from one to another.
    #[must_use]
    pub fn between(least: f64, most: f64) -> Self {
        Self { least: Mark::of(least), most: Mark::of(most) }
    }

    /// The mark of an event that never happens.
    pub const NEVER: Self = {
        let mark = Mark { margin: -FAR, log: -FAR };
        Self { least: mark, most: mark }
    };

    /// The same, if the event may also never happen.
    #[must_use]
    pub fn or_never(self) -> Self {
        Self { least: Self::NEVER.least, ..self }
    }

    /// Only the best possible margin is known.
    #[must_use]
    pub fn up_to(most: f64) -> Self {
        Self::between(-FAR, most)
    }

    /// A margin that is certain.
    #[must_use]
    pub fn certain(margin: f64) -> Self {
        Self::between(margin, margin)
    }

    /// The opposite: met exactly if this is not.
    #[must_use]
    pub fn opposite(self) -> Self {
        // The next smaller number, so that of a margin of 0 and its opposite only one is met.
        let turned = |mark: Mark| Mark::of((-mark.margin).next_down());
        Self { least: turned(self.most), most: turned(self.least) }
    }
}

/// A range of values. An end is infinite if there is none; for times, also if the event may never happen.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Span {
    /// Lower end.
    pub low: f64,
    /// Upper end.
    pub high: f64,
}

impl Span {
    /// One value.
    #[must_use]
    pub fn at(value: f64) -> Self {
        Self { low: value, high: value }
    }

    /// A value that is at least `low`, if it ever comes.
    #[must_use]
    pub fn from(low: f64) -> Self {
        Self { low, high: f64::INFINITY }
    }

    /// Never.
    pub const NEVER: Self = Self { low: f64::INFINITY, high: f64::INFINITY };
}

/// An allowed range, and how far outside it costs one nat.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Band {
    /// Lower end; −∞ if there is none.
    pub from: f64,
    /// Upper end; ∞ if there is none.
    pub to: f64,
    /// The distance that costs one nat.
    pub scale: f64,
}

impl Band {
    /// A band between two limits; `None` is no limit.
    #[must_use]
    pub fn of_limits(at_least: Option<f64>, at_most: Option<f64>, scale: f64) -> Self {
        Self { from: at_least.unwrap_or(f64::NEG_INFINITY), to: at_most.unwrap_or(f64::INFINITY), scale }
    }

    /// How far inside a value lies, in nats. Infinity means an event that never happened: as far outside as possible.
    #[must_use]
    pub fn margin(&self, value: f64) -> f64 {
        if value == f64::INFINITY {
            return -FAR;
        }
        let inside = (value - self.from).min(self.to - value);
        if inside == f64::INFINITY { 1.0 } else { (inside / self.scale).clamp(-FAR, FAR) }
    }

    /// The same for a value that is not known yet.
    #[must_use]
    pub fn reach(&self, span: Span) -> Reach {
        let (low, high) = (self.margin(span.low), self.margin(span.high));
        // The margin rises up to the middle and falls after it.
        let middle = match (self.from.is_finite(), self.to.is_finite()) {
            (true, true) => 0.5 * (self.from + self.to),
            (true, false) => span.high.min(f64::MAX),
            _ => span.low,
        };
        let best = self.margin(middle.clamp(span.low, span.high));
        Reach::between(low.min(high), low.max(high).max(best))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_band_bounds_what_a_span_can_come_to() {
        for (from, to) in [(1.0, 3.0), (f64::NEG_INFINITY, 3.0), (1.0, f64::INFINITY)] {
            let band = Band { from, to, scale: 0.5 };
            for (low, high) in [(0.0, 1.5), (0.0, 9.0), (2.5, 9.0), (5.0, f64::INFINITY), (0.0, f64::INFINITY)] {
                let reach = band.reach(Span { low, high });
                let values = (0..1000).map(|i| low + 0.01 * f64::from(i)).filter(|value| *value <= high);
                let values: Vec<f64> = values.chain([low, high]).collect();
                for value in values {
                    let margin = band.margin(value);
                    assert!(margin >= reach.least.margin && margin <= reach.most.margin, "{band:?} {value} {reach:?}");
                }
            }
        }
        assert_eq!(Band { from: 1.0, to: 3.0, scale: 0.5 }.margin(2.5), 1.0);
        assert_eq!(Band { from: f64::NEG_INFINITY, to: f64::INFINITY, scale: 0.5 }.margin(f64::INFINITY), -FAR);
    }

    #[test]
    fn of_a_margin_and_its_opposite_one_is_met() {
        for margin in [-2.0, -5e-324, -0.0, 0.0, 5e-324, 2.0] {
            let reach = Reach::certain(margin);
            assert_ne!(reach.most.met(), reach.opposite().most.met(), "{margin}");
            assert_eq!(reach.most.met(), reach.opposite().opposite().most.met(), "{margin}");
        }
    }
}

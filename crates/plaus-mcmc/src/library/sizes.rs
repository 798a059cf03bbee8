//! Sizes of steps.

use crate::scale::Scale;
use plaus_dist::{Stream, math, open_unit, standard_normal};

/// How far the sizes of an adapted step reach on either side of its scale, as a natural logarithm: up to a factor e.
const NARROW: f64 = 1.0;

/// Share of an adapted step's sizes that still come from the whole range. If a target has several hills, or a hill that
/// narrows, other sizes work better elsewhere.
const WIDE_SHARE: f64 = 0.2;

/// Sizes of steps, uniform in their logarithm between two ends within (0, 1]. Steps of all sizes are tried all the
/// time, so none has to be tuned. Once a chain has adapted the scale, most sizes are near it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sizes {
    from: f64,
    to: f64,
    about: Option<f64>,
}

impl Sizes {
    /// Between two ends, in either order.
    #[must_use]
    pub fn new(a: f64, b: f64) -> Self {
        Self { from: math::ln(a.min(b)), to: math::ln(a.max(b)), about: None }
    }

    /// From 1 down to `least`.
    #[must_use]
    pub fn down_to(least: f64) -> Self {
        Self { from: 0.0, to: math::ln(least), about: None }
    }

    /// Near an adapted scale; without one, between the two ends.
    #[must_use]
    pub fn about(self, scale: Option<f64>) -> Self {
        Self { about: scale.map(math::ln), ..self }
    }

    /// The scale that these sizes declare to the chain; `target` is the share of steps to accept.
    #[must_use]
    pub fn declared(self, name: &'static str, target: f64) -> Scale {
        let (low, high) = (self.from.min(self.to), self.from.max(self.to));
        let [start, least, most] = [0.5 * (low + high), low, high].map(math::exp);
        Scale { name, start, least, most, target }
    }

    /// A size, and whether it comes from the whole range.
    pub fn sample(self, stream: &mut Stream) -> (f64, bool) {
        let whole = |stream: &mut Stream| self.from + (self.to - self.from) * open_unit(stream);
        let (log, is_wide) = match self.about {
            Some(about) if open_unit(stream) >= WIDE_SHARE => (about + NARROW * (2.0 * open_unit(stream) - 1.0), false),
            _ => (whole(stream), true),
        };
        (math::exp(log).min(1.0), is_wide)
    }

    /// A step that leaves the standard normal law invariant, see `normal_step`; and whether its size comes from the
    /// whole range.
    pub fn step(self, z: f64, stream: &mut Stream) -> (f64, bool) {
        let (s, is_wide) = self.sample(stream);
        (normal_step(s, z, stream), is_wide)
    }
}

/// A step of size `s` that leaves the standard normal law invariant: weighted by that law, a step from z to z' is as
/// likely as the step back (Neal, "Regression and classification using Gaussian process priors", 1998; the
/// autoregressive proposal).
#[must_use]
pub fn normal_step(s: f64, z: f64, stream: &mut Stream) -> f64 {
    (1.0 - s * s).max(0.0).sqrt() * z + s * standard_normal(stream)
}

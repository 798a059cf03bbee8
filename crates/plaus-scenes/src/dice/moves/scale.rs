//! Sizes of steps.

use crate::walk::{NARROW, WIDE_SHARE};
use plaus_dist::{Stream, math, open_unit, standard_normal};

/// Sizes of steps: uniform in their logarithm between two ends within (0, 1]. Steps of all sizes are tried all the
/// time, so that none has to be tuned; or, once a chain has adapted the scale, most of them about that.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scale {
    low: f64,
    high: f64,
    about: Option<f64>,
}

impl Scale {
    /// Between two ends, in either order.
    #[must_use]
    pub fn new(a: f64, b: f64) -> Self {
        Self { low: math::ln(a.min(b)), high: math::ln(a.max(b)), about: None }
    }

    /// About a scale that was adapted; without one, between the two ends.
    #[must_use]
    pub fn about(self, scale: Option<f64>) -> Self {
        Self { about: scale.map(math::ln), ..self }
    }

    /// As the chain is told of it; it should accept so many steps.
    pub(super) fn declared(self, name: &'static str, target: f64) -> plaus_mcmc::Scale {
        let [start, least, most] = [0.5 * (self.low + self.high), self.low, self.high].map(math::exp);
        plaus_mcmc::Scale { name, start, least, most, target }
    }

    /// A size, and whether it comes from the whole range.
    pub(super) fn sample(self, stream: &mut Stream) -> (f64, bool) {
        let whole = |stream: &mut Stream| self.low + (self.high - self.low) * open_unit(stream);
        let (log, is_wide) = match self.about {
            Some(about) if open_unit(stream) >= WIDE_SHARE => (about + NARROW * (2.0 * open_unit(stream) - 1.0), false),
            _ => (whole(stream), true),
        };
        (math::exp(log).min(1.0), is_wide)
    }

    /// A step that leaves the standard normal law as it is: as likely from z to z' as back, weighed by that law (Neal,
    /// "Regression and classification using Gaussian process priors", 1998; the autoregressive proposal). And whether
    /// its size comes from the whole range.
    pub(super) fn step(self, z: f64, stream: &mut Stream) -> (f64, bool) {
        let (s, is_wide) = self.sample(stream);
        ((1.0 - s * s).max(0.0).sqrt() * z + s * standard_normal(stream), is_wide)
    }
}

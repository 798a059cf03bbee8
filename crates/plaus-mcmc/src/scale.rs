//! The scales that a move may leave to its chain (see `adapt.rs`).

use plaus_dist::math;

/// A scale that a move leaves to its chain.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scale {
    /// A short name, within its move.
    pub name: &'static str,
    /// Where adaptation begins, from `least` to `most`.
    pub start: f64,
    /// The smallest, above 0.
    pub least: f64,
    /// The largest.
    pub most: f64,
    /// The share of proposals that should be accepted: [`Scale::ONE`], [`Scale::MANY`] or another between 0 and 1. It
    /// falls as the scale grows.
    pub target: f64,
}

impl Scale {
    /// For steps along one dimension: best for a Gaussian step on a Gaussian target (Gelman, Roberts and Gilks,
    /// "Efficient Metropolis jumping rules", 1996; Garthwaite, Fan and Sisson, Communications in Statistics 45, 2016).
    pub const ONE: f64 = 0.44;
    /// For steps along many dimensions at once: best in the limit (Roberts, Gelman and Gilks 1997; Roberts and
    /// Rosenthal, "Optimal scaling for various Metropolis–Hastings algorithms", Statistical Science 16, 2001).
    pub const MANY: f64 = 0.234;

    pub(crate) fn log(&self, value: f64) -> f64 {
        math::ln(value.clamp(self.least, self.most))
    }
}

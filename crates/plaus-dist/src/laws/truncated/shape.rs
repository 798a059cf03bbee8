//! The restricted standard normal, up to shift, scale and reflection: its integral, and the proposals of its sampler.

use crate::gaussian::HALF_LN_TAU;
use crate::{Stream, math, open_unit};
use std::f64::consts::{FRAC_1_SQRT_2, TAU};

/// Where the interval, in standard deviations, lies about the mean.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Shape {
    /// The mean is inside (or an end). `narrow` intervals are sampled from the uniform law, others from the Gaussian;
    /// at least 49% of proposals are accepted, the worst case being an interval from the mean to √2π.
    Around { below: f64, above: f64, narrow: bool },
    /// The interval is above the mean.
    Above(Tail),
    /// Below it, measured downwards from its upper end.
    Below(Tail),
}

impl Shape {
    /// The interval from `below` to `above`, `width` wide. The width is given separately, because the difference of far
    /// ends may be nothing but rounding.
    pub(super) fn new(below: f64, above: f64, width: f64) -> Self {
        if below > 0.0 {
            Self::Above(Tail::new(below, width))
        } else if above < 0.0 {
            Self::Below(Tail::new(-above, width))
        } else {
            Self::Around { below, above, narrow: width < TAU.sqrt() }
        }
    }

    /// ∫ exp(−(z² − c²)/2) dz over the interval, c its point nearest the mean: never underflows, relative error below
    /// 1e-13.
    pub(super) fn integral(&self) -> f64 {
        match *self {
            Self::Around { below, above, .. } => {
                0.5 * TAU.sqrt() * (math::erf(above * FRAC_1_SQRT_2) + math::erf(-below * FRAC_1_SQRT_2))
            }
            Self::Above(tail) | Self::Below(tail) => tail.integral(),
        }
    }

    /// Log of the mass of the interval.
    pub(super) fn log_mass(&self) -> f64 {
        let near = match *self {
            Self::Around { .. } => 0.0,
            Self::Above(tail) | Self::Below(tail) => tail.near,
        };
        math::ln(self.integral()) - 0.5 * near * near - HALF_LN_TAU
    }
}

/// An interval from `near` > 0 to `near + width` standard deviations; points are given by their distance `t` from
/// `near`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Tail {
    near: f64,
    width: f64,
    /// Rate of the exponential proposal, Robert's optimum `(near + √(near² + 4))/2`.
    rate: f64,
    /// `exp(−rate · width) − 1`.
    span: f64,
    /// Distance at which target over proposal is largest: 1/rate, or the far end before it.
    summit: f64,
}

impl Tail {
    fn new(near: f64, width: f64) -> Self {
        let rate = 0.5 * (near + (near * near + 4.0).sqrt());
        Self { near, width, rate, span: math::exp_m1(-rate * width), summit: width.min(1.0 / rate) }
    }

    /// By how much the log density at `t` is below that at `near`.
    #[inline]
    pub(super) fn drop(&self, t: f64) -> f64 {
        t * (self.near + 0.5 * t)
    }

    /// ∫ exp(−drop(t)) dt over [0, width].
    ///
    /// If the integrand falls by less than a factor √e: eight-point Gauss–Legendre, whose error is below 1e-16 (worst
    /// for the half-bell `near` = 0, `width` = 1). Otherwise the difference of two scaled error functions, which loses
    /// at most a factor 1/(1 − 1/√e) = 2.5 to cancellation.
    fn integral(&self) -> f64 {
        const NODES: [(f64, f64); 4] = [
            (0.183_434_642_495_649_8, 0.362_683_783_378_362),
            (0.525_532_409_916_329, 0.313_706_645_877_887_3),
            (0.796_666_477_413_626_7, 0.222_381_034_453_374_48),
            (0.960_289_856_497_536_3, 0.101_228_536_290_376_26),
        ];
        let fall = self.drop(self.width);
        if fall < 0.5 {
            let half = 0.5 * self.width;
            let value = |s: f64| math::exp(-self.drop(half * (1.0 + s)));
            return half * NODES.iter().map(|&(s, weight)| weight * (value(s) + value(-s))).sum::<f64>();
        }
        let scaled = |z: f64| math::erfc_scaled(z * FRAC_1_SQRT_2);
        0.5 * TAU.sqrt() * (scaled(self.near) - math::exp(-fall) * scaled(self.near + self.width))
    }

    /// A distance from `near`: truncated exponential by inversion, then accepted with probability target/proposal over
    /// that at the summit, which is `exp(−((t − 1/rate)² − (summit − 1/rate)²)/2)`.
    pub(super) fn sample(&self, stream: &mut Stream) -> f64 {
        loop {
            let t = -math::ln_1p(open_unit(stream) * self.span) / self.rate;
            let log_accept = -0.5 * (t - self.summit) * (t + self.summit - 2.0 / self.rate);
            if open_unit(stream) < math::exp(log_accept) {
                return t;
            }
        }
    }
}

//! The Gaussian on the real line.

use crate::normal::standard_normal;
use crate::param::ParamError;
use crate::{Density, LogDensity, NotANumber, Sample, Stream, math};
use serde::{Deserialize, Serialize};

/// ½ ln 2π: minus the log density of N(0, 1) at its peak.
pub(crate) const HALF_LN_TAU: f64 = 0.918_938_533_204_672_8;

/// Normal law around a mean.
///
/// Density `exp(−((x − mean)/sd)²/2) / (sd √2π)` per unit of x, in x's own unit. Far out, where even the log (about
/// `−z²/2` for x at `z` standard deviations) passes the largest float (z > 1.8e154), it is −∞.
///
/// ```
/// use plaus_dist::{Density, Gaussian};
/// let facet = Gaussian::new(0.0, 10.0)?; // degrees
/// let drop = facet.log_density(&10.0)?.value() - facet.log_density(&0.0)?.value();
/// assert!((drop + 0.5).abs() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Unchecked")]
pub struct Gaussian {
    mean: f64,
    sd: f64,
    #[serde(skip)]
    log_peak: f64,
}

#[derive(Deserialize)]
#[serde(rename = "Gaussian", deny_unknown_fields)]
struct Unchecked {
    mean: f64,
    sd: f64,
}

impl TryFrom<Unchecked> for Gaussian {
    type Error = ParamError;
    fn try_from(raw: Unchecked) -> Result<Self, ParamError> {
        Self::new(raw.mean, raw.sd)
    }
}

impl Gaussian {
    /// Mean `mean` and standard deviation `sd`, both in the unit of x.
    ///
    /// # Errors
    /// [`ParamError`] unless |mean| ≤ 1e300 and 1e-300 ≤ sd ≤ 1e300.
    pub fn new(mean: f64, sd: f64) -> Result<Self, ParamError> {
        ParamError::check_location("normal law", "mean", mean)?;
        ParamError::check_scale("normal law", "standard deviation", sd)?;
        Ok(Self { mean, sd, log_peak: -math::ln(sd) - HALF_LN_TAU })
    }

    /// The mean.
    #[inline]
    #[must_use]
    pub fn mean(&self) -> f64 {
        self.mean
    }

    /// The standard deviation.
    #[inline]
    #[must_use]
    pub fn sd(&self) -> f64 {
        self.sd
    }
}

/// `(x − mean)/sd`, also where the difference overflows or either is infinite (not both on the same side). NaN for a
/// NaN only.
#[inline]
pub(crate) fn standardised(x: f64, mean: f64, sd: f64) -> f64 {
    let offset = x - mean;
    if offset.abs() < f64::INFINITY { offset / sd } else { (0.25 * x - 0.25 * mean) / (0.25 * sd) }
}

impl Density<f64> for Gaussian {
    /// # Errors
    /// [`NotANumber`] if `x` is NaN. At ±∞ the density is 0.
    #[inline]
    fn log_density(&self, x: &f64) -> Result<LogDensity, NotANumber> {
        LogDensity::new(self.log_peak - 0.5 * math::square(standardised(*x, self.mean, self.sd)))
    }
}

impl Sample for Gaussian {
    type Value = f64;
    #[inline]
    fn sample(&self, stream: &mut Stream) -> f64 {
        self.mean + self.sd * standard_normal(stream)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{KS_LIMIT, draws, integrate, ks, ks_two, stored, stream};
    use proptest::prelude::*;
    use rand::RngExt;
    use statrs::distribution::{Continuous, ContinuousCDF, Normal};

    #[test]
    fn density_agrees_with_statrs_and_is_normalised() {
        let (ours, theirs) = (Gaussian::new(-3.0, 0.7).unwrap(), Normal::new(-3.0, 0.7).unwrap());
        for x in [-3.0, -2.5, 0.0, 17.0] {
            // Relative: two formulas of a handful of roundings each.
            assert!((ours.log_density(&x).unwrap().value() / theirs.ln_pdf(x) - 1.0).abs() < 1e-14);
        }
        // The mass past 12 sd is 4e-33; the rule is exact to rounding for this integrand.
        let mass = integrate(-3.0 - 8.4, -3.0 + 8.4, |x| math::exp(ours.log_density(&x).unwrap().value()));
        assert!((mass - 1.0).abs() < 1e-12, "{mass}");
    }

    #[test]
    fn draws_agree_with_the_law_and_a_law_two_per_cent_wider_does_not() {
        let x = draws(&Gaussian::new(2.0, 5.0).unwrap(), 1_000_000, 21);
        let misfit = |sd: f64| {
            let law = Normal::new(2.0, sd).unwrap();
            ks(x.iter().copied(), |x| law.cdf(x))
        };
        assert!(misfit(5.0) < KS_LIMIT);
        // The widest gap, 0.02 φ(1) = 0.0048, is 4.8 at √n = 1000.
        assert!(misfit(5.1) > KS_LIMIT);
    }

    #[test]
    fn draws_agree_with_those_of_rand_distr() {
        let ours = draws(&Gaussian::new(2.0, 5.0).unwrap(), 1_000_000, 22);
        let mut stream = stream(23);
        let mut misfit = |sd: f64| {
            let law = rand_distr::Normal::new(2.0, sd).unwrap();
            let theirs = (0..1_000_000).map(|_| stream.sample(law)).collect();
            ks_two(ours.clone(), theirs)
        };
        assert!(misfit(5.0) < KS_LIMIT);
        assert!(misfit(5.1) > KS_LIMIT);
    }

    #[test]
    fn extremes_stay_values() {
        for sd in [1e-300, 1.0, 1e300] {
            let law = Gaussian::new(0.0, sd).unwrap();
            let peak = law.log_density(&0.0).unwrap().value();
            assert!((peak + math::ln(sd) + HALF_LN_TAU).abs() < 1e-12, "{peak}");
            let far = law.log_density(&(-1e8 * sd)).unwrap().value();
            // −½ 10¹⁶, to a relative rounding.
            assert!((far / -5e15 - 1.0).abs() < 1e-12, "{far}");
            assert!(law.log_density(&f64::INFINITY).unwrap().is_zero());
            assert!(law.log_density(&f64::NAN).is_err());
            assert!(law.sample(&mut stream(24)).is_finite());
        }
        // 1e300/1e-300 overflows, and must not meet an infinity of its own sign.
        assert!(Gaussian::new(1e300, 1e-300).unwrap().log_density(&f64::INFINITY).unwrap().is_zero());
        // The offset overflows, its quotient by sd does not: z = (1.797…e308 + 1e300)/1e300.
        let wide = Gaussian::new(-1e300, 1e300).unwrap().log_density(&f64::MAX).unwrap().value();
        assert!((wide / (-0.5 * math::square(f64::MAX / 1e300 + 1.0)) - 1.0).abs() < 1e-9, "{wide}");
    }

    #[test]
    fn parameters_out_of_range_are_refused_also_from_storage() {
        for (mean, sd) in
            [(0.0, 0.0), (0.0, -1.0), (0.0, f64::NAN), (0.0, f64::INFINITY), (0.0, 1e-301), (f64::NAN, 1.0)]
        {
            assert!(Gaussian::new(mean, sd).is_err());
            assert!(Gaussian::deserialize(stored(&[("mean", mean), ("sd", sd)])).is_err());
        }
        let law = Gaussian::deserialize(stored(&[("mean", 1.0), ("sd", 2.0)])).unwrap();
        assert_eq!(law, Gaussian::new(1.0, 2.0).unwrap());
    }

    proptest! {
        #[test]
        fn never_nan(mean in -1e300..1e300_f64, exponent in -300..=300_i32, x in prop::num::f64::ANY) {
            let law = Gaussian::new(mean, math::powi(10.0, exponent).clamp(1e-300, 1e300)).unwrap();
            prop_assert_eq!(law.log_density(&x).is_err(), x.is_nan());
        }
    }
}

//! The Gaussian on the real line.

use crate::normal::standard_normal;
use crate::param::ParamError;
use crate::{Density, LogDensity, NotANumber, Sample, Stream, math};
use serde::{Deserialize, Serialize};

/// ½ ln 2π: minus the log density of N(0, 1) at its peak.
pub(crate) const HALF_LN_TAU: f64 = 0.918_938_533_204_672_8;

/// Normal law around a mean.
///
/// Density `exp(−((x − mean)/sd)²/2) / (sd √2π)` per unit of x, in x's own unit. Far out, where even the log (about `−z²/2` for
/// x at `z` standard deviations) passes the largest float (z > 1.8e154), it is −∞.
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
        ParamError::check_location("Gaussian", "mean", mean)?;
        ParamError::check_scale("Gaussian", "sd", sd)?;
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

/// `(x − mean)/sd`; where the difference overflows, the quotients are taken first. NaN for x = NaN only.
#[inline]
pub(crate) fn standardised(x: f64, mean: f64, sd: f64) -> f64 {
    let offset = x - mean;
    if offset.abs() < f64::INFINITY { offset / sd } else { x / sd - mean / sd }
}

impl Density<f64> for Gaussian {
    /// # Errors
    /// [`NotANumber`] where `x` is NaN. At ±∞ the density is 0.
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

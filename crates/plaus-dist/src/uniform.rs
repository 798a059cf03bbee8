//! The uniform law on an interval.

use crate::param::ParamError;
use crate::{Density, LogDensity, NotANumber, Sample, Stream, math, open_unit};
use serde::{Deserialize, Serialize};

/// Equal density on the half-open interval [low, high).
///
/// Density `1/(high − low)` inside and 0 outside, in the unit of x. Draws are at 2⁵² equally spaced values (fewer where the
/// interval holds fewer floats), and never `high`.
///
/// ```
/// use plaus_dist::{Density, Uniform};
/// let side = Uniform::new(-5.0, 5.0)?; // degrees
/// assert_eq!(side.log_density(&-5.0)?.value(), -std::f64::consts::LN_10);
/// assert!(side.log_density(&5.0)?.is_zero());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Unchecked")]
pub struct Uniform {
    low: f64,
    high: f64,
    #[serde(skip)]
    log_density: f64,
}

#[derive(Deserialize)]
#[serde(rename = "Uniform", deny_unknown_fields)]
struct Unchecked {
    low: f64,
    high: f64,
}

impl TryFrom<Unchecked> for Uniform {
    type Error = ParamError;
    fn try_from(raw: Unchecked) -> Result<Self, ParamError> {
        Self::new(raw.low, raw.high)
    }
}

impl Uniform {
    /// On [`low`, `high`).
    ///
    /// # Errors
    /// [`ParamError`] unless both are within ±1e300 and low < high.
    pub fn new(low: f64, high: f64) -> Result<Self, ParamError> {
        Self::named("Uniform", low, high)
    }

    /// The same, with errors in the name of another distribution.
    pub(crate) fn named(distribution: &'static str, low: f64, high: f64) -> Result<Self, ParamError> {
        ParamError::check_location(distribution, "low", low)?;
        ParamError::check_location(distribution, "high", high)?;
        ParamError::unless(low < high, distribution, "high", high, "above low")?;
        Ok(Self { low, high, log_density: -math::ln(high - low) })
    }

    /// The lower end, which belongs to the interval.
    #[inline]
    #[must_use]
    pub fn low(&self) -> f64 {
        self.low
    }

    /// The upper end, which does not.
    #[inline]
    #[must_use]
    pub fn high(&self) -> f64 {
        self.high
    }
}

impl Density<f64> for Uniform {
    /// # Errors
    /// [`NotANumber`] where `x` is NaN.
    #[inline]
    fn log_density(&self, x: &f64) -> Result<LogDensity, NotANumber> {
        if x.is_nan() {
            LogDensity::new(*x)
        } else if self.low <= *x && *x < self.high {
            LogDensity::new(self.log_density)
        } else {
            Ok(LogDensity::ZERO)
        }
    }
}

impl Sample for Uniform {
    type Value = f64;
    #[inline]
    fn sample(&self, stream: &mut Stream) -> f64 {
        loop {
            let x = self.low + (self.high - self.low) * open_unit(stream);
            // Rounding reaches `high` where the interval holds few floats; at worst every second draw.
            if x < self.high {
                return x;
            }
        }
    }
}

//! The uniform law on an interval.

use crate::param::ParamError;
use crate::{Density, LogDensity, NotANumber, Sample, Stream, math, open_unit};
use serde::{Deserialize, Serialize};

/// Equal density on the half-open interval [low, high).
///
/// Density `1/(high − low)` inside and 0 outside, in the unit of x. Draws are at 2⁵² equally spaced values (fewer where
/// the interval holds fewer floats), and never `high`.
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
        Self::named("uniform law", low, high)
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
    /// [`NotANumber`] if `x` is NaN.
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
            // Rounding reaches `high` if the interval holds few floats; at worst in every second draw.
            if x < self.high {
                return x;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{KS_LIMIT, draws, ks, ks_two, stored, stream};
    use rand::RngExt;

    #[test]
    fn draws_are_uniform_and_those_of_an_interval_one_per_cent_wider_are_not() {
        let misfit =
            |high: f64| ks(draws(&Uniform::new(-5.0, high).unwrap(), 200_000, 81).into_iter(), |x| (x + 5.0) / 10.0);
        assert!(misfit(5.0) < KS_LIMIT);
        assert!(misfit(5.1) > KS_LIMIT);
        let mut stream = stream(82);
        let theirs = (0..200_000).map(|_| stream.random_range(-5.0..5.0)).collect();
        assert!(ks_two(draws(&Uniform::new(-5.0, 5.0).unwrap(), 200_000, 83), theirs) < KS_LIMIT);
    }

    #[test]
    fn the_upper_end_is_never_drawn() {
        // Two neighbouring floats hold one value between them.
        let narrow = Uniform::new(1.0, 1.0_f64.next_up()).unwrap();
        assert!(draws(&narrow, 1000, 84).into_iter().all(|x| x == 1.0));
    }

    #[test]
    fn extremes_stay_values() {
        let smallest = Uniform::new(0.0, 5e-324).unwrap();
        assert!((smallest.log_density(&0.0).unwrap().value() - 744.440_071_921_381_3).abs() < 1e-9);
        assert_eq!(draws(&smallest, 100, 85), [0.0; 100]);
        let largest = Uniform::new(-1e300, 1e300).unwrap();
        assert!(largest.log_density(&1e299).unwrap().value().is_finite());
        assert!(largest.log_density(&f64::NEG_INFINITY).unwrap().is_zero());
        assert!(largest.log_density(&f64::NAN).is_err());
        assert!(draws(&largest, 100, 86).into_iter().all(f64::is_finite));
    }

    #[test]
    fn parameters_out_of_range_are_refused_also_from_storage() {
        for (low, high) in
            [(1.0, 1.0), (2.0, 1.0), (f64::NAN, 1.0), (0.0, f64::NAN), (f64::NEG_INFINITY, 0.0), (0.0, 2e300)]
        {
            assert!(Uniform::new(low, high).is_err());
            assert!(Uniform::deserialize(stored(&[("low", low), ("high", high)])).is_err());
        }
    }

    #[test]
    fn values_are_pinned() {
        let x = draws(&Uniform::new(-5.0, 5.0).unwrap(), 2, 1);
        assert_eq!([x[0].to_bits(), x[1].to_bits()], [13_830_642_261_952_445_616, 13_839_888_043_165_737_073]);
    }
}

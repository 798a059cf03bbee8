//! The triangular law.

use crate::number::as_number_law;
use crate::param::ParamError;
use crate::{Density, LogDensity, NotANumber, Sample, Stream, math, open_unit};

/// A density that rises evenly from `low` to `peak` and falls evenly from there to `high`: a guess with three numbers.
///
/// Density `2 (x − low)/((high − low)(peak − low))` below the peak and `2 (high − x)/((high − low)(high − peak))` above
/// it, per unit of x. Drawn by the inverse of the distribution function.
///
/// ```
/// use plaus_dist::{Density, Triangular};
/// let guess = Triangular::new(0.0, 1.0, 4.0)?;
/// assert!((guess.log_density(&1.0)?.value() - 0.5_f64.ln()).abs() < 1e-15);
/// assert!(guess.log_density(&4.1)?.is_zero());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Triangular {
    low: f64,
    peak: f64,
    high: f64,
    /// Log density at the peak.
    log_peak: f64,
}

const NAME: &str = "triangular law";

impl Triangular {
    /// Between `low` and `high`, most likely at `peak`, which may be an end.
    ///
    /// # Errors
    /// [`ParamError`] unless all are within ±1e300, low < high and low ≤ peak ≤ high.
    pub fn new(low: f64, peak: f64, high: f64) -> Result<Self, ParamError> {
        ParamError::check_location(NAME, "low", low)?;
        ParamError::check_location(NAME, "high", high)?;
        ParamError::unless(low < high, NAME, "high", high, "above low")?;
        ParamError::unless(low <= peak && peak <= high, NAME, "peak", peak, "from low to high")?;
        Ok(Self { low, peak, high, log_peak: std::f64::consts::LN_2 - math::ln(high - low) })
    }

    /// The least value.
    #[must_use]
    pub fn low(&self) -> f64 {
        self.low
    }

    /// The most likely value.
    #[must_use]
    pub fn peak(&self) -> f64 {
        self.peak
    }

    /// The largest value.
    #[must_use]
    pub fn high(&self) -> f64 {
        self.high
    }
}

impl Density<f64> for Triangular {
    /// # Errors
    /// [`NotANumber`] if `x` is NaN.
    fn log_density(&self, x: &f64) -> Result<LogDensity, NotANumber> {
        let x = *x;
        if x.is_nan() {
            return LogDensity::new(x);
        }
        let part = if x < self.peak {
            (x - self.low) / (self.peak - self.low)
        } else if x > self.peak {
            (self.high - x) / (self.high - self.peak)
        } else {
            1.0
        };
        if part > 0.0 { LogDensity::new(self.log_peak + math::ln(part)) } else { Ok(LogDensity::ZERO) }
    }
}

impl Sample for Triangular {
    type Value = f64;
    fn sample(&self, stream: &mut Stream) -> f64 {
        let (u, width) = (open_unit(stream), self.high - self.low);
        let below = (self.peak - self.low) / width;
        if u < below {
            self.low + (self.peak - self.low) * (u / below).sqrt()
        } else {
            self.high - (self.high - self.peak) * ((1.0 - u) / (1.0 - below)).sqrt()
        }
    }
}

as_number_law!(Triangular {
    fn support(&self) -> [f64; 2] {
        [self.low, self.high]
    }

    fn width(&self) -> f64 {
        self.high - self.low
    }
});

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{KS_LIMIT, draws, integrate, ks};

    fn cdf(law: &Triangular, x: f64) -> f64 {
        let width = law.high - law.low;
        if x < law.peak {
            math::square(x - law.low) / (width * (law.peak - law.low))
        } else {
            1.0 - math::square(law.high - x) / (width * (law.high - law.peak))
        }
    }

    #[test]
    fn draws_have_the_law_and_not_that_of_another_peak() {
        for (low, peak, high) in [(-1.0, 0.5, 3.0), (0.0, 0.0, 1.0), (2.0, 5.0, 5.0)] {
            let law = Triangular::new(low, peak, high).unwrap();
            let mass = integrate(low, peak, |x| math::exp(law.log_density(&x).unwrap().value()))
                + integrate(peak, high, |x| math::exp(law.log_density(&x).unwrap().value()));
            assert!((mass - 1.0).abs() < 1e-12, "{mass}");
            let drawn = draws(&law, 100_000, 11);
            assert!(ks(drawn.iter().copied(), |x| cdf(&law, x)) < KS_LIMIT);
            let other = Triangular::new(low, 0.5 * (low + high) + 0.1 * (high - low), high).unwrap();
            assert!(ks(drawn.into_iter(), |x| cdf(&other, x)) > KS_LIMIT);
        }
    }

    #[test]
    fn bad_numbers_are_refused() {
        let nan = f64::NAN;
        for (low, peak, high) in [(1.0, 1.0, 1.0), (0.0, 2.0, 1.0), (0.0, nan, 1.0), (nan, 0.0, 1.0), (0.0, 0.0, 1e301)]
        {
            assert!(Triangular::new(low, peak, high).is_err());
        }
        let law = Triangular::new(0.0, 0.0, 1.0).unwrap();
        assert!(law.log_density(&f64::NAN).is_err() && law.log_density(&-1.0).unwrap().is_zero());
    }

    #[test]
    fn values_are_pinned() {
        assert_eq!(
            draws(&Triangular::new(0.0, 1.0, 4.0).unwrap(), 2, 1),
            [1.312_362_320_251_000_2, 0.532_957_407_077_548_6]
        );
    }
}

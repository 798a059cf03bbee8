//! The log-normal law.

use crate::number::as_number_law;
use crate::param::ParamError;
use crate::{Density, Gaussian, LogDensity, NotANumber, Sample, Stream, math};

/// A positive number whose logarithm is Gaussian: a size, a stiffness, anything that is uncertain by a factor.
///
/// Density `φ(ln(x/median)/spread)/(x spread)` per unit of x. With a spread of 0.1 two thirds of all draws are within
/// about 10 % of the median.
///
/// ```
/// use plaus_dist::{Density, LogNormal};
/// let mass = LogNormal::new(2.0, 0.1)?; // kg
/// assert!(mass.log_density(&0.0)?.is_zero());
/// let (above, below) = (mass.log_density(&2.2)?.value(), mass.log_density(&(4.0 / 2.2))?.value());
/// // As far in factors, per unit of x less dense where x is larger.
/// assert!((below - above - (2.2_f64 / (4.0 / 2.2)).ln()).abs() < 1e-14);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LogNormal {
    log: Gaussian,
    median: f64,
}

const NAME: &str = "log-normal law";

impl LogNormal {
    /// With this median, and a logarithm of standard deviation `spread`.
    ///
    /// # Errors
    /// [`ParamError`] unless the median is from 1e-100 to 1e100 and the spread from 1e-9 to 10.
    pub fn new(median: f64, spread: f64) -> Result<Self, ParamError> {
        ParamError::unless((1e-100..=1e100).contains(&median), NAME, "median", median, "from 1e-100 to 1e100")?;
        ParamError::unless((1e-9..=10.0).contains(&spread), NAME, "spread", spread, "from 1e-9 to 10")?;
        Ok(Self { log: Gaussian::new(math::ln(median), spread)?, median })
    }

    /// The value that half of all draws exceed.
    #[must_use]
    pub fn median(&self) -> f64 {
        self.median
    }
}

impl Density<f64> for LogNormal {
    /// # Errors
    /// [`NotANumber`] if `x` is NaN.
    fn log_density(&self, x: &f64) -> Result<LogDensity, NotANumber> {
        if *x <= 0.0 || *x == f64::INFINITY {
            return Ok(LogDensity::ZERO);
        }
        let log = math::ln(*x);
        LogDensity::new(self.log.log_density(&log)?.value() - log)
    }
}

impl Sample for LogNormal {
    type Value = f64;
    fn sample(&self, stream: &mut Stream) -> f64 {
        math::exp(self.log.sample(stream))
    }
}

as_number_law!(LogNormal {
    fn support(&self) -> [f64; 2] {
        [0.0, f64::INFINITY]
    }

    /// Half the distance between the quantiles a standard deviation below and above the median.
    fn width(&self) -> f64 {
        let factor = math::exp(self.log.sd());
        0.5 * self.median * (factor - 1.0 / factor)
    }
});

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{KS_LIMIT, draws, integrate, ks};

    #[test]
    fn draws_have_the_law_and_not_that_of_a_wider_one() {
        let law = LogNormal::new(3.0, 0.4).unwrap();
        let mass = integrate(1e-3, 60.0, |x| math::exp(law.log_density(&x).unwrap().value()));
        assert!((mass - 1.0).abs() < 1e-9, "{mass}");
        let cdf =
            |spread: f64| move |x: f64| 0.5 * math::erfc(-math::ln(x / 3.0) / spread * std::f64::consts::FRAC_1_SQRT_2);
        let drawn = draws(&law, 100_000, 12);
        assert!(ks(drawn.iter().copied(), cdf(0.4)) < KS_LIMIT);
        assert!(ks(drawn.into_iter(), cdf(0.43)) > KS_LIMIT);
    }

    #[test]
    fn bad_numbers_are_refused() {
        for (median, spread) in [(0.0, 1.0), (-1.0, 1.0), (1.0, 0.0), (1.0, f64::NAN), (f64::NAN, 1.0), (1.0, 11.0)] {
            assert!(LogNormal::new(median, spread).is_err());
        }
        let law = LogNormal::new(1.0, 10.0).unwrap();
        assert!(law.log_density(&f64::NAN).is_err() && law.log_density(&-0.0).unwrap().is_zero());
    }

    #[test]
    fn values_are_pinned() {
        assert_eq!(draws(&LogNormal::new(2.0, 0.1).unwrap(), 2, 1), [2.276_145_234_247_473, 2.053_129_524_152_981_2]);
    }
}

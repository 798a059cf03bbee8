//! The Gaussian restricted to an interval.

mod shape;

use crate::gaussian::standardised;
use crate::param::{LARGEST, ParamError};
use crate::{Density, LogDensity, NotANumber, Sample, Stream, math, open_unit, standard_normal};
use serde::{Deserialize, Serialize};
use shape::Shape;

const NAME: &str = "truncated normal law";

/// A Gaussian given that it fell into [low, high]; either end may be infinite.
///
/// Density `φ((x − mean)/sd) / (sd Z)` on the closed interval, with `Z = Φ((high − mean)/sd) − Φ((low − mean)/sd)`, per
/// unit of x; 0 outside. `Z` is part of it, so it stays right when mean, sd or bounds are random too (a restitution in
/// [0, 1], a friction above 0).
///
/// Both density and sampler stay accurate when the interval is far in a tail, where `Z` itself underflows: everything
/// is measured from the end nearest the mean. The log density is right to 1e-13 and a few roundings of its largest
/// term. (Far out the law may be narrower than the gap between floats: with mean 0, sd 1e-9 and low 1, say, all draws
/// are the bound itself and its neighbours.)
///
/// Source of the tail sampler: C. P. Robert, "Simulation of truncated normal variables", Statistics and Computing 5,
/// 1995. Deviation: his exponential proposal is itself truncated to the interval, so one rule serves wide and narrow
/// intervals; at least 3 of 4 proposals are accepted.
///
/// ```
/// use plaus_dist::{Density, Purpose, Sample, Seed, TruncatedGaussian};
/// let restitution = TruncatedGaussian::new(0.9, 0.2, 0.0, 1.0)?;
/// let drawn = restitution.sample(&mut Seed(1).chain(0).at(0, Purpose::START));
/// assert!((0.0..=1.0).contains(&drawn));
/// assert!(restitution.log_density(&1.1)?.is_zero());
///
/// // Forty standard deviations out: a mass of e^−804.6, of which no float but the logarithm can tell.
/// let tail = TruncatedGaussian::new(0.0, 1.0, 40.0, f64::INFINITY)?;
/// assert!((tail.log_mass() + 804.608).abs() < 1e-3);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Unchecked")]
pub struct TruncatedGaussian {
    mean: f64,
    sd: f64,
    low: f64,
    high: f64,
    #[serde(skip)]
    shape: Shape,
    /// Log density at the point of the interval nearest the mean.
    #[serde(skip)]
    log_peak: f64,
}

#[derive(Deserialize)]
#[serde(rename = "TruncatedGaussian", deny_unknown_fields)]
struct Unchecked {
    mean: f64,
    sd: f64,
    low: f64,
    high: f64,
}

impl TryFrom<Unchecked> for TruncatedGaussian {
    type Error = ParamError;
    fn try_from(raw: Unchecked) -> Result<Self, ParamError> {
        Self::new(raw.mean, raw.sd, raw.low, raw.high)
    }
}

impl TruncatedGaussian {
    /// `mean` and `sd` of the Gaussian before it is restricted to [`low`, `high`], all in the unit of x.
    ///
    /// # Errors
    /// [`ParamError`] unless |mean| ≤ 1e300, 1e-300 ≤ sd ≤ 1e300, low < high with finite ends within ±1e300; and unless
    /// the interval holds a mass whose logarithm is a float: its near end at most 1e154 sd from the mean, its width at
    /// least 1e-300 sd.
    pub fn new(mean: f64, sd: f64, low: f64, high: f64) -> Result<Self, ParamError> {
        ParamError::check_location(NAME, "mean", mean)?;
        ParamError::check_scale(NAME, "standard deviation", sd)?;
        let low_holds = low == f64::NEG_INFINITY || low.abs() <= LARGEST;
        ParamError::unless(low_holds, NAME, "low", low, "-inf, or from -1e300 to 1e300")?;
        let high_holds = high == f64::INFINITY || high.abs() <= LARGEST;
        ParamError::unless(high_holds, NAME, "high", high, "inf, or from -1e300 to 1e300")?;
        ParamError::unless(low < high, NAME, "high", high, "above low")?;

        let (below, above) = (standardised(low, mean, sd), standardised(high, mean, sd));
        let near = below.max(-above);
        ParamError::unless(
            near <= 1e154,
            NAME,
            "distance of the interval from the mean, in sd,",
            near,
            "at most 1e154",
        )?;
        let width = standardised(high, low, sd);
        ParamError::unless(width >= 1e-300, NAME, "width of the interval, in sd,", width, "at least 1e-300")?;

        let shape = Shape::new(below, above, width);
        Ok(Self { mean, sd, low, high, shape, log_peak: -math::ln(sd) - math::ln(shape.integral()) })
    }

    /// The mean before truncation.
    #[must_use]
    pub fn mean(&self) -> f64 {
        self.mean
    }

    /// The standard deviation before truncation.
    #[must_use]
    pub fn sd(&self) -> f64 {
        self.sd
    }

    /// The lower end, −∞ if there is none.
    #[must_use]
    pub fn low(&self) -> f64 {
        self.low
    }

    /// The upper end, +∞ if there is none.
    #[must_use]
    pub fn high(&self) -> f64 {
        self.high
    }

    /// ln Z: log of the probability, in nats, that the untruncated Gaussian falls into the interval.
    #[must_use]
    pub fn log_mass(&self) -> f64 {
        self.shape.log_mass()
    }
}

impl Density<f64> for TruncatedGaussian {
    /// # Errors
    /// [`NotANumber`] if `x` is NaN.
    fn log_density(&self, x: &f64) -> Result<LogDensity, NotANumber> {
        if *x < self.low || *x > self.high {
            return Ok(LogDensity::ZERO);
        }
        let drop = match self.shape {
            Shape::Around { .. } => 0.5 * math::square(standardised(*x, self.mean, self.sd)),
            // z² − near², over 2, without cancellation: t (near + t/2) for z = near + t.
            Shape::Above(tail) => tail.drop(standardised(*x, self.low, self.sd)),
            Shape::Below(tail) => tail.drop(standardised(self.high, *x, self.sd)),
        };
        LogDensity::new(self.log_peak - drop)
    }
}

impl Sample for TruncatedGaussian {
    type Value = f64;
    fn sample(&self, stream: &mut Stream) -> f64 {
        let x = match self.shape {
            Shape::Around { below, above, narrow: false, .. } => loop {
                let z = standard_normal(stream);
                if below <= z && z <= above {
                    break self.mean + self.sd * z;
                }
            },
            Shape::Around { .. } => loop {
                let x = self.low + (self.high - self.low) * open_unit(stream);
                let z = standardised(x, self.mean, self.sd);
                if open_unit(stream) < math::exp(-0.5 * math::square(z)) {
                    break x;
                }
            },
            Shape::Above(tail) => self.low + self.sd * tail.sample(stream),
            Shape::Below(tail) => self.high - self.sd * tail.sample(stream),
        };
        // Only a rounding can be outside.
        x.clamp(self.low, self.high)
    }
}

#[cfg(test)]
mod tests;

//! Quantities kept as logarithms: those that could be confused silently have types of their own.
//!
//! * [`LogDensity`]: log of a **normalised** density or probability. Terms whose dimension changes between states
//!   must be these.
//! * [`LogPotential`]: log of an **unnormalised** weight, such as a Gibbs factor. Only differences of it mean
//!   something.
//! * [`LogRatio`]: log of an acceptance or Hastings ratio.
//!
//! −∞ is a value of all three (probability 0). NaN never is: where it would arise, the error [`NotANumber`] is
//! returned, so that a broken model stops with a message instead of silently rejecting, or worse accepting, for ever.
//! +∞ is not a value of a density or a potential (an infinitely likely state could never be left), but a ratio may have
//! it.
//!
//! ```
//! use plaus_dist::{LogDensity, LogPotential};
//! let prior = LogDensity::new(-2.0)?;
//! let goal = LogPotential::new(5.0)?;
//! assert_eq!((prior + goal).value(), 3.0);
//! assert!(LogDensity::new(f64::NAN).is_err());
//! # Ok::<(), plaus_dist::NotANumber>(())
//! ```

use serde::{Deserialize, Serialize};
use std::iter::Sum;
use std::ops::Add;

/// A log quantity came out as NaN, or as +∞ although it cannot be: the model that made it is at fault.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[error("{quantity} is {value}: a log density must be finite or -inf")]
pub struct NotANumber {
    /// Which quantity, in words.
    pub quantity: &'static str,
    /// The offending value: NaN or +∞.
    pub value: f64,
}

#[inline]
fn checked(value: f64, quantity: &'static str) -> Result<f64, NotANumber> {
    if value < f64::INFINITY { Ok(value) } else { Err(NotANumber { quantity, value }) }
}

/// Both summands lie in [−∞, ∞), so the sum is never NaN; a sum past the largest float saturates there.
#[inline]
fn saturating(a: f64, b: f64) -> f64 {
    (a + b).min(f64::MAX)
}

/// Log of a normalised density or probability, in nats, in [−∞, ∞).
#[derive(Debug, Clone, Copy, PartialEq, PartialOrd, Serialize, Deserialize)]
#[serde(try_from = "f64")]
pub struct LogDensity(f64);

/// Stored values are checked like new ones.
impl TryFrom<f64> for LogDensity {
    type Error = NotANumber;
    fn try_from(nats: f64) -> Result<Self, NotANumber> {
        Self::new(nats)
    }
}

impl LogDensity {
    /// Certainty: the empty product, log 1.
    pub const ONE: Self = Self(0.0);
    /// Impossibility: log 0.
    pub const ZERO: Self = Self(f64::NEG_INFINITY);

    /// Wraps `nats`.
    ///
    /// # Errors
    /// [`NotANumber`] if `nats` is NaN or +∞.
    #[inline]
    pub fn new(nats: f64) -> Result<Self, NotANumber> {
        checked(nats, "log density").map(Self)
    }

    /// The value in nats.
    #[inline]
    #[must_use]
    pub fn value(self) -> f64 {
        self.0
    }

    /// Whether the density is 0.
    #[inline]
    #[must_use]
    pub fn is_zero(self) -> bool {
        self.0 == f64::NEG_INFINITY
    }
}

/// Product of independent densities.
impl Add for LogDensity {
    type Output = Self;
    #[inline]
    fn add(self, other: Self) -> Self {
        Self(saturating(self.0, other.0))
    }
}

/// Product of independent densities; the empty product is [`LogDensity::ONE`].
impl Sum for LogDensity {
    fn sum<I: Iterator<Item = Self>>(terms: I) -> Self {
        terms.fold(Self::ONE, Add::add)
    }
}

/// Log of an unnormalised weight, in nats, in [−∞, ∞).
#[derive(Debug, Clone, Copy, PartialEq, PartialOrd, Serialize, Deserialize)]
#[serde(try_from = "f64")]
pub struct LogPotential(f64);

/// Stored values are checked like new ones.
impl TryFrom<f64> for LogPotential {
    type Error = NotANumber;
    fn try_from(nats: f64) -> Result<Self, NotANumber> {
        Self::new(nats)
    }
}

impl LogPotential {
    /// No preference: weight 1.
    pub const ONE: Self = Self(0.0);
    /// Forbidden: weight 0.
    pub const ZERO: Self = Self(f64::NEG_INFINITY);

    /// Wraps `nats`.
    ///
    /// # Errors
    /// [`NotANumber`] if `nats` is NaN or +∞.
    #[inline]
    pub fn new(nats: f64) -> Result<Self, NotANumber> {
        checked(nats, "log potential").map(Self)
    }

    /// Wraps `nats` known to be finite from how it was computed.
    #[inline]
    pub(crate) fn finite(nats: f64) -> Self {
        debug_assert!(nats.is_finite(), "{nats}");
        Self(nats)
    }

    /// The value in nats.
    #[inline]
    #[must_use]
    pub fn value(self) -> f64 {
        self.0
    }

    /// Whether the weight is 0.
    #[inline]
    #[must_use]
    pub fn is_zero(self) -> bool {
        self.0 == f64::NEG_INFINITY
    }

    /// The same preference at inverse temperature `beta` ≥ 0: `beta · log weight`. A forbidden state stays forbidden at
    /// `beta` = 0.
    ///
    /// # Errors
    /// [`NotANumber`] if `beta` is NaN, negative against a forbidden state, or the product overflows upwards.
    pub fn tempered(self, beta: f64) -> Result<Self, NotANumber> {
        if self.is_zero() && beta >= 0.0 {
            return Ok(self);
        }
        checked(self.0 * beta, "tempered log potential").map(Self)
    }
}

/// Product of weights.
impl Add for LogPotential {
    type Output = Self;
    #[inline]
    fn add(self, other: Self) -> Self {
        Self(saturating(self.0, other.0))
    }
}

/// Product of weights; the empty product is [`LogPotential::ONE`].
impl Sum for LogPotential {
    fn sum<I: Iterator<Item = Self>>(terms: I) -> Self {
        terms.fold(Self::ONE, Add::add)
    }
}

/// A density times a weight is an unnormalised target.
impl Add<LogPotential> for LogDensity {
    type Output = LogPotential;
    #[inline]
    fn add(self, other: LogPotential) -> LogPotential {
        LogPotential(saturating(self.0, other.0))
    }
}

/// Log of a ratio of probabilities or densities, in nats, in [−∞, ∞].
#[derive(Debug, Clone, Copy, PartialEq, PartialOrd, Serialize, Deserialize)]
#[serde(try_from = "f64")]
pub struct LogRatio(f64);

/// Stored values are checked like new ones.
impl TryFrom<f64> for LogRatio {
    type Error = NotANumber;
    fn try_from(nats: f64) -> Result<Self, NotANumber> {
        Self::new(nats)
    }
}

impl LogRatio {
    /// The ratio 1: a symmetric proposal.
    pub const ONE: Self = Self(0.0);
    /// The ratio 0: a proposal that could never be undone, hence is never accepted.
    pub const ZERO: Self = Self(f64::NEG_INFINITY);

    /// Wraps `nats`.
    ///
    /// # Errors
    /// [`NotANumber`] if `nats` is NaN.
    #[inline]
    pub fn new(nats: f64) -> Result<Self, NotANumber> {
        if nats.is_nan() { Err(NotANumber { quantity: "log ratio", value: nats }) } else { Ok(Self(nats)) }
    }

    /// `numerator / denominator` of two densities.
    ///
    /// # Errors
    /// [`NotANumber`] if both are 0.
    #[inline]
    pub fn of(numerator: LogDensity, denominator: LogDensity) -> Result<Self, NotANumber> {
        Self::new(numerator.0 - denominator.0)
    }

    /// The value in nats.
    #[inline]
    #[must_use]
    pub fn value(self) -> f64 {
        self.0
    }

    /// Product of two ratios.
    ///
    /// # Errors
    /// [`NotANumber`] for 0 × ∞.
    #[inline]
    pub fn times(self, other: Self) -> Result<Self, NotANumber> {
        Self::new(self.0 + other.0)
    }

    /// The ratio of the opposite direction.
    #[inline]
    #[must_use]
    pub fn inverse(self) -> Self {
        Self(-self.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn minus_infinity_is_a_value_and_nan_an_error() {
        assert!(LogDensity::new(f64::NEG_INFINITY).unwrap().is_zero());
        assert!(LogDensity::new(f64::NAN).is_err());
        assert!(LogPotential::new(f64::INFINITY).is_err());
        assert!(LogRatio::new(f64::INFINITY).is_ok());
        assert!(LogRatio::of(LogDensity::ZERO, LogDensity::ZERO).is_err());
    }

    #[test]
    fn stored_values_are_checked_too() {
        type Stored = serde::de::value::F64Deserializer<serde::de::value::Error>;
        assert_eq!(LogDensity::deserialize(Stored::new(-2.5)).unwrap().value(), -2.5);
        assert!(LogDensity::deserialize(Stored::new(f64::NAN)).is_err());
        assert!(LogPotential::deserialize(Stored::new(f64::INFINITY)).is_err());
        assert!(LogRatio::deserialize(Stored::new(f64::NAN)).is_err());
    }

    #[test]
    fn sums_never_turn_nan() {
        assert_eq!(std::iter::empty::<LogDensity>().sum::<LogDensity>(), LogDensity::ONE);
        let huge = LogDensity::new(f64::MAX).unwrap();
        assert_eq!((huge + huge).value(), f64::MAX);
        assert!((huge + LogDensity::ZERO).is_zero());
        assert!(LogPotential::ZERO.tempered(0.0).unwrap().is_zero());
    }
}

//! A coin.

use crate::param::ParamError;
use crate::{Density, LogDensity, NotANumber, Sample, Stream, math, open_unit};
use serde::{Deserialize, Serialize};

/// `true` with probability p.
///
/// Mass p for `true` and 1 − p for `false`; dimensionless. Exact at both ends: p = 0 never draws `true` and gives it
/// log mass −∞, p = 1 the reverse. In between draws have the probability p rounded to a multiple of 2⁻⁵², so a p below
/// 2⁻⁵³ is never drawn.
///
/// ```
/// use plaus_dist::{Bernoulli, Density};
/// let active = Bernoulli::new(0.25)?;
/// assert!((active.log_density(&false)?.value() - (-0.287_682_072_451_780_9)).abs() < 1e-15); // ln ¾
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Unchecked")]
pub struct Bernoulli {
    probability: f64,
    #[serde(skip)]
    log_mass: [f64; 2],
}

#[derive(Deserialize)]
#[serde(rename = "Bernoulli", deny_unknown_fields)]
struct Unchecked {
    probability: f64,
}

impl TryFrom<Unchecked> for Bernoulli {
    type Error = ParamError;
    fn try_from(raw: Unchecked) -> Result<Self, ParamError> {
        Self::new(raw.probability)
    }
}

impl Bernoulli {
    /// `probability` of `true`.
    ///
    /// # Errors
    /// [`ParamError`] unless 0 ≤ probability ≤ 1.
    pub fn new(probability: f64) -> Result<Self, ParamError> {
        let holds = (0.0..=1.0).contains(&probability);
        ParamError::unless(holds, "Bernoulli law", "probability", probability, "from 0 to 1")?;
        Ok(Self { probability, log_mass: [math::ln_1p(-probability), math::ln(probability)] })
    }

    /// The probability of `true`.
    #[inline]
    #[must_use]
    pub fn probability(&self) -> f64 {
        self.probability
    }
}

impl Density<bool> for Bernoulli {
    /// # Errors
    /// None; the signature is the trait's.
    #[inline]
    fn log_density(&self, x: &bool) -> Result<LogDensity, NotANumber> {
        LogDensity::new(self.log_mass[usize::from(*x)])
    }
}

impl Sample for Bernoulli {
    type Value = bool;
    #[inline]
    fn sample(&self, stream: &mut Stream) -> bool {
        open_unit(stream) < self.probability
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{Z_LIMIT, draws, z_score};
    use proptest::prelude::*;

    #[test]
    fn the_ends_are_exact() {
        for (probability, certain) in [(0.0, false), (1.0, true)] {
            let coin = Bernoulli::new(probability).unwrap();
            assert_eq!(coin.log_density(&certain).unwrap(), LogDensity::ONE);
            assert!(coin.log_density(&!certain).unwrap().is_zero());
            assert!(draws(&coin, 10_000, 71).into_iter().all(|x| x == certain));
        }
        for wrong in [-1e-300, 1.0 + f64::EPSILON, f64::NAN, f64::INFINITY] {
            assert!(Bernoulli::new(wrong).is_err());
        }
    }

    #[test]
    fn frequencies_agree_and_a_coin_off_by_a_hundredth_does_not() {
        let misfit = |coin: f64, law: f64| {
            let tosses = draws(&Bernoulli::new(coin).unwrap(), 200_000, 72);
            z_score(tosses.into_iter().map(|x| f64::from(u8::from(x))), law, (law * (1.0 - law)).sqrt())
        };
        for p in [0.001, 0.25, 0.5, 0.96] {
            assert!(misfit(p, p).abs() < Z_LIMIT);
        }
        // 0.01 is nine standard errors √(0.25/200,000) = 0.0011 away.
        assert!(misfit(0.51, 0.5).abs() > Z_LIMIT);
    }

    proptest! {
        #[test]
        fn masses_sum_to_one(p in 0.0..=1.0_f64) {
            let coin = Bernoulli::new(p).unwrap();
            let sum: f64 = [true, false].iter().map(|x| math::exp(coin.log_density(x).unwrap().value())).sum();
            // ln and exp of two masses, one unit in the last place each.
            prop_assert!((sum - 1.0).abs() < 1e-15);
        }
    }
}

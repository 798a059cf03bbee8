//! The Gibbs factor λ^k, which turns a count of things achieved into a preference.

use crate::LogPotential;
use crate::math;
use crate::param::ParamError;
use serde::{Deserialize, Serialize};

const LARGEST_LN_LAMBDA: f64 = 700.0;

/// Weight `λ^k` of a state that achieves `k` things (Chenney & Forsyth 2000, sections 5.2 and 5.3: pins down, bins
/// filled).
///
/// Unnormalised, and only ever held as `k · ln λ` in nats: λ^k itself passes the largest float at k = 2 for λ = e^400.
/// λ = 1 prefers nothing; each thing achieved multiplies the odds by λ.
///
/// ```
/// use plaus_dist::Gibbs;
/// let goal = Gibbs::from_ln_lambda(2.5)?;
/// assert_eq!(goal.log_potential(10).value(), 25.0);
/// assert!(Gibbs::from_lambda(0.5).is_err());
/// # Ok::<(), plaus_dist::ParamError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Unchecked")]
pub struct Gibbs {
    ln_lambda: f64,
}

#[derive(Deserialize)]
#[serde(rename = "Gibbs", deny_unknown_fields)]
struct Unchecked {
    ln_lambda: f64,
}

impl TryFrom<Unchecked> for Gibbs {
    type Error = ParamError;
    fn try_from(raw: Unchecked) -> Result<Self, ParamError> {
        Self::from_ln_lambda(raw.ln_lambda)
    }
}

impl Gibbs {
    /// From λ itself.
    ///
    /// # Errors
    /// [`ParamError`] unless 1 ≤ λ ≤ e^700 (about 1.01e304).
    pub fn from_lambda(lambda: f64) -> Result<Self, ParamError> {
        let ln_lambda = math::ln(lambda);
        let holds = (0.0..=LARGEST_LN_LAMBDA).contains(&ln_lambda);
        ParamError::unless(holds, "Gibbs law", "lambda", lambda, "from 1 to e^700")?;
        Ok(Self { ln_lambda })
    }

    /// From ln λ, in nats for each thing achieved.
    ///
    /// # Errors
    /// [`ParamError`] unless 0 ≤ ln λ ≤ 700.
    pub fn from_ln_lambda(ln_lambda: f64) -> Result<Self, ParamError> {
        let holds = (0.0..=LARGEST_LN_LAMBDA).contains(&ln_lambda);
        ParamError::unless(holds, "Gibbs law", "ln_lambda", ln_lambda, "from 0 to 700")?;
        Ok(Self { ln_lambda })
    }

    /// ln λ in nats.
    #[inline]
    #[must_use]
    pub fn ln_lambda(&self) -> f64 {
        self.ln_lambda
    }

    /// `k · ln λ`: exact to one rounding for k up to 2⁵³, and finite for every k.
    #[inline]
    #[must_use]
    pub fn log_potential(&self, k: u64) -> LogPotential {
        LogPotential::finite(k as f64 * self.ln_lambda)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::stored;

    #[test]
    fn extremes_stay_finite() {
        for ln_lambda in [0.0, 5.0, 700.0] {
            let goal = Gibbs::from_ln_lambda(ln_lambda).unwrap();
            assert_eq!(goal.log_potential(0), LogPotential::ONE);
            assert_eq!(goal.log_potential(1_000_000).value(), 1e6 * ln_lambda);
            assert_eq!(goal.log_potential(1 << 40).value(), 1_099_511_627_776.0 * ln_lambda);
            assert!(goal.log_potential(u64::MAX).value().is_finite());
        }
    }

    #[test]
    fn both_constructors_agree() {
        for ln_lambda in [0.0, 2.5, 5.0, 699.0, 700.0] {
            let goal = Gibbs::from_lambda(math::exp(ln_lambda)).unwrap();
            // exp and ln round to a unit in the last place each.
            assert!((goal.ln_lambda() - ln_lambda).abs() < 1e-15 * (1.0 + ln_lambda));
        }
    }

    #[test]
    fn parameters_out_of_range_are_refused_also_from_storage() {
        for lambda in [0.0, -1.0, 0.999, 1e305, f64::INFINITY, f64::NAN] {
            assert!(Gibbs::from_lambda(lambda).is_err());
        }
        for ln_lambda in [-1e-9, 700.1, f64::INFINITY, f64::NAN] {
            assert!(Gibbs::from_ln_lambda(ln_lambda).is_err());
            assert!(Gibbs::deserialize(stored(&[("ln_lambda", ln_lambda)])).is_err());
        }
    }
}

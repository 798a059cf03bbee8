//! Monte Carlo standard errors.

use super::chains::{Chains, DiagnoseError, halves};
use super::ess::ess_of_rows;
use super::moments::{Standardised, mean_and_variance, sum};

/// Monte Carlo standard error of the mean: standard deviation / √[`ess_mean`](super::ess_mean()).
///
/// In the unit of the draws, ≥ 0; 0 if all draws are equal. The true mean lies within two of them in about 95 of 100
/// runs, provided the variance is finite and the chains have converged.
///
/// # Errors
/// [`DiagnoseError`] if the draws are not finite, too few or of unequal number.
pub fn mcse_mean<C: AsRef<[f64]>>(chains: &[C]) -> Result<f64, DiagnoseError> {
    let chains = Chains::new(chains)?;
    Ok(Standardised::new(chains.rows()).map_or(0.0, |standard| Moments::of(&standard).mcse_mean))
}

/// Monte Carlo standard error of the standard deviation.
///
/// The error of the mean of the squared deviations (with its own effective sample size), carried over to the root by
/// the delta method, as in ArviZ. In the unit of the draws, ≥ 0. Needs a finite fourth moment. 0 if all draws are
/// equal.
///
/// # Errors
/// [`DiagnoseError`] if the draws are not finite, too few or of unequal number.
pub fn mcse_sd<C: AsRef<[f64]>>(chains: &[C]) -> Result<f64, DiagnoseError> {
    let chains = Chains::new(chains)?;
    Ok(Standardised::new(chains.rows()).map_or(0.0, |standard| mcse_sd_of(&standard)))
}

/// Mean, spread and the mean's error, in the unit of the draws.
pub(super) struct Moments {
    pub(super) mean: f64,
    pub(super) sd: f64,
    pub(super) ess_mean: f64,
    pub(super) mcse_mean: f64,
}

impl Moments {
    pub(super) fn of(standard: &Standardised) -> Self {
        let (mean, variance) = mean_and_variance(standard.values());
        let ess_mean = ess_of_rows(&halves(&standard.rows()));
        Self {
            mean: standard.location(mean),
            sd: standard.difference(variance.sqrt()),
            ess_mean,
            mcse_mean: standard.difference((variance / ess_mean).sqrt()),
        }
    }
}

pub(super) fn mcse_sd_of(standard: &Standardised) -> f64 {
    let (centre, _) = mean_and_variance(standard.values());
    let mut squares: Vec<f64> = standard.values().iter().map(|y| (y - centre) * (y - centre)).collect();
    let ess = ess_of_rows(&halves(&super::chains::as_rows(&squares, standard.length())));
    let n = squares.len() as f64;
    let variance = sum(&squares) / n;
    squares.iter_mut().for_each(|square| *square *= *square);
    // Two values, equally often, have no spread of squares; rounding must not make it negative.
    let variance_of_squares = (sum(&squares) / n - variance * variance).max(0.0);
    standard.difference((variance_of_squares / ess / variance / 4.0).sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Errors scale with the draws, from the smallest normal floats to the largest.
    #[test]
    fn the_unit_does_not_matter() {
        let draws: Vec<f64> = (0..200).map(|i| f64::from((i * i * 31) % 173)).collect();
        let plain = (mcse_mean(&[&draws]), mcse_sd(&[&draws]));
        for scale in [1e-300, 1e-20, 1e20, 1e300] {
            let scaled: Vec<f64> = draws.iter().map(|x| x * scale).collect();
            for (found, plain) in [(mcse_mean(&[&scaled]), plain.0), (mcse_sd(&[&scaled]), plain.1)] {
                let (found, plain) = (found.unwrap_or(f64::NAN), plain.unwrap_or(f64::NAN));
                assert!((found / scale / plain - 1.0).abs() < 1e-12, "{scale:e}: {found:e} for {plain:e}");
            }
        }
    }

    #[test]
    fn constant_draws_have_no_error() {
        assert_eq!(mcse_mean(&[[0.1; 6]]), Ok(0.0));
        assert_eq!(mcse_sd(&[[0.1; 6]]), Ok(0.0));
        assert!(mcse_sd(&[[0.0, 1.0, 1.0, 0.0]]).is_ok_and(|error| error.abs() < 1e-7));
    }
}

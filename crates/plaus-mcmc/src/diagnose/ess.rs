//! Effective sample sizes.

use super::autocorrelation::{least_tau, mean_autocovariance};
use super::chains::{Chains, DiagnoseError, as_rows, halves};
use super::moments::{Standardised, all_constant, mean, mean_and_variance};
use super::rank::{normal_scores, quantile};

/// Effective sample size of the bulk: of the mean of the rank-normalised draws (Vehtari et al. 2021, section 4.1).
///
/// How many independent draws would locate the centre of the distribution as well as these do, over all chains
/// together. In (0, N·log₁₀ N] for N draws: above N where neighbours repel each other. Below 100 per chain neither it
/// nor [`rhat`](super::rhat()) is reliable. The number of draws where all are equal (the middle one of an odd number
/// per chain is not counted).
///
/// # Errors
/// [`DiagnoseError`] where the draws are not finite, too few or of unequal number.
pub fn ess_bulk<C: AsRef<[f64]>>(chains: &[C]) -> Result<f64, DiagnoseError> {
    let halves = Chains::new(chains)?.halves();
    Ok(ess_of_rows(&as_rows(&normal_scores(&halves), halves[0].len())))
}

/// Effective sample size of the tails: the smaller of those of the 5% and the 95% quantile (Vehtari et al. 2021,
/// section 4.3).
///
/// That of a quantile is the effective sample size of the share of draws not above it. Range and constant draws as for
/// [`ess_bulk`].
///
/// # Errors
/// [`DiagnoseError`] where the draws are not finite, too few or of unequal number.
pub fn ess_tail<C: AsRef<[f64]>>(chains: &[C]) -> Result<f64, DiagnoseError> {
    let chains = Chains::new(chains)?;
    let mut pool = chains.rows().concat();
    let ends = [quantile(&mut pool, 0.05), quantile(&mut pool, 0.95)];
    Ok(ess_of_ends(&chains.halves(), ends))
}

/// Effective sample size of the mean of the draws as they are: the one that belongs to
/// [`mcse_mean`](super::mcse_mean()).
///
/// Needs a finite variance; with heavy tails look at [`ess_bulk`]. Range and constant draws as there.
///
/// # Errors
/// [`DiagnoseError`] where the draws are not finite, too few or of unequal number.
pub fn ess_mean<C: AsRef<[f64]>>(chains: &[C]) -> Result<f64, DiagnoseError> {
    let chains = Chains::new(chains)?;
    let counted = chains.halves().len() * chains.halves()[0].len();
    Ok(Standardised::new(chains.rows()).map_or(counted as f64, |standard| ess_of_rows(&halves(&standard.rows()))))
}

/// The smaller effective sample size of the shares of draws at or below either end.
pub(super) fn ess_of_ends(halves: &[&[f64]], ends: [f64; 2]) -> f64 {
    let mut flags = Vec::new();
    let ess = ends.map(|end| {
        flags.clear();
        flags.extend(halves.iter().flat_map(|row| row.iter().map(|&x| if x <= end { 1.0 } else { 0.0 })));
        ess_of_rows(&as_rows(&flags, halves[0].len()))
    });
    ess[0].min(ess[1])
}

/// Number of draws divided by τ, the autocorrelation summed by Geyer's initial monotone sequence over all (half)
/// chains.
///
/// Correlations at lag t are 1 − (W − mean autocovariance) / var⁺, where W is the variance within and var⁺ that over
/// all rows (Vehtari et al., equation 10): rows that disagree leave correlations that never decay. Values of the order
/// of one; at least two per row.
pub(super) fn ess_of_rows(rows: &[&[f64]]) -> f64 {
    let length = rows[0].len();
    let draws = rows.len() * length;
    if all_constant(rows) {
        return draws as f64;
    }
    let means: Vec<f64> = rows.iter().map(|row| mean(row)).collect();
    let covariance = mean_autocovariance(rows, &means, length);
    let n = length as f64;
    let within = covariance[0] * n / (n - 1.0);
    let between = if rows.len() > 1 { mean_and_variance(&means).1 } else { 0.0 };
    let total = within * (n - 1.0) / n + between;
    let tau = geyer_tau(length, |lag| 1.0 - (within - covariance[lag]) / total);
    draws as f64 / tau.max(least_tau(draws))
}

/// τ = −1 + 2 Σ ρ_t: pairs ρ_2k + ρ_2k+1 are summed while they are positive and made to decrease; the first even term
/// behind them is added once if positive. Which terms count is ArviZ's rule (and Stan's), kept to the letter.
fn geyer_tau(length: usize, correlation: impl Fn(usize) -> f64) -> f64 {
    // ρ_0 is set to 1, not computed: the formula gives slightly less.
    let mut rho = vec![0.0; length];
    let (mut even, mut odd) = (1.0, correlation(1));
    (rho[0], rho[1]) = (even, odd);
    let mut lag = 1;
    while lag + 3 < length && even + odd > 0.0 {
        (even, odd) = (correlation(lag + 1), correlation(lag + 2));
        if even + odd >= 0.0 {
            (rho[lag + 1], rho[lag + 2]) = (even, odd);
        }
        lag += 2;
    }
    // The pairs before this lag are summed; it is 0 where there is not even one.
    let end = lag - 1;
    if even > 0.0 {
        rho[end] = even;
    }
    for lag in (1..end.saturating_sub(2)).step_by(2) {
        let before = rho[lag - 1] + rho[lag];
        if rho[lag + 1] + rho[lag + 2] > before {
            (rho[lag + 1], rho[lag + 2]) = (before / 2.0, before / 2.0);
        }
    }
    2.0 * rho[..end].iter().sum::<f64>() + rho[end] - 1.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn constant_draws_count_in_full() {
        let chains = [[0.1; 9], [0.1; 9]];
        assert_eq!(ess_bulk(&chains), Ok(16.0));
        assert_eq!(ess_tail(&chains), Ok(16.0));
        assert_eq!(ess_mean(&chains), Ok(16.0));
    }

    #[test]
    fn stuck_chains_are_worth_next_to_nothing() {
        let chains = [vec![0.1; 100], vec![0.7; 100], vec![0.3; 100], vec![0.4; 100]];
        assert!(ess_bulk(&chains).is_ok_and(|ess| ess < 8.0));
        assert!(ess_mean(&chains).is_ok_and(|ess| ess < 8.0));
    }

    #[test]
    fn heavy_tails_do_not_hide_behind_their_variance() {
        // One draw a million times the rest makes the plain correlations vanish; ranks see that the chain hardly moves.
        let mut chain: Vec<f64> = (0..1000).map(|i| f64::from(i / 100)).collect();
        chain[371] = 1e9;
        assert!(ess_mean(&[&chain]).is_ok_and(|ess| ess > 500.0));
        assert!(ess_bulk(&[&chain]).is_ok_and(|ess| ess < 20.0));
    }
}

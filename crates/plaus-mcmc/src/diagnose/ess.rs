//! Effective sample sizes.

use super::autocorrelation::{least_tau, mean_autocovariance};
use super::chains::{Chains, DiagnoseError, as_rows, halves};
use super::moments::{Standardised, all_constant, mean, mean_and_variance};
use super::rank::{normal_scores, quantile};

/// Effective sample size of the bulk: of the mean of the rank-normalised draws (Vehtari et al. 2021, section 4.1).
///
/// The number of independent draws that would locate the centre of the distribution as well as all chains together do.
/// It lies in (0, N·log₁₀ N] for N draws: above N if neighbours are anticorrelated. Below 100 per chain neither it nor
/// [`rhat`](super::rhat()) is reliable. If all draws are equal, it is their number (the middle one of an odd number per
/// chain is not counted).
///
/// # Errors
/// [`DiagnoseError`] if the draws are not finite, too few or of unequal number.
pub fn ess_bulk<C: AsRef<[f64]>>(chains: &[C]) -> Result<f64, DiagnoseError> {
    let halves = Chains::new(chains)?.halves();
    Ok(ess_of_rows(&as_rows(&normal_scores(&halves), halves[0].len())))
}

/// Effective sample size of the tails: the smaller of those of the 5% and the 95% quantile (Vehtari et al. 2021,
/// section 4.3).
///
/// For a quantile, it is the effective sample size of the share of draws not above it. Range and constant draws as for
/// [`ess_bulk`].
///
/// # Errors
/// [`DiagnoseError`] if the draws are not finite, too few or of unequal number.
pub fn ess_tail<C: AsRef<[f64]>>(chains: &[C]) -> Result<f64, DiagnoseError> {
    let chains = Chains::new(chains)?;
    let mut pool = chains.rows().concat();
    let ends = [quantile(&mut pool, 0.05), quantile(&mut pool, 0.95)];
    Ok(ess_of_ends(&chains.halves(), ends))
}

/// Effective sample size of the mean of the draws themselves: the one that belongs to
/// [`mcse_mean`](super::mcse_mean()).
///
/// Needs a finite variance; with heavy tails look at [`ess_bulk`]. Range and constant draws as there.
///
/// # Errors
/// [`DiagnoseError`] if the draws are not finite, too few or of unequal number.
pub fn ess_mean<C: AsRef<[f64]>>(chains: &[C]) -> Result<f64, DiagnoseError> {
    let chains = Chains::new(chains)?;
    let counted = chains.halves().len() * chains.halves()[0].len();
    Ok(Standardised::new(chains.rows()).map_or(counted as f64, |standard| ess_of_rows(&halves(&standard.rows()))))
}

/// Effective sample size of the draws that are `kept`: how many independent draws would locate the centre of their
/// distribution as well. For independent draws it is about the number kept.
///
/// The mean over the kept draws is a ratio of two means over all draws. Its error is that of a series that is 0 for
/// draws not kept, and for the others their rank score among the kept ones. So it matters how often a chain returns to
/// kept draws, and from where, not how long it stays there. `None` if fewer than two draws are kept, or all kept draws
/// are equal.
///
/// # Errors
/// [`DiagnoseError`] if kept draws are not finite, or there are too few draws, or of unequal number.
pub fn ess_where<C: AsRef<[f64]>, K: AsRef<[bool]>>(chains: &[C], kept: &[K]) -> Result<Option<f64>, DiagnoseError> {
    let is_kept = || kept.iter().flat_map(|kept| kept.as_ref().iter().copied());
    let values = chains.iter().flat_map(|chain| chain.as_ref().iter().copied()).zip(is_kept());
    let values: Vec<f64> = values.filter_map(|(value, kept)| kept.then_some(value)).collect();
    if values.len() < 2 || values.iter().all(|value| *value == values[0]) {
        return Ok(None);
    }
    let score = if values.iter().all(|value| value.is_finite()) { normal_scores(&[&values]) } else { values };
    let mut scores = score.into_iter();
    let mut series = Vec::with_capacity(chains.len());
    for (chain, kept) in chains.iter().zip(kept) {
        let place = |&kept: &bool| if kept { scores.next().unwrap_or(0.0) } else { 0.0 };
        let row: Vec<f64> = kept.as_ref().iter().map(place).collect();
        debug_assert_eq!(row.len(), chain.as_ref().len());
        series.push(row);
    }
    let halves = Chains::new(&series)?.halves();
    let (all, count) = (is_kept().count() as f64, is_kept().filter(|&kept| kept).count() as f64);
    Ok(Some(ess_of_rows(&halves) * count / all))
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

    /// A fixed scramble: a stand-in for independent draws.
    fn scrambled(count: u64, key: u64) -> Vec<f64> {
        let one = |i: u64| {
            let mut z = i.wrapping_add(key << 32).wrapping_mul(0x9e37_79b9_7f4a_7c15);
            z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
            z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
            (z >> 11) as f64 / (1_u64 << 53) as f64
        };
        (0..count).map(one).collect()
    }

    #[test]
    fn kept_draws_count_as_often_as_they_are_new() {
        let kept_of = |rows: &[Vec<f64>]| -> Vec<Vec<bool>> {
            rows.iter().map(|row| row.iter().map(|&x| x < 0.04).collect()).collect()
        };
        let count = |kept: &[Vec<bool>]| kept.iter().flatten().filter(|&&kept| kept).count() as f64;
        // Independent draws: as many as are kept, within three times the error of an ESS from this many rows, about 5
        // %.
        let rows = [scrambled(20_000, 1), scrambled(20_000, 2)];
        let kept = kept_of(&rows);
        let ess = ess_where(&rows, &kept).unwrap().unwrap();
        assert!((ess / count(&kept) - 1.0).abs() < 0.15, "{ess} of {}", count(&kept));
        // The same draw ten times in a row counts as one draw; ten times as many are kept.
        let slow = rows.map(|row| row[..2000].iter().flat_map(|&x| [x; 10]).collect::<Vec<f64>>());
        let kept = kept_of(&slow);
        let ess = ess_where(&slow, &kept).unwrap().unwrap();
        assert!((ess / (count(&kept) / 10.0) - 1.0).abs() < 0.3, "{ess} of {}", count(&kept));
        // Draws that are not kept may have any value.
        let mut odd = slow.clone();
        odd[0].iter_mut().zip(&kept[0]).filter(|(_, kept)| !**kept).for_each(|(x, _)| *x = f64::NAN);
        assert_eq!(ess_where(&odd, &kept).unwrap(), Some(ess));
        assert!(ess_where(&odd, &[vec![true; 20_000], vec![true; 20_000]]).is_err());
        assert_eq!(ess_where(&slow, &[vec![false; 20_000], vec![false; 20_000]]), Ok(None));
        // A chain that found one solution and stayed there has one draw.
        let stuck = [vec![0.01; 1000], scrambled(1000, 3).iter().map(|x| 0.5 + 0.5 * x).collect()];
        assert_eq!(ess_where(&stuck, &kept_of(&stuck)), Ok(None));
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

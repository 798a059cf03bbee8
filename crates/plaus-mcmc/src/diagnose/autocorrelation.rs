//! Autocovariance by Fourier transform, and the integrated autocorrelation time.

use super::chains::{Chains, DiagnoseError};
use super::moments::{Standardised, mean};
use plaus_dist::math;
use realfft::{ComplexToReal, RealFftPlanner, RealToComplex};
use serde::{Deserialize, Serialize};
use std::cell::RefCell;
use std::sync::Arc;

/// Sokal's constant c: the sum over lags stops at the first lag M ≥ c·τ(M).
///
/// With exponentially decaying correlations, the sum then misses a fraction e⁻⁵ ≈ 0.7% of τ, and its variance is about
/// (2M + 1) 2τ²/N. Sokal advises 4 to 6 for one exponential, up to 10 for several; emcee also uses 5.
pub const SOKAL_WINDOW: f64 = 5.0;

/// Iterations that an independent draw costs.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct AutocorrelationTime {
    /// τ = 1 + 2 Σ ρ_t, in iterations: 1 for independent draws, below 1 if neighbours are anticorrelated.
    ///
    /// The variance of the mean of N draws is their variance times τ/N, so N/τ is an effective sample size of the mean.
    /// [`ess_mean`](super::ess_mean) estimates the same quantity by Geyer's rule instead of Sokal's: τ ≈ N /
    /// `ess_mean`, to within the noise of either.
    pub tau: f64,
    /// The last lag summed.
    pub window: usize,
    /// Whether the window closed and the chain is at least 50 τ long (emcee's rule of thumb); otherwise τ is likely to
    /// be too low.
    pub settled: bool,
}

/// Correlation of the draws of one chain with those 0, 1, 2, …, `max_lag` iterations later.
///
/// Starts with 1; the normalisation is 1/n at every lag, so far lags shrink towards 0. Lags stop at the last one the
/// chain has. `None` if all draws are equal.
///
/// # Errors
/// [`DiagnoseError`] if the draws are not finite or too few.
pub fn autocorrelation(chain: &[f64], max_lag: usize) -> Result<Option<Vec<f64>>, DiagnoseError> {
    let draws = [chain];
    let chains = Chains::new(&draws)?;
    Ok(Standardised::new(chains.rows()).map(|standard| {
        let rows = standard.rows();
        let lags = max_lag.saturating_add(1).min(standard.length());
        correlation_about(&rows, mean(standard.values()), lags)
    }))
}

/// Integrated autocorrelation time over all chains, by Sokal's automatic window with c = [`SOKAL_WINDOW`].
///
/// Correlations are taken about the mean of **all** chains: chains that disagree never decorrelate, and τ approaches
/// their length. For one chain with positive correlations the value is that of `emcee.autocorr.integrated_time`.
///
/// Deviation: if neighbours are anticorrelated (ρ₁ < 0), Sokal's rule would stop at once with a negative τ. In that
/// case the window is chosen on (−1)ᵗ ρ_t, which are the correlations of the chain with every other deviation negated;
/// τ itself is still the sum of ρ_t. It is kept above 1/log₁₀ N, ArviZ's bound on τ.
///
/// `None` if all draws are equal.
///
/// # Errors
/// [`DiagnoseError`] if the draws are not finite, too few or of unequal number.
pub fn integrated_autocorrelation_time<C: AsRef<[f64]>>(
    chains: &[C],
) -> Result<Option<AutocorrelationTime>, DiagnoseError> {
    let chains = Chains::new(chains)?;
    Ok(Standardised::new(chains.rows()).map(|standard| time_of(&standard)))
}

pub(super) fn time_of(standard: &Standardised) -> AutocorrelationTime {
    let rho = correlation_about(&standard.rows(), mean(standard.values()), standard.length());
    let (window, closed) = sokal_window(&rho);
    let summed = 2.0 * rho[..=window].iter().sum::<f64>() - 1.0;
    let tau = summed.max(least_tau(standard.values().len()));
    AutocorrelationTime { tau, window, settled: closed && 50.0 * tau <= standard.length() as f64 }
}

/// ArviZ's lower bound on τ over `draws` draws: estimates below it are noise.
pub(super) fn least_tau(draws: usize) -> f64 {
    1.0 / math::log10(draws as f64)
}

/// First lag M ≥ c·τ(M) and whether there is one; else the last lag.
fn sokal_window(rho: &[f64]) -> (usize, bool) {
    let step = if rho[1] < 0.0 { -1.0 } else { 1.0 };
    let mut sign = 1.0;
    let mut tau = -1.0;
    for (lag, correlation) in rho.iter().enumerate() {
        tau += 2.0 * sign * correlation;
        sign *= step;
        if lag as f64 >= SOKAL_WINDOW * tau {
            return (lag, true);
        }
    }
    (rho.len() - 1, false)
}

fn correlation_about(rows: &[&[f64]], centre: f64, lags: usize) -> Vec<f64> {
    let covariance = mean_autocovariance(rows, &vec![centre; rows.len()], lags);
    covariance.iter().map(|c| c / covariance[0]).collect()
}

/// Autocovariance at lags 0 .. `lags`, each row about its centre and divided by its length n (not n − t), averaged over
/// the rows.
///
/// The spectra of the rows are added before the one transform back, so memory is that of one row.
pub(super) fn mean_autocovariance(rows: &[&[f64]], centres: &[f64], lags: usize) -> Vec<f64> {
    const SAME_PLAN: &str = "buffers made by the plan fit it";
    let length = rows[0].len();
    // With this many zeros behind the draws, no lag wraps around onto another.
    let size = fast_size(length + lags);
    let Plans { forward, inverse, .. } = plans(size);
    let mut signal = forward.make_input_vec();
    let mut spectrum = forward.make_output_vec();
    let mut scratch = forward.make_scratch_vec();
    let mut power = vec![0.0; spectrum.len()];
    for (row, centre) in rows.iter().zip(centres) {
        signal.fill(0.0);
        for (slot, x) in signal.iter_mut().zip(*row) {
            *slot = x - centre;
        }
        forward.process_with_scratch(&mut signal, &mut spectrum, &mut scratch).expect(SAME_PLAN);
        for (sum, line) in power.iter_mut().zip(&spectrum) {
            *sum += line.norm_sqr();
        }
    }
    for (line, power) in spectrum.iter_mut().zip(power) {
        (line.re, line.im) = (power, 0.0);
    }
    inverse.process(&mut spectrum, &mut signal).expect(SAME_PLAN);
    let scale = 1.0 / (size as f64 * length as f64 * rows.len() as f64);
    signal.truncate(lags);
    signal.iter_mut().for_each(|x| *x *= scale);
    signal
}

/// The transforms of one size.
#[derive(Clone)]
struct Plans {
    size: usize,
    forward: Arc<dyn RealToComplex<f64>>,
    inverse: Arc<dyn ComplexToReal<f64>>,
}

/// The transforms of this size. Each thread keeps those of the last size: to make them takes as long as to use them a
/// few times, and the variables of a run have equally many draws.
fn plans(size: usize) -> Plans {
    thread_local! {
        static LAST: RefCell<Option<Plans>> = const { RefCell::new(None) };
    }
    LAST.with_borrow_mut(|last| {
        if let Some(plans) = last.as_ref().filter(|plans| plans.size == size) {
            return plans.clone();
        }
        let mut planner = RealFftPlanner::new();
        let (forward, inverse) = (planner.plan_fft_forward(size), planner.plan_fft_inverse(size));
        last.insert(Plans { size, forward, inverse }).clone()
    })
}

/// Smallest 2ᵃ·3ᵇ, a ≥ 1, that is at least `least`: sizes whose transform is fast.
fn fast_size(least: usize) -> usize {
    let mut best = least.next_power_of_two().max(2);
    let mut threes = 1;
    while threes < best {
        let mut size = 2 * threes;
        while size < least {
            size *= 2;
        }
        best = best.min(size);
        threes *= 3;
    }
    best
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The definition, term by term.
    fn slow_autocovariance(row: &[f64], centre: f64, lag: usize) -> f64 {
        let pairs = row.iter().zip(&row[lag..]);
        pairs.map(|(x, y)| (x - centre) * (y - centre)).sum::<f64>() / row.len() as f64
    }

    #[test]
    fn the_transform_computes_the_definition() {
        for length in [2_usize, 3, 4, 7, 64, 100, 257] {
            let rows: [Vec<f64>; 3] =
                std::array::from_fn(|c| (0..length).map(|i| ((i * i * (c + 3)) % 17) as f64).collect());
            let rows = rows.each_ref().map(Vec::as_slice);
            let centres = [1.0, 8.0, 5.5];
            let fast = mean_autocovariance(&rows, &centres, length);
            for (lag, &fast) in fast.iter().enumerate() {
                let slow = rows.iter().zip(centres).map(|(row, centre)| slow_autocovariance(row, centre, lag));
                let slow = slow.sum::<f64>() / 3.0;
                assert!((fast - slow).abs() < 1e-12, "length {length} lag {lag}: {fast} for {slow}");
            }
        }
    }

    #[test]
    fn fast_sizes_are_tight() {
        for (least, size) in [(1, 2), (2, 2), (5, 6), (100, 108), (500, 512), (129, 144), (1_000_000, 1_048_576)] {
            let found = fast_size(least);
            assert!(found >= least && found <= size && found.is_multiple_of(2), "{least}: {found}");
        }
    }

    #[test]
    fn lags_end_with_the_chain() {
        let lengths = [0, 3, usize::MAX].map(|lag| autocorrelation(&[1.0, 2.0, 4.0, 3.0, 5.0], lag));
        let lengths = lengths.map(|found| found.ok().flatten().map(|rho| (rho[0], rho.len())));
        assert_eq!(lengths, [Some((1.0, 1)), Some((1.0, 4)), Some((1.0, 5))]);
        assert_eq!(autocorrelation(&[2.0; 9], 3), Ok(None));
        assert_eq!(integrated_autocorrelation_time(&[[2.0; 9]]), Ok(None));
    }

    #[test]
    fn chains_that_disagree_never_settle() {
        let low: Vec<f64> = (0..1000).map(|i| f64::from((i * 379) % 100)).collect();
        let high: Vec<f64> = low.iter().map(|x| x + 1000.0).collect();
        let alone = integrated_autocorrelation_time(&[&low]).ok().flatten();
        let both = integrated_autocorrelation_time(&[&low, &high]).ok().flatten();
        assert!(alone.is_some_and(|t| t.tau < 5.0), "{alone:?}");
        assert!(both.is_some_and(|t| t.tau > 100.0 && !t.settled), "{both:?}");
    }
}

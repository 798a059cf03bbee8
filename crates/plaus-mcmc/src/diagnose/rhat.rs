//! R̂: do the chains agree?

use super::chains::{Chains, DiagnoseError, as_rows};
use super::moments::{mean_and_variance, unordered_mean_and_variance};
use super::rank::{folded_scores, normal_scores};

/// Rank-normalised split R̂, the larger of the plain and the folded one (Vehtari et al. 2021, equations 3 to 5 and
/// section 4).
///
/// About 1 if all chains, and both halves of each, sample the same law; the authors advise to trust draws below 1.01.
/// By chance it may be slightly below 1. The plain part compares locations, the folded part (distances from the common
/// median) compares spreads.
///
/// `None` for a single chain, because there is nothing to compare, and if all draws are equal. `Some(f64::INFINITY)` if
/// every half chain is constant and they differ.
///
/// # Errors
/// [`DiagnoseError`] if the draws are not finite, too few or of unequal number.
pub fn rhat<C: AsRef<[f64]>>(chains: &[C]) -> Result<Option<f64>, DiagnoseError> {
    let chains = Chains::new(chains)?;
    let halves = chains.halves();
    Ok(rank_rhat(&chains, &halves, &normal_scores(&halves)))
}

/// R̂, if the scores of the half chains are already known.
pub(super) fn rank_rhat(chains: &Chains<'_>, halves: &[&[f64]], scores: &[f64]) -> Option<f64> {
    if chains.chain_count() < 2 {
        return None;
    }
    let length = halves[0].len();
    let plain = scale_reduction(&as_rows(scores, length))?;
    // Distances without variance (two values, equally often) say nothing about the spread: then only the plain part
    // counts.
    let folded = scale_reduction(&as_rows(&folded_scores(halves), length));
    Some(folded.map_or(plain, |folded| plain.max(folded)))
}

/// Potential scale reduction of Gelman & Rubin 1992 over rows of at least two values: √((B/W + n − 1) / n).
fn scale_reduction(rows: &[&[f64]]) -> Option<f64> {
    let length = rows[0].len() as f64;
    let (means, variances): (Vec<f64>, Vec<f64>) = rows.iter().map(|row| mean_and_variance(row)).unzip();
    let (within, _) = unordered_mean_and_variance(&variances);
    let (_, between) = unordered_mean_and_variance(&means);
    let ratio = length * between / within;
    (!ratio.is_nan()).then(|| ((ratio + length - 1.0) / length).sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ramp(from: f64, draws: usize) -> Vec<f64> {
        (0..draws).map(|i| from + ((i * 7919) % draws) as f64).collect()
    }

    #[test]
    fn each_half_is_compared_with_the_others() {
        let agreeing = rhat(&[ramp(0.0, 500), ramp(0.0, 500)]);
        assert!(matches!(agreeing, Ok(Some(r)) if r < 1.01), "{agreeing:?}");
        let drifting: Vec<f64> = ramp(0.0, 500).iter().enumerate().map(|(i, x)| x + i as f64).collect();
        let drifting = rhat(&[drifting.clone(), drifting]);
        assert!(matches!(drifting, Ok(Some(r)) if r > 1.2), "{drifting:?}");
    }

    #[test]
    fn a_wider_chain_is_seen_by_folding() {
        let narrow: Vec<f64> = ramp(-250.0, 501).iter().map(|x| 0.2 * x).collect();
        let found = rhat(&[ramp(-250.0, 501), narrow]);
        assert!(matches!(found, Ok(Some(r)) if r > 1.2), "{found:?}");
    }

    #[test]
    fn draws_without_variance_have_documented_values() {
        assert_eq!(rhat(&[vec![0.1; 50], vec![0.1; 50]]), Ok(None));
        assert_eq!(rhat(&[ramp(0.0, 50)]), Ok(None));
        assert_eq!(rhat(&[vec![0.1; 50], vec![0.3; 50]]), Ok(Some(f64::INFINITY)));
        let coin = [0.0, 1.0, 1.0, 0.0, 0.0, 1.0, 1.0, 0.0];
        assert!(matches!(rhat(&[coin, coin]), Ok(Some(r)) if r.is_finite()));
    }
}

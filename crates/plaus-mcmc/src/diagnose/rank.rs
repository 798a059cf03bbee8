//! Ranks instead of values: they make the diagnostics valid for heavy tails and under any monotone transformation.

use super::moments::extremes;
use plaus_dist::normal_quantile;

/// Replaces every draw by the normal quantile of its rank among all draws (Vehtari et al., section 4.1), row after row
/// in one table.
///
/// Equal draws share the mean of their ranks. The rank r of S draws becomes the quantile at (r − 3/8) / (S + 1/4),
/// Blom's offset. It is taken from the nearer end, so that the scores of the negated draws are exactly the negated
/// scores.
pub(super) fn normal_scores(rows: &[&[f64]]) -> Vec<f64> {
    scores_of(rows.iter().flat_map(|row| row.iter().copied()).collect())
}

/// Scores of the distances from the median: they see chains that agree in location and differ in spread.
///
/// The distances are rounded as in ArviZ, so that the same ones are equal.
pub(super) fn folded_scores(rows: &[&[f64]]) -> Vec<f64> {
    let (low, high) = extremes(rows);
    // Neither a distance nor the sum of the two middle draws may overflow.
    let shrink = if high.max(-low) < 0.25 * f64::MAX { 1.0 } else { 0.25 };
    let mut table: Vec<f64> = rows.iter().flat_map(|row| row.iter().map(|x| x * shrink)).collect();
    let centre = median(&mut table.clone());
    for x in &mut table {
        *x = (*x - centre).abs();
    }
    scores_of(table)
}

fn scores_of(table: Vec<f64>) -> Vec<f64> {
    let mut ordered: Vec<(f64, usize)> = table.iter().copied().zip(0..).collect();
    ordered.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
    let mut scores = table;
    let total = scores.len() as f64;
    let mut below = 0;
    for ties in ordered.chunk_by(|a, b| a.0 == b.0) {
        // The mean of below + 1 ..= below + ties.len(): a whole number or half of one, exact.
        let rank = below as f64 + 0.5 * (ties.len() as f64 + 1.0);
        let score = score(rank, total);
        for &(_, place) in ties {
            scores[place] = score;
        }
        below += ties.len();
    }
    scores
}

fn score(rank: f64, total: f64) -> f64 {
    let from_end = total + 1.0 - rank;
    let lower = normal_quantile((rank.min(from_end) - 0.375) / (total + 0.25));
    if from_end < rank { -lower } else { lower }
}

/// Middle draw, or the mean of the two middle ones; reorders `values`.
fn median(values: &mut [f64]) -> f64 {
    let half = values.len() / 2;
    let odd = values.len() % 2 == 1;
    let (below, &mut upper, _) = values.select_nth_unstable_by(half, f64::total_cmp);
    if odd { upper } else { (largest(below) + upper) / 2.0 }
}

fn largest(values: &[f64]) -> f64 {
    values.iter().copied().fold(f64::NEG_INFINITY, f64::max)
}

/// The quantile at `probability` by linear interpolation between order statistics (type 7 of Hyndman & Fan 1996, the
/// usual default); reorders `values`, of which there are at least two.
///
/// The sequence of roundings is that of `scipy.stats.mstats.mquantiles`, which ArviZ calls. Each draw counts as either
/// below the quantile or not, so if many draws are equal, the last bit matters.
pub(super) fn quantile(values: &mut [f64], probability: f64) -> f64 {
    let last = values.len() - 1;
    let place = values.len() as f64 * probability + (1.0 - probability);
    let whole = place.clamp(1.0, last as f64).floor();
    let share = (place - whole).clamp(0.0, 1.0);
    let index = whole as usize;
    let (below, &mut upper, _) = values.select_nth_unstable_by(index, f64::total_cmp);
    let lower = largest(below);
    (1.0 - share) * lower + share * upper
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ties_share_their_mean_rank() {
        let scores = normal_scores(&[&[5.0, -0.0, 5.0], &[7.0, 0.0, 5.0]]);
        let of = |rank: f64| normal_quantile((rank - 0.375) / 6.25);
        let expected = [of(4.0), of(1.5), of(4.0), of(6.0), of(1.5), of(4.0)];
        for (found, exact) in scores.iter().zip(expected) {
            assert!((found - exact).abs() < 1e-15, "{scores:?}");
        }
    }

    #[test]
    fn scores_of_the_mirror_image_are_mirrored_exactly() {
        let draws: Vec<f64> = (0..37).map(|i| f64::from((i * 11) % 23)).collect();
        let mirrored: Vec<f64> = draws.iter().map(|x| -x).collect();
        let negated: Vec<f64> = normal_scores(&[&mirrored]).iter().map(|z| -z).collect();
        assert_eq!(normal_scores(&[&draws]), negated);
    }

    #[test]
    fn folding_survives_the_largest_floats() {
        let large = f64::MAX;
        let scores = folded_scores(&[&[-large, large, 0.5 * large, -0.5 * large]]);
        assert_eq!(scores[0], scores[1]);
        assert_eq!(scores[2], scores[3]);
        assert!(scores[0] > scores[2]);
    }

    #[test]
    fn quantiles_interpolate() {
        let mut values = [4.0, 1.0, 3.0, 2.0, 5.0];
        assert_eq!(quantile(&mut values, 0.5), 3.0);
        assert_eq!(quantile(&mut values, 0.0), 1.0);
        assert_eq!(quantile(&mut values, 1.0), 5.0);
        assert!((quantile(&mut values, 0.05) - 1.2).abs() < 1e-15);
        assert_eq!(median(&mut [4.0, 1.0, 3.0, 2.0]), 2.5);
        assert_eq!(median(&mut [4.0, 1.0, 3.0]), 3.0);
    }
}

//! Sums, means and variances that neither drift with the number of draws nor depend on their unit.

/// Sum by halving: the rounding error grows with log n, not n.
pub(super) fn sum(values: &[f64]) -> f64 {
    if values.len() <= 128 {
        return values.iter().sum();
    }
    let (left, right) = values.split_at(values.len() / 2);
    sum(left) + sum(right)
}

/// Mean, and variance over n − 1, of at least two values: the same to the last bit in any order; the variance also for
/// the negated values.
pub(super) fn unordered_mean_and_variance(values: &[f64]) -> (f64, f64) {
    let centre = if is_constant(values) { values[0] } else { unordered_sum(values) / values.len() as f64 };
    let squares: Vec<f64> = values.iter().map(|x| (x - centre) * (x - centre)).collect();
    (centre, unordered_sum(&squares) / (values.len() as f64 - 1.0))
}

/// The values above 0 and those below, each from the smallest on.
fn unordered_sum(values: &[f64]) -> f64 {
    let side = |sign: f64| {
        let mut side: Vec<f64> = values.iter().map(|x| sign * x).filter(|x| *x > 0.0).collect();
        side.sort_unstable_by(f64::total_cmp);
        sum(&side)
    };
    side(1.0) - side(-1.0)
}

/// Whether all values are equal.
pub(super) fn is_constant(values: &[f64]) -> bool {
    values.iter().all(|&x| x == values[0])
}

/// Whether all values of all rows are equal.
pub(super) fn all_constant(rows: &[&[f64]]) -> bool {
    rows.iter().all(|row| row[0] == rows[0][0] && is_constant(row))
}

/// Mean of at least one value; exact if all are equal.
pub(super) fn mean(values: &[f64]) -> f64 {
    if is_constant(values) { values[0] } else { sum(values) / values.len() as f64 }
}

/// Mean, and variance over n − 1, of at least two values; exactly 0 if all are equal.
pub(super) fn mean_and_variance(values: &[f64]) -> (f64, f64) {
    let centre = mean(values);
    let squares: Vec<f64> = values.iter().map(|x| (x - centre) * (x - centre)).collect();
    (centre, sum(&squares) / (values.len() as f64 - 1.0))
}

/// Draws converted to a unit of their own: `x = (origin + span · y) / shrink`, with every |y| ≤ 1.
///
/// Squares and fourth powers of y can neither overflow nor all vanish, whatever the unit of x.
pub(super) struct Standardised {
    table: Vec<f64>,
    length: usize,
    origin: f64,
    span: f64,
    /// 1, or 1/4 if the draws' span itself would overflow.
    shrink: f64,
}

impl Standardised {
    /// `None` if all draws are equal.
    pub(super) fn new(rows: &[&[f64]]) -> Option<Self> {
        let (low, high) = extremes(rows);
        if low == high {
            return None;
        }
        let shrink = if (high - low).is_finite() { 1.0 } else { 0.25 };
        let origin = rows[0][0] * shrink;
        let span = high * shrink - low * shrink;
        let table = rows.iter().flat_map(|row| row.iter().map(|x| (x * shrink - origin) / span)).collect();
        Some(Self { table, length: rows[0].len(), origin, span, shrink })
    }

    /// The y, one row per chain.
    pub(super) fn rows(&self) -> Vec<&[f64]> {
        super::chains::as_rows(&self.table, self.length)
    }

    /// All y in one slice.
    pub(super) fn values(&self) -> &[f64] {
        &self.table
    }

    pub(super) fn length(&self) -> usize {
        self.length
    }

    /// A location in the unit of y, as one in the unit of x.
    pub(super) fn location(&self, y: f64) -> f64 {
        (self.origin + self.span * y) / self.shrink
    }

    /// A difference in the unit of y, as one in the unit of x.
    pub(super) fn difference(&self, y: f64) -> f64 {
        self.span * y / self.shrink
    }
}

/// Smallest and largest value.
pub(super) fn extremes(rows: &[&[f64]]) -> (f64, f64) {
    let all = rows.iter().flat_map(|row| row.iter());
    all.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &x| (low.min(x), high.max(x)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_values_have_no_variance_at_all() {
        // 0.1 summed a thousand times and divided by a thousand is not 0.1.
        assert_eq!(mean_and_variance(&[0.1; 1000]), (0.1, 0.0));
    }

    #[test]
    fn no_order_and_no_sign_shows() {
        let values: Vec<f64> = (0..9).map(|i| f64::from((i * 7) % 9) * 0.37 - 1.1).collect();
        let (mean, variance) = unordered_mean_and_variance(&values);
        for turn in 0..9 {
            let mut turned = values.clone();
            turned.rotate_left(turn);
            assert_eq!(unordered_mean_and_variance(&turned), (mean, variance));
            turned.iter_mut().for_each(|x| *x = -*x);
            assert_eq!(unordered_mean_and_variance(&turned), (-mean, variance));
        }
        let plain = mean_and_variance(&values);
        assert!((plain.0 - mean).abs() < 1e-15 && (plain.1 / variance - 1.0).abs() < 1e-14);
    }

    #[test]
    fn the_unit_survives_the_extremes() {
        for scale in [5e-324, 1e-300, 1.0, 1e300, f64::MAX] {
            let row = [-scale, 0.0, scale, scale];
            let standard = Standardised::new(&[&row]);
            let standard = standard.as_ref().expect("the draws differ");
            assert!(standard.values().iter().all(|y| y.abs() <= 1.0), "{scale:e}");
            let back: Vec<f64> = standard.values().iter().map(|&y| standard.location(y)).collect();
            for (x, y) in row.iter().zip(back) {
                assert!((x / 2.0 - y / 2.0).abs() <= 1e-15 * scale, "{scale:e}: {x:e} came back as {y:e}");
            }
        }
        assert!(Standardised::new(&[&[3.0; 4], &[3.0; 4]]).is_none());
    }
}

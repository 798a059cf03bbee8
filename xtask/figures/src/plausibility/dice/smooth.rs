//! How well any smooth curve could fit: one with free coefficients, fitted to the published shares themselves.

use super::published::Rolled;
use plaus_dist::math;

/// Number of terms of the curve: ln(p / (1 − p)) is a polynomial of ln(x/y) of this degree that gives a cube its third.
const DEGREE: usize = 4;

/// Damped rounds of Newton's method on the likelihood, which has a single maximum. Default 200: halving the step each
/// time leaves 2⁻²⁰⁰ of where it began.
const ROUNDS: usize = 200;

/// Σ (k − n p)² / (n p (1 − p)) about the curve of largest likelihood, and its degrees of freedom.
pub(super) fn misfit(rolled: &[Rolled]) -> (f64, u32) {
    let terms = |rolled: &Rolled| -> [f64; DEGREE] {
        let x = math::ln(rolled.ratio);
        std::array::from_fn(|k| math::powi(x, k as i32 + 1))
    };
    let mut curve = [0.0; DEGREE];
    let share = |curve: &[f64; DEGREE], rolled: &Rolled| {
        let sum: f64 = curve.iter().zip(terms(rolled)).map(|(a, x)| a * x).sum();
        1.0 / (1.0 + 2.0 * math::exp(-sum))
    };
    for _ in 0..ROUNDS {
        // Information and score, side by side.
        let mut system = [[0.0; DEGREE + 1]; DEGREE];
        for rolled in rolled {
            let (x, p, n) = (terms(rolled), share(&curve, rolled), rolled.square.of as f64);
            for (row, xi) in system.iter_mut().zip(x) {
                for (cell, xj) in row.iter_mut().zip(x) {
                    *cell += n * p * (1.0 - p) * xi * xj;
                }
                row[DEGREE] += xi * (rolled.square.hits as f64 - n * p);
            }
        }
        let step = solve(system);
        curve.iter_mut().zip(step).for_each(|(a, s)| *a += 0.5 * s);
    }
    let part = |rolled: &Rolled| {
        let (p, n) = (share(&curve, rolled), rolled.square.of as f64);
        math::square(rolled.square.hits as f64 - n * p) / (n * p * (1.0 - p))
    };
    (rolled.iter().map(part).sum(), (rolled.len() - DEGREE) as u32)
}

/// Gauss–Jordan elimination, the largest pivot first.
fn solve(mut system: [[f64; DEGREE + 1]; DEGREE]) -> [f64; DEGREE] {
    for k in 0..DEGREE {
        let pivot = (k..DEGREE).max_by(|&a, &b| system[a][k].abs().total_cmp(&system[b][k].abs())).unwrap_or(k);
        system.swap(k, pivot);
        let row = system[k];
        for (_, other) in system.iter_mut().enumerate().filter(|(j, _)| *j != k) {
            let part = other[k] / row[k];
            other.iter_mut().zip(row).for_each(|(cell, value)| *cell -= part * value);
        }
    }
    std::array::from_fn(|k| system[k][DEGREE] / system[k][k])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plausibility::chance::Count;

    /// For counts on a curve of that form, rounded, only rounding remains: at most a quarter of a count squared over
    /// the variance, which is above 6,000, for each.
    #[test]
    fn a_curve_of_that_form_is_found() {
        let of = |ratio: f64| {
            let x = math::ln(ratio);
            let p = 1.0 / (1.0 + 2.0 * math::exp(2.5 * x + 0.4 * x * x));
            Rolled { ratio, square: Count::of_share(p, 100_000) }
        };
        let rolled: Vec<Rolled> = [0.5, 0.7, 0.9, 1.1, 1.3, 1.6, 2.0].map(of).to_vec();
        let (sum, freedom) = misfit(&rolled);
        assert!(sum < 7.0 * 0.25 / 6_000.0 && freedom == 3, "{sum}");
    }
}

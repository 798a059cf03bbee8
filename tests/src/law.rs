//! Does a sample follow a law whose distribution function is known?

use plaus_dist::math;

/// The largest distance between the empirical distribution function of `values` and `cdf`, in [0, 1]
/// (Kolmogorov–Smirnov).
pub fn distance(mut values: Vec<f64>, cdf: impl Fn(f64) -> f64) -> f64 {
    values.sort_unstable_by(f64::total_cmp);
    let count = values.len() as f64;
    let gap = |(index, x): (usize, &f64)| {
        let at = cdf(*x);
        (at - index as f64 / count).abs().max((at - (index + 1) as f64 / count).abs())
    };
    values.iter().enumerate().map(gap).fold(0.0, f64::max)
}

/// For a sample of `count`, [`distance`] exceeds this with probability at most `alpha`, whatever the law (Dvoretzky,
/// Kiefer, Wolfowitz; constant by Massart, "The tight constant in the Dvoretzky–Kiefer–Wolfowitz inequality", Annals of
/// Probability 18, 1990).
#[must_use]
pub fn bound(alpha: f64, count: usize) -> f64 {
    (math::ln(2.0 / alpha) / (2.0 * count as f64)).sqrt()
}

/// Distribution function of the standard normal law.
#[must_use]
pub fn normal(z: f64) -> f64 {
    0.5 * math::erfc(-z * std::f64::consts::FRAC_1_SQRT_2)
}

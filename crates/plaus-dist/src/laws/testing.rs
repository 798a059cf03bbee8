//! Tools of the unit tests: statistics with a false-alarm rate of 1e-6 each, on fixed seeds, and a quadrature rule.

use crate::{Purpose, Sample, Seed, Stream};

/// Two-sided 1e-6 point of the standard normal law, for [`z_score`].
pub(crate) const Z_LIMIT: f64 = 4.892;
/// 1e-6 point of Kolmogorov's law, for [`ks`] and [`ks_two`]: 2 exp(−2t²) = 1e-6 at t = √(ln(2·10⁶)/2).
pub(crate) const KS_LIMIT: f64 = 2.694;

/// The stream of a test.
pub(crate) fn stream(seed: u64) -> Stream {
    Seed(seed).chain(0).at(0, Purpose::START)
}

/// `n` draws on the stream of `seed`.
pub(crate) fn draws<S: Sample>(law: &S, n: usize, seed: u64) -> Vec<S::Value> {
    let mut stream = stream(seed);
    (0..n).map(|_| law.sample(&mut stream)).collect()
}

/// Standard errors between the average of `values` and their supposed `mean`, given their supposed standard deviation.
pub(crate) fn z_score(values: impl Iterator<Item = f64>, mean: f64, sd: f64) -> f64 {
    let (n, sum) = values.fold((0.0, 0.0), |(n, sum), x| (n + 1.0, sum + (x - mean)));
    sum / (sd * f64::sqrt(n))
}

/// Kolmogorov's √n sup |F_n − F|.
pub(crate) fn ks(values: impl Iterator<Item = f64>, cdf: impl Fn(f64) -> f64) -> f64 {
    let mut sorted: Vec<f64> = values.collect();
    sorted.sort_unstable_by(f64::total_cmp);
    let n = sorted.len() as f64;
    let gap = |(i, &x): (usize, &f64)| {
        let f = cdf(x);
        (f - i as f64 / n).abs().max(((i + 1) as f64 / n - f).abs())
    };
    sorted.iter().enumerate().map(gap).fold(0.0, f64::max) * n.sqrt()
}

/// Smirnov's two-sample statistic, scaled to the same limit law.
pub(crate) fn ks_two(mut a: Vec<f64>, mut b: Vec<f64>) -> f64 {
    a.sort_unstable_by(f64::total_cmp);
    b.sort_unstable_by(f64::total_cmp);
    let (n, m) = (a.len() as f64, b.len() as f64);
    let (mut i, mut j, mut widest) = (0, 0, 0.0_f64);
    while i < a.len() && j < b.len() {
        if a[i] <= b[j] {
            i += 1
        } else {
            j += 1
        }
        widest = widest.max((i as f64 / n - j as f64 / m).abs());
    }
    widest * (n * m / (n + m)).sqrt()
}

/// ∫ f over [a, b]: 200 panels of the five-point Gauss–Legendre rule, which never evaluates the ends.
pub(crate) fn integrate(a: f64, b: f64, f: impl Fn(f64) -> f64) -> f64 {
    const NODES: [(f64, f64); 3] = [
        (0.0, 0.568_888_888_888_888_9),
        (0.538_469_310_105_683_1, 0.478_628_670_499_366_47),
        (0.906_179_845_938_664, 0.236_926_885_056_189_08),
    ];
    let half = 0.5 * (b - a) / 200.0;
    let panel = |i: i32| {
        let centre = a + f64::from(2 * i + 1) * half;
        let node = |(x, w): (f64, f64)| {
            if x == 0.0 { w * f(centre) } else { w * (f(centre - half * x) + f(centre + half * x)) }
        };
        NODES.into_iter().map(node).sum::<f64>()
    };
    half * (0..200).map(panel).sum::<f64>()
}

/// Named numbers as a stored distribution would hold them.
pub(crate) fn stored<'a>(
    fields: &'a [(&'a str, f64)],
) -> serde::de::value::MapDeserializer<'a, impl Iterator<Item = (&'a str, f64)>, serde::de::value::Error> {
    serde::de::value::MapDeserializer::new(fields.iter().copied())
}

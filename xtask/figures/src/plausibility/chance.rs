//! Counts, their errors, and how probable it is that two counts differ as much by chance alone.

use plaus_dist::math;

/// How often something happened.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(super) struct Count {
    pub(super) hits: u64,
    pub(super) of: u64,
}

impl Count {
    pub(super) const fn new(hits: u64, of: u64) -> Self {
        Self { hits, of }
    }

    /// The count from which a published share of this many cases was rounded.
    pub(super) fn of_share(share: f64, of: u64) -> Self {
        Self { hits: (share * of as f64).round() as u64, of }
    }

    pub(super) fn share(self) -> f64 {
        self.hits as f64 / self.of as f64
    }

    /// Binomial standard error.
    pub(super) fn error(self) -> f64 {
        (self.share() * (1.0 - self.share()) / self.of as f64).sqrt()
    }

    /// The shares within one standard error of the observed one: Wilson's score interval, which does not shrink to
    /// nothing if nothing was observed.
    pub(super) fn interval(self) -> (f64, f64) {
        let (n, p) = (self.of as f64, self.share());
        let middle = (p + 0.5 / n) / (1.0 + 1.0 / n);
        let half = (p * (1.0 - p) / n + 0.25 / (n * n)).sqrt() / (1.0 + 1.0 / n);
        (middle - half, middle + half)
    }

    /// In percent, to the second digit of its error.
    pub(super) fn percent(self) -> String {
        // The rule of three: 95 %.
        let three = 300.0 / self.of.max(3) as f64;
        if self.hits == 0 {
            return format!("0 (< {three:.2})");
        }
        if self.hits == self.of {
            return format!("100 (> {:.2})", 100.0 - three);
        }
        let decimals = (1.0 - math::log10(100.0 * self.error().max(1e-6)).floor()).clamp(0.0, 4.0) as usize;
        format!("{:.decimals$} ± {:.decimals$}", 100.0 * self.share(), 100.0 * self.error())
    }

    /// Standard errors between two shares, if both are samples of one probability.
    pub(super) fn z(self, other: Self) -> f64 {
        let (n, m) = (self.of as f64, other.of as f64);
        let pooled = (self.hits + other.hits) as f64 / (n + m);
        let error = (pooled * (1.0 - pooled) * (1.0 / n + 1.0 / m)).sqrt();
        if error > 0.0 { (self.share() - other.share()) / error } else { 0.0 }
    }

    /// Probability of counts at least as improbable as these two, if both are samples of one probability: Fisher's
    /// exact test.
    pub(super) fn p(self, other: Self) -> f64 {
        let hits = self.hits + other.hits;
        // `k` of all `hits` are in this sample.
        let log = |k: u64| {
            let (k, a, b) = (k as f64, self.of as f64, other.of as f64);
            ln_choose(a, k) + ln_choose(b, hits as f64 - k)
        };
        let whole = ln_choose((self.of + other.of) as f64, hits as f64);
        let seen = log(self.hits);
        let range = hits.saturating_sub(other.of)..=hits.min(self.of);
        // Counts that are equally improbable up to rounding belong to the sum.
        let sum: f64 = range.map(log).filter(|&l| l <= seen + 1e-7).map(|l| math::exp(l - whole)).sum();
        sum.min(1.0)
    }
}

fn ln_choose(n: f64, k: f64) -> f64 {
    math::ln_gamma(n + 1.0) - math::ln_gamma(k + 1.0) - math::ln_gamma(n - k + 1.0)
}

/// Probability that χ² with this many degrees of freedom exceeds `x`, from that with two degrees fewer, by parts.
pub(super) fn chi_squared_tail(x: f64, freedom: u32) -> f64 {
    let half = 0.5 * x.max(0.0);
    let (mut tail, mut k) = if freedom.is_multiple_of(2) { (0.0, 0.0) } else { (math::erfc(half.sqrt()), 1.0) };
    while k + 1.5 < f64::from(freedom) {
        // (x/2)^(k/2) e^(−x/2) / Γ(k/2 + 1)
        tail +=
            if half > 0.0 { math::exp(0.5 * k * math::ln(half) - half - math::ln_gamma(0.5 * k + 1.0)) } else { 0.0 };
        k += 2.0;
    }
    if half > 0.0 { tail } else { 1.0 }
}

/// χ² for equal shares, and the probability of a larger value by chance.
pub(super) fn equal_shares(counts: &[u64]) -> (f64, f64) {
    let expected = counts.iter().sum::<u64>() as f64 / counts.len() as f64;
    let sum = counts.iter().map(|&n| math::square(n as f64 - expected) / expected).sum();
    (sum, chi_squared_tail(sum, counts.len() as u32 - 1))
}

/// A probability as text.
pub(super) fn shown_p(p: f64) -> String {
    match p {
        0.1.. => format!("{p:.2}"),
        0.001.. => format!("{p:.3}"),
        1e-9.. => {
            let exponent = math::log10(p).floor() as i32;
            format!("{:.0}·10⁻{}", p / math::powi(10.0, exponent), raised(exponent.unsigned_abs()))
        }
        _ => "< 10⁻⁹".to_owned(),
    }
}

fn raised(number: u32) -> String {
    number
        .to_string()
        .bytes()
        .map(|digit| ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'][usize::from(digit - b'0')])
        .collect()
}

/// With sign, one decimal.
pub(super) fn signed(z: f64) -> String {
    format!("{z:+.1}").replace('-', "−")
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Values of χ² from the tables of Abramowitz & Stegun (26.8), which have four to six digits.
    #[test]
    fn tails_of_chi_squared_agree_with_tables() {
        for (x, freedom, tail) in [
            (3.841_46, 1, 0.05),
            (5.991_47, 2, 0.05),
            (11.0705, 5, 0.05),
            (15.0863, 5, 0.01),
            (24.3219, 7, 0.001),
            (18.3070, 10, 0.05),
        ] {
            let found = chi_squared_tail(x, freedom);
            assert!((found - tail).abs() < 1e-5 * tail.max(0.1), "χ²({freedom}) > {x}: {found}");
        }
        assert_eq!([chi_squared_tail(0.0, 4), chi_squared_tail(0.0, 3)], [1.0, 1.0]);
    }

    /// Fisher's tea: three of four cups right on each side. By hand: (16 + 1) · 2 of 70 ways are no more probable.
    #[test]
    fn the_exact_test_counts_tables() {
        let p = Count::new(3, 4).p(Count::new(1, 4));
        assert!((p - 34.0 / 70.0).abs() < 1e-9, "{p}");
        assert!((Count::new(2, 4).p(Count::new(2, 4)) - 1.0).abs() < 1e-9);
        // For large counts, the normal law's probability of this z, up to the continuity correction of half a count.
        let (a, b) = (Count::new(5_200, 10_000), Count::new(5_000, 10_000));
        let z = a.z(b) - 1.0 / (2.0 * 0.25 * 2e4_f64).sqrt();
        assert!((a.p(b) / math::erfc(z * std::f64::consts::FRAC_1_SQRT_2) - 1.0).abs() < 0.02, "{} at {z}", a.p(b));
    }

    #[test]
    fn counts_are_shown_with_their_errors() {
        assert_eq!(Count::of_share(0.009, 680).hits, 6);
        assert_eq!(Count::new(304, 332).percent(), "91.6 ± 1.5");
        assert_eq!(Count::new(0, 3000).percent(), "0 (< 0.10)");
        let (low, high) = Count::new(0, 100).interval();
        assert!(low.abs() < 1e-12 && high > 0.005);
        assert_eq!([shown_p(0.25), shown_p(3.2e-5), shown_p(1e-20)], ["0.25", "3·10⁻⁵", "< 10⁻⁹"]);
    }
}

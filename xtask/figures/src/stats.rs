//! Numbers with their errors.

use crate::report::{significant, thousands};
use plaus_dist::math::square;
use plaus_mcmc::diagnose::{DiagnoseError, ess_bulk, mcse_mean};

/// A number and its standard error.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Estimate {
    pub(crate) value: f64,
    pub(crate) error: f64,
}

impl Estimate {
    /// The share of draws for which `is` holds, over chains whose draws depend on each other.
    pub(crate) fn share(chains: &[Vec<f64>], is: impl Fn(f64) -> bool) -> Result<Self, DiagnoseError> {
        let flags: Vec<Vec<f64>> =
            chains.iter().map(|chain| chain.iter().map(|&x| f64::from(is(x))).collect()).collect();
        let count: usize = flags.iter().map(Vec::len).sum();
        let value = flags.iter().flatten().sum::<f64>() / count as f64;
        Ok(Self { value, error: mcse_mean(&flags)? })
    }

    /// A share of independent cases.
    pub(crate) fn of(count: usize, cases: usize) -> Self {
        let value = count as f64 / cases as f64;
        Self { value, error: (value * (1.0 - value) / cases as f64).sqrt() }
    }

    /// The mean of independent values.
    pub(crate) fn mean(values: &[f64]) -> Self {
        let n = values.len() as f64;
        let value = values.iter().sum::<f64>() / n;
        let spread: f64 = values.iter().map(|x| square(x - value)).sum();
        Self { value, error: (spread / (n * (n - 1.0).max(1.0))).sqrt() }
    }

    /// How many standard errors two estimates are apart.
    pub(crate) fn z(self, other: Self) -> f64 {
        (self.value - other.value) / (square(self.error) + square(other.error)).sqrt()
    }

    /// Rounded to the second digit of the error.
    pub(crate) fn shown(self) -> String {
        let error = significant(self.error, 2);
        let decimals = error.split_once('.').map_or(0, |(_, decimals)| decimals.len());
        if self.error == 0.0 { self.value.to_string() } else { format!("{:.decimals$} ± {error}", self.value) }
    }
}

/// Iteration numbers at which something happened in independent chains; in some it may never have happened.
#[derive(Debug)]
pub(crate) struct Quantiles {
    /// In order; chains in which it never happened are last.
    sorted: Vec<Option<u64>>,
}

impl Quantiles {
    pub(crate) fn new(mut values: Vec<Option<u64>>) -> Self {
        values.sort_by_key(|value| value.unwrap_or(u64::MAX));
        Self { sorted: values }
    }

    /// In how many chains it happened.
    pub(crate) fn found(&self) -> u64 {
        self.sorted.iter().flatten().count() as u64
    }

    /// The smallest number by which it had happened in a share `q` of the chains.
    pub(crate) fn value(&self, q: f64) -> Option<u64> {
        self.rank(q * self.sorted.len() as f64)
    }

    fn rank(&self, rank: f64) -> Option<u64> {
        let index = (rank.ceil().max(1.0) as usize - 1).min(self.sorted.len() - 1);
        self.sorted[index]
    }

    /// The same with its 95% interval, from order statistics.
    pub(crate) fn at(&self, q: f64) -> String {
        let n = self.sorted.len() as f64;
        let spread = 1.96 * (n * q * (1.0 - q)).sqrt();
        let shown = |value: Option<u64>| value.map_or("never".to_owned(), crate::report::thousands);
        let [value, low, high] = [n * q, n * q - spread, n * q + spread].map(|rank| shown(self.rank(rank)));
        if low == high { value } else { format!("{value} [{low}, {high}]") }
    }

    /// The share of chains in which it had happened by `iteration`.
    pub(crate) fn share_by(&self, iteration: u64) -> Estimate {
        let count = self.sorted.iter().flatten().filter(|&&value| value <= iteration).count();
        Estimate::of(count, self.sorted.len())
    }
}

/// Effective draws per 1,000 iterations.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Ess {
    pub(crate) value: f64,
    /// The same from either half of the chains: how far the value can be trusted.
    halves: [f64; 2],
    /// Median of the same from single chains: how well a chain mixes where it is, even if it has not seen the rest.
    pub(crate) within: f64,
}

impl Ess {
    pub(crate) fn per_1000(chains: &[Vec<f64>]) -> Result<Self, DiagnoseError> {
        let of = |chains: &[Vec<f64>]| -> Result<f64, DiagnoseError> {
            let iterations: usize = chains.iter().map(Vec::len).sum();
            Ok(ess_bulk(chains)? * 1000.0 / iterations as f64)
        };
        let (first, second) = chains.split_at(chains.len() / 2);
        let halves = [of(first)?, of(second)?];
        let mut alone = chains.iter().map(|chain| of(std::slice::from_ref(chain))).collect::<Result<Vec<_>, _>>()?;
        alone.sort_by(f64::total_cmp);
        Ok(Self { value: of(chains)?, halves, within: alone[alone.len() / 2] })
    }

    /// Two digits, with the range of the halves if it differs.
    pub(crate) fn shown(self) -> String {
        let [a, b] = self.halves;
        let [value, low, high] = [self.value, a.min(b), a.max(b)].map(|ess| significant(ess, 2));
        if low == high { value } else { format!("{value} ({low}–{high})") }
    }
}

/// The value that a share `q` of them does not exceed.
pub(crate) fn quantile(sorted: &[f64], q: f64) -> f64 {
    sorted.get(((sorted.len() as f64 * q).ceil() as usize).saturating_sub(1)).copied().unwrap_or(f64::NAN)
}

/// A number for a table: "never" for ∞, "–" for NaN.
pub(crate) fn shown(value: f64, digits: usize) -> String {
    if value.is_infinite() {
        "never".into()
    } else if value.is_nan() {
        "–".into()
    } else if value >= 1000.0 {
        thousands(value.round() as u64)
    } else {
        significant(value, digits)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_are_rounded_with_their_values() {
        let shown = |value, error| Estimate { value, error }.shown();
        assert_eq!(shown(0.683_12, 0.000_61), "0.68312 ± 0.00061");
        assert_eq!(shown(0.683_12, 0.012), "0.683 ± 0.012");
        assert_eq!(shown(1.0, 0.0), "1");
    }

    #[test]
    fn means_have_the_error_of_a_mean() {
        // By hand: the sample's variance is 5/3, over 4.
        let Estimate { value, error } = Estimate::mean(&[1.0, 2.0, 3.0, 4.0]);
        assert!((value - 2.5).abs() < 1e-15 && (error - (5.0_f64 / 12.0).sqrt()).abs() < 1e-15);
    }

    #[test]
    fn quantiles_count_those_that_never_came() {
        let hits = Quantiles::new(vec![Some(5), None, Some(1), Some(3)]);
        assert_eq!([hits.value(0.5), hits.value(0.75), hits.value(1.0)], [Some(3), Some(5), None]);
        assert_eq!((hits.found(), hits.share_by(3).value), (3, 0.5));
    }
}

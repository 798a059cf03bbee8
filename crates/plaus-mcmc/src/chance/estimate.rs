//! The result of batches: a probability with its error, and whether two estimates can be of the same probability.

use super::{Counted, Split, Stoned};
use plaus_dist::{math, normal_quantile};
use serde::{Deserialize, Serialize};

/// Two-sided level of intervals.
const LEVEL: f64 = 0.95;
/// Two estimates are called different if estimates of one probability would differ as much in only this share of cases.
const ALARM: f64 = 1e-3;

/// How a probability was estimated.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Method {
    /// See [`super::count()`].
    Counting,
    /// See [`super::split()`].
    Splitting,
    /// See [`super::stones()`].
    Stones,
}

/// An estimated probability.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Estimate {
    /// The method.
    pub method: Method,
    /// The estimate.
    pub probability: f64,
    /// Its standard error; 0 if nothing was seen that would show it.
    pub error: f64,
    /// 95 % confidence interval, if the method has seen every way to the goal.
    pub interval: [f64; 2],
    /// Number of simulations that it took.
    pub simulations: u64,
    /// Number of draws for counting, of batches for the other methods.
    pub count: u64,
}

impl Estimate {
    /// The probability of event number `event` from counts: a share of independent draws, with Wilson's interval
    /// (1927), which also holds for few hits and for none.
    #[must_use]
    pub fn counted(batches: &[Counted], event: usize) -> Option<Self> {
        let draws: u64 = batches.iter().map(|batch| batch.draws).sum();
        let hits: u64 = batches.iter().filter_map(|batch| batch.hits.get(event)).sum();
        if draws == 0 {
            return None;
        }
        let (n, share, z) = (draws as f64, hits as f64 / draws as f64, normal_quantile(0.5 + 0.5 * LEVEL));
        let centre = (share + z * z / (2.0 * n)) / (1.0 + z * z / n);
        let half = z / (1.0 + z * z / n) * (share * (1.0 - share) / n + z * z / (4.0 * n * n)).sqrt();
        let interval = [if hits == 0 { 0.0 } else { centre - half }, if hits == draws { 1.0 } else { centre + half }];
        let error = (share * (1.0 - share) / n).sqrt();
        Some(Self { method: Method::Counting, probability: share, error, interval, simulations: draws, count: draws })
    }

    /// The probability of event number `event` from splitting.
    #[must_use]
    pub fn split(batches: &[Split], event: usize) -> Option<Self> {
        let values: Vec<f64> = batches.iter().filter_map(|batch| batch.probability.get(event).copied()).collect();
        Self::mean(Method::Splitting, &values, batches.iter().map(|batch| batch.simulations).sum())
    }

    /// The probability of the goal from stepping stones.
    #[must_use]
    pub fn stones(batches: &[Stoned]) -> Option<Self> {
        let values: Vec<f64> = batches.iter().map(|batch| batch.probability).collect();
        Self::mean(Method::Stones, &values, batches.iter().map(|batch| batch.simulations).sum())
    }

    /// The mean of independent estimates; error and interval follow, in the logarithm, from their differences. `None`
    /// for fewer than two.
    fn mean(method: Method, values: &[f64], simulations: u64) -> Option<Self> {
        if values.len() < 2 {
            return None;
        }
        let n = values.len() as f64;
        let probability = values.iter().sum::<f64>() / n;
        let squares = values.iter().map(|value| math::square(value - probability)).sum::<f64>();
        let error = (squares / (n - 1.0) / n).sqrt();
        let interval = if probability > 0.0 {
            let factor = math::exp(student(values.len() as u64 - 1, 0.5 + 0.5 * LEVEL) * error / probability);
            [probability / factor, (probability * factor).min(1.0)]
        } else {
            [0.0, 1.0]
        };
        Some(Self { method, probability, error, interval, simulations, count: values.len() as u64 })
    }

    /// The possible error of the logarithm, at the alarm's level.
    fn reach(&self) -> f64 {
        let freedom = if self.method == Method::Counting { u64::MAX } else { self.count - 1 };
        student(freedom, 1.0 - 0.5 * ALARM) * self.error / self.probability
    }
}

/// Quantile of Student's distribution, from the normal one by the Cornish–Fisher expansion to third order (Abramowitz &
/// Stegun 26.7.5): within 1 % for at least 3 degrees of freedom and levels up to 97.5 %.
#[must_use]
pub fn student(freedom: u64, level: f64) -> f64 {
    let (z, n) = (normal_quantile(level), freedom as f64);
    let z2 = z * z;
    let first = z * (z2 + 1.0) / 4.0;
    let second = z * ((5.0 * z2 + 16.0) * z2 + 3.0) / 96.0;
    let third = z * (((3.0 * z2 + 19.0) * z2 + 17.0) * z2 - 15.0) / 384.0;
    z + (first + (second + third / n) / n) / n
}

/// Two estimates that are unlikely to be of one probability.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Disagreement {
    /// The method that found less.
    pub less: Method,
    /// The method that found more.
    pub more: Method,
    /// How many times as much; `None` if the other found nothing.
    pub factor: Option<f64>,
}

/// The pairs of estimates that differ by more than one in a thousand correct pairs would.
///
/// If one found nothing, the other is tested against it: would as many independent draws as it counted, or as many
/// batches, all have missed something with that probability?
#[must_use]
pub fn disagree(estimates: &[Estimate]) -> Vec<Disagreement> {
    let pairs = estimates.iter().enumerate().flat_map(|(k, a)| estimates[k + 1..].iter().map(move |b| (a, b)));
    let differ = |(a, b): (&Estimate, &Estimate)| {
        let (less, more) = if a.probability < b.probability { (a, b) } else { (b, a) };
        let differs = if less.probability > 0.0 {
            let apart = math::ln(more.probability / less.probability);
            apart > (math::square(less.reach()) + math::square(more.reach())).sqrt()
        } else if less.method == Method::Counting {
            // The least probability that the other estimate allows.
            more.probability > 0.0 && less.count as f64 * more.probability * math::exp(-more.reach()) > -math::ln(ALARM)
        } else {
            more.interval[0] > 0.0
        };
        let factor = (less.probability > 0.0).then(|| more.probability / less.probability);
        differs.then_some(Disagreement { less: less.method, more: more.method, factor })
    };
    pairs.filter_map(differ).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use statrs::distribution::{ContinuousCDF, StudentsT};

    #[test]
    fn quantiles_of_student_are_close() {
        for freedom in [3, 4, 7, 15, 100] {
            let exact = StudentsT::new(0.0, 1.0, freedom as f64).unwrap().inverse_cdf(0.975);
            assert!((student(freedom, 0.975) / exact - 1.0).abs() < 0.01, "{freedom}");
        }
        assert!((student(u64::MAX, 0.975) - 1.959_964).abs() < 1e-6);
    }

    #[test]
    fn wilsons_interval_is_the_one_of_the_books() {
        // 3 of 20: Brown, Cai & DasGupta, "Interval estimation for a binomial proportion" (2001), formula (4).
        let three = Estimate::counted(&[Counted { draws: 12, hits: vec![1] }, Counted { draws: 8, hits: vec![2] }], 0);
        let three = three.unwrap();
        assert!((three.interval[0] - 0.0524).abs() < 1e-4 && (three.interval[1] - 0.3604).abs() < 1e-4, "{three:?}");
        let none = Estimate::counted(&[Counted { draws: 100, hits: vec![0] }], 0).unwrap();
        assert!(none.interval[0] == 0.0 && (none.interval[1] - 3.8415 / 103.8415).abs() < 1e-4);
        assert!(Estimate::counted(&[], 0).is_none());
    }

    fn mean(values: &[f64]) -> Estimate {
        Estimate::mean(Method::Splitting, values, 0).unwrap()
    }

    #[test]
    fn estimates_disagree_where_errors_do_not_reach() {
        let near = [mean(&[1e-6, 1.2e-6, 0.9e-6, 1.1e-6, 1e-6]), mean(&[1.1e-6, 1.0e-6, 1.2e-6, 0.8e-6, 1.3e-6])];
        assert_eq!(disagree(&near), []);
        let far = [near[0], mean(&[4e-6, 4.4e-6, 3.7e-6, 4.1e-6, 4e-6])];
        let found = disagree(&far);
        assert!(found.len() == 1 && found[0].factor.is_some_and(|factor| (factor - 3.9).abs() < 0.1), "{found:?}");
        // Finding nothing among 10,000 draws is no evidence against 1e-6, and strong evidence against 1 %.
        let none = Estimate::counted(&[Counted { draws: 10_000, hits: vec![0] }], 0).unwrap();
        assert_eq!(disagree(&[none, near[0]]), []);
        assert_eq!(disagree(&[none, mean(&[0.01, 0.011, 0.009, 0.0105])]).len(), 1);
    }
}

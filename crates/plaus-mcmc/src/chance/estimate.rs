//! The result of batches: a probability with its error, and whether two estimates can be of the same probability.

use super::{Counted, Split, Stoned, Weighted};
use plaus_dist::{math, normal_quantile};
use serde::{Deserialize, Serialize};

/// Two-sided level of intervals.
const LEVEL: f64 = 0.95;

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
    /// See [`super::importance()`].
    Importance,
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

/// Number of hits from which Wilson's interval is used. Default 40: there it differs from the exact one by 3 %.
const FEW: u64 = 40;

/// The interval of Wilson around a share of n.
fn wilson(share: f64, n: f64) -> [f64; 2] {
    let z = normal_quantile(0.5 + 0.5 * LEVEL);
    let centre = (share + z * z / (2.0 * n)) / (1.0 + z * z / n);
    let half = z / (1.0 + z * z / n) * (share * (1.0 - share) / n + z * z / (4.0 * n * n)).sqrt();
    [centre - half, centre + half]
}

/// The interval of Clopper & Pearson: at its ends, as few or as many hits have half the error's probability.
fn exact(hits: u64, draws: u64) -> [f64; 2] {
    let half = 0.5 * (1.0 - LEVEL);
    // Where the probability of at most `k` hits falls to `level`.
    let falls_to = |k: u64, level: f64| {
        let (mut low, mut high) = (0.0, 1.0);
        for _ in 0..200 {
            let middle = 0.5 * (low + high);
            *(if at_most(k, draws, middle) > level { &mut low } else { &mut high }) = middle;
        }
        0.5 * (low + high)
    };
    let low = if hits == 0 { 0.0 } else { falls_to(hits - 1, 1.0 - half) };
    let high = if hits == draws { 1.0 } else { falls_to(hits, half) };
    [low, high]
}

/// The probability of at most `k` hits in n draws.
fn at_most(k: u64, n: u64, p: f64) -> f64 {
    let (log_p, log_q) = (math::ln(p), math::ln_1p(-p));
    let (mut log_choose, mut sum) = (0.0, 0.0);
    for j in 0..=k.min(n) {
        if j > 0 {
            log_choose += math::ln((n - j + 1) as f64 / j as f64);
        }
        sum += math::exp(log_choose + j as f64 * log_p + (n - j) as f64 * log_q);
    }
    sum
}

impl Estimate {
    /// The probability of event number `event` from counts: a share of independent draws, with the exact interval of
    /// Clopper & Pearson (1934) for few hits or none, and Wilson's (1927) for more.
    #[must_use]
    pub fn counted(batches: &[Counted], event: usize) -> Option<Self> {
        let draws: u64 = batches.iter().map(|batch| batch.draws).sum();
        let hits: u64 = batches.iter().filter_map(|batch| batch.hits.get(event)).sum();
        if draws == 0 {
            return None;
        }
        let (n, share) = (draws as f64, hits as f64 / draws as f64);
        let [low, high] = if hits < FEW { exact(hits, draws) } else { wilson(share, n) };
        let interval = [low, if hits == draws { 1.0 } else { high }];
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

    /// The probability of event number `event` from importance sampling.
    #[must_use]
    pub fn weighted(batches: &[Weighted], event: usize) -> Option<Self> {
        let values: Vec<f64> = batches.iter().filter_map(|batch| batch.probability.get(event).copied()).collect();
        Self::mean(Method::Importance, &values, batches.iter().map(|batch| batch.simulations).sum())
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
            [probability / factor, probability * factor].map(|end| end.min(1.0))
        } else {
            [0.0, 1.0]
        };
        let probability = probability.min(1.0);
        Some(Self { method, probability, error, interval, simulations, count: values.len() as u64 })
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

/// The pairs of estimates whose 95 % intervals do not overlap. One that found nothing among its draws only disagrees
/// with what its own interval excludes; one whose batches found nothing, with all that is surely more than nothing.
#[must_use]
pub fn disagree(estimates: &[Estimate]) -> Vec<Disagreement> {
    let pairs = estimates.iter().enumerate().flat_map(|(k, a)| estimates[k + 1..].iter().map(move |b| (a, b)));
    let differ = |(a, b): (&Estimate, &Estimate)| {
        let (less, more) = if a.probability < b.probability { (a, b) } else { (b, a) };
        let most = if less.probability > 0.0 || less.method == Method::Counting { less.interval[1] } else { 0.0 };
        let factor = (less.probability > 0.0).then(|| more.probability / less.probability);
        (more.interval[0] > most).then_some(Disagreement { less: less.method, more: more.method, factor })
    };
    pairs.filter_map(differ).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use statrs::distribution::{Beta, ContinuousCDF, StudentsT};

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
        let three = wilson(0.15, 20.0);
        assert!((three[0] - 0.0524).abs() < 1e-4 && (three[1] - 0.3604).abs() < 1e-4, "{three:?}");
        assert!(Estimate::counted(&[], 0).is_none());
    }

    #[test]
    fn few_hits_have_the_exact_interval() {
        let three = Estimate::counted(&[Counted { draws: 12, hits: vec![1] }, Counted { draws: 8, hits: vec![2] }], 0);
        // Quantiles of Beta(3, 18) and Beta(4, 17).
        let beta = |a: f64, b: f64, level: f64| Beta::new(a, b).unwrap().inverse_cdf(level);
        let (three, truth) = (three.unwrap(), [beta(3.0, 18.0, 0.025), beta(4.0, 17.0, 0.975)]);
        assert!(three.interval.iter().zip(truth).all(|(a, b)| (a - b).abs() < 1e-4), "{three:?} {truth:?}");
        // None of n: 1 − 0.025^(1/n). All: the mirror image.
        let none = Estimate::counted(&[Counted { draws: 100, hits: vec![0] }], 0).unwrap();
        let most = 1.0 - math::powf(0.025, 0.01);
        assert!(none.interval[0] == 0.0 && (none.interval[1] - most).abs() < 1e-12);
        let all = Estimate::counted(&[Counted { draws: 9, hits: vec![9] }], 0).unwrap();
        assert!(all.interval[1] == 1.0 && (all.interval[0] - math::powf(0.025, 1.0 / 9.0)).abs() < 1e-12);
    }

    fn mean(values: &[f64]) -> Estimate {
        Estimate::mean(Method::Splitting, values, 0).unwrap()
    }

    /// Sums of shares may come to 1 and a rounding error more.
    #[test]
    fn what_is_certain_is_agreed_on() {
        let all = Estimate::counted(&[Counted { draws: 8000, hits: vec![8000] }], 0).unwrap();
        let over = mean(&[1.0 + 4e-16, 1.0 + 4e-16, 1.0, 1.0 + 9e-16]);
        assert!(over.probability == 1.0 && over.interval[0] <= 1.0, "{over:?}");
        assert_eq!(disagree(&[all, over, mean(&[0.98, 1.03, 1.01, 0.99])]), []);
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

//! What all methods together support.
//!
//! Errors of methods that climb are one-sided: a way to the goal that no particle and no chain found is missing from
//! their estimates, and nothing in their spread shows it. So the answer is the largest estimate of a method that can be
//! relied on, its interval covers what the methods support together, and whatever speaks against it is a [`Doubt`].

use super::estimate::disagree;
use super::{Counted, Disagreement, Estimate, Method, Split, Stoned, Weighted};
use plaus_dist::math;
use serde::Serialize;

/// Least number of batches, weighted by what they found, that an estimate must rest on, over the number of batches.
/// Default ¼: batches with a relative deviation of 1.7. Smaller ones accept estimates that single batches carry.
const LEAST_SHARE: f64 = 0.25;

/// Least number of batches that an estimate must rest on, whatever their number. Default 3.
const LEAST_BATCHES: f64 = 3.0;

/// Least mean number of first particles with descendants at the end, weighted by what batches found. Default 3: fewer
/// are the copies of one or two particles, which know one way.
const LEAST_ANCESTORS: f64 = 3.0;

/// Least number of hits of equal weight that an estimate by importance sampling must rest on. Default 16.
const LEAST_HITS: f64 = 16.0;

/// A reason not to trust an answer.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum Doubt {
    /// The 95 % intervals of two methods do not overlap.
    Disagreement(Disagreement),
    /// An estimate rests on few batches.
    FewBatches {
        /// The method.
        method: Method,
        /// Number of equal batches that would have its relative error.
        effective: f64,
        /// Number of batches.
        of: u64,
    },
    /// An estimate by importance sampling rests on few hits.
    FewHits {
        /// Number of hits of equal weight that would have its relative error.
        effective: f64,
    },
    /// The particles that reached the goal descend from few.
    FewAncestors {
        /// The mean number in a batch.
        ancestors: f64,
    },
}

/// The answer of all methods.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Verdict {
    /// The estimate of each method.
    pub estimates: Vec<Estimate>,
    /// The largest estimate that rests on enough batches and ancestors; if there is none, the largest of all. If
    /// nothing was found, the first one. `None` without any estimate.
    pub best: Option<Estimate>,
    /// From the lowest to the highest end of the 95 % intervals of all such estimates.
    pub interval: [f64; 2],
    /// Reasons not to trust it. If there are any, the probability may be higher than the interval.
    pub doubts: Vec<Doubt>,
}

/// The batches of all methods.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Batches {
    /// Of counting.
    pub counted: Vec<Counted>,
    /// Of splitting.
    pub split: Vec<Split>,
    /// Of stepping stones.
    pub stones: Vec<Stoned>,
    /// Of importance sampling.
    pub weighted: Vec<Weighted>,
}

impl Batches {
    /// The estimate of each method of event number `event`: event 0 is the goal, the only one that stones know.
    fn estimates(&self, event: usize) -> Vec<Estimate> {
        let Self { counted, split, stones, weighted } = self;
        let stones = if event == 0 { Estimate::stones(stones) } else { None };
        let all = [Estimate::counted(counted, event), Estimate::split(split, event), stones];
        all.into_iter().chain([Estimate::weighted(weighted, event)]).flatten().collect()
    }

    /// What each method found in each of its batches.
    fn values(&self, method: Method, event: usize) -> Vec<f64> {
        match method {
            Method::Counting => Vec::new(),
            Method::Splitting => self.split.iter().filter_map(|one| one.probability.get(event).copied()).collect(),
            Method::Stones => self.stones.iter().map(|one| one.probability).collect(),
            Method::Importance => self.weighted.iter().filter_map(|one| one.probability.get(event).copied()).collect(),
        }
    }
}

impl Verdict {
    /// On event number `event`.
    #[must_use]
    pub fn new(batches: &Batches, event: usize) -> Self {
        let estimates = batches.estimates(event);
        let found: Vec<(Estimate, Option<Doubt>)> = estimates
            .iter()
            .filter(|one| one.probability > 0.0)
            .map(|one| {
                let own = match one.method {
                    // Of a part, particles that died on the way count too.
                    Method::Splitting if event == 0 => few_ancestors(&batches.split),
                    Method::Importance => few_hits(&batches.weighted, event),
                    Method::Counting | Method::Splitting | Method::Stones => None,
                };
                (*one, own.or_else(|| few_batches(one.method, &batches.values(one.method, event))))
            })
            .collect();
        let sound: Vec<Estimate> = found.iter().filter(|(_, doubt)| doubt.is_none()).map(|(one, _)| *one).collect();
        let largest = |all: &[Estimate]| all.iter().copied().max_by(|a, b| a.probability.total_cmp(&b.probability));
        let all: Vec<Estimate> = found.iter().map(|(one, _)| *one).collect();
        let best = largest(&sound).or_else(|| largest(&all)).or_else(|| estimates.first().copied());
        // An estimate with doubts that is the largest may have seen a way that others missed. Few hits of large weight
        // are common where many numbers matter, and tell nothing before they exceed what others support.
        let exceeds = |one: &Estimate| {
            let least = if one.method == Method::Importance { one.interval[0] } else { one.probability };
            let most = |other: &Estimate| {
                if one.method == Method::Importance { other.interval[1] } else { other.probability }
            };
            sound.iter().all(|other| most(other) < least)
        };
        let mut doubts: Vec<Doubt> =
            found.iter().filter(|(one, _)| exceeds(one)).filter_map(|(_, doubt)| *doubt).collect();
        let supported = if sound.is_empty() { &all } else { &sound };
        let counted = estimates.iter().filter(|one| one.method == Method::Counting && one.probability == 0.0);
        let compared: Vec<Estimate> = supported.iter().chain(counted).copied().collect();
        doubts.extend(disagree(&compared).into_iter().map(Doubt::Disagreement));
        let interval = supported.iter().map(|one| one.interval).reduce(|a, b| [a[0].min(b[0]), a[1].max(b[1])]);
        let interval = interval.or_else(|| best.map(|one| one.interval)).unwrap_or([0.0, 1.0]);
        Self { estimates, best, interval, doubts }
    }

    /// Whether nothing speaks against it.
    #[must_use]
    pub fn is_settled(&self) -> bool {
        self.doubts.is_empty()
    }

    /// Whether several methods were used, and the intervals of all overlap.
    #[must_use]
    pub fn agrees(&self) -> bool {
        self.is_settled() && self.estimates.len() > 1 && disagree(&self.estimates).is_empty()
    }
}

/// Whether the sum of values rests on few of them. Values that are all 0 rest on nothing, and raise no doubt.
fn few_batches(method: Method, values: &[f64]) -> Option<Doubt> {
    let (sum, squares) = (values.iter().sum::<f64>(), values.iter().map(|&x| math::square(x)).sum::<f64>());
    let effective = math::square(sum) / squares;
    let least = (LEAST_SHARE * values.len() as f64).max(LEAST_BATCHES.min(values.len() as f64 - 0.5));
    (squares > 0.0 && effective < least).then_some(Doubt::FewBatches { method, effective, of: values.len() as u64 })
}

/// Whether the weighted hits of an event count as few.
fn few_hits(weighted: &[Weighted], event: usize) -> Option<Doubt> {
    let of = |numbers: &[f64]| numbers.get(event).copied().unwrap_or(0.0);
    let sum: f64 = weighted.iter().map(|batch| of(&batch.probability)).sum();
    let squares: f64 = weighted.iter().map(|batch| of(&batch.squares)).sum();
    let effective = math::square(sum) / squares;
    (squares > 0.0 && effective < LEAST_HITS).then_some(Doubt::FewHits { effective })
}

/// Whether batches that found the goal have few ancestors, each counted by what it found.
fn few_ancestors(split: &[Split]) -> Option<Doubt> {
    let found = |batch: &Split| batch.probability.first().copied().unwrap_or(0.0);
    let sum: f64 = split.iter().map(found).sum();
    let ancestors = split.iter().map(|batch| found(batch) * f64::from(batch.ancestors)).sum::<f64>() / sum;
    (sum > 0.0 && ancestors < LEAST_ANCESTORS).then_some(Doubt::FewAncestors { ancestors })
}

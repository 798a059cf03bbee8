//! The result of all batches.

use super::Chance;
use plaus_mcmc::chance::{Disagreement, Estimate, disagree};
use serde::Serialize;

/// How likely something is.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Answer {
    /// What it is about: all requirements, or one part.
    pub name: String,
    /// The estimate of each method.
    pub estimates: Vec<Estimate>,
    /// The estimate with the smallest relative error; if methods disagree, the largest one, because another method
    /// missed something that this one saw. `None` if nothing was found, and nothing counted.
    pub best: Option<Estimate>,
    /// Which methods cannot both be right.
    pub disagreements: Vec<Disagreement>,
    /// Methods with more than half of their estimate from one batch: not to be trusted yet.
    pub lopsided: Vec<plaus_mcmc::chance::Method>,
}

/// Answers for all requirements together, then for each part.
#[must_use]
pub fn answers(chance: &Chance) -> Vec<Answer> {
    let counted: Vec<_> = chance.counted.values().cloned().collect();
    let split: Vec<_> = chance.split.values().cloned().collect();
    let stones: Vec<_> = chance.stones.values().cloned().collect();
    let names = std::iter::once("all requirements".to_owned()).chain(chance.parts.iter().cloned());
    let answer = |(event, name): (usize, String)| {
        let laid = if event == 0 { Estimate::stones(&stones) } else { None };
        let all = [Estimate::counted(&counted, event), Estimate::split(&split, event), laid];
        let estimates: Vec<Estimate> = all.into_iter().flatten().collect();
        let disagreements = disagree(&estimates);
        let values = split.iter().filter_map(|batch| batch.probability.get(event).copied());
        let mut lopsided = Vec::new();
        if is_lopsided(values.collect()) {
            lopsided.push(plaus_mcmc::chance::Method::Splitting);
        }
        if event == 0 && is_lopsided(stones.iter().map(|batch| batch.probability).collect()) {
            lopsided.push(plaus_mcmc::chance::Method::Stones);
        }
        let best = best(&estimates, !disagreements.is_empty());
        Answer { name, estimates, best, disagreements, lopsided }
    };
    names.enumerate().map(answer).collect()
}

/// Whether one of at least four values is more than half of all.
fn is_lopsided(values: Vec<f64>) -> bool {
    let (sum, most) = (values.iter().sum::<f64>(), values.iter().copied().fold(0.0, f64::max));
    values.len() >= 4 && most > 0.5 * sum
}

fn best(estimates: &[Estimate], they_disagree: bool) -> Option<Estimate> {
    let positive = || estimates.iter().filter(|one| one.probability > 0.0);
    let found = if they_disagree {
        positive().max_by(|a, b| a.probability.total_cmp(&b.probability))
    } else {
        let relative = |one: &Estimate| if one.error > 0.0 { one.error / one.probability } else { 0.0 };
        positive().min_by(|a, b| relative(a).total_cmp(&relative(b)))
    };
    found.or_else(|| estimates.first()).copied()
}

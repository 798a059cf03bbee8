//! The result of all batches.

use super::Chance;
use plaus_mcmc::chance::{Batches, Verdict};
use serde::Serialize;

/// How likely something is.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Answer {
    /// What it is about: all requirements, or one part.
    pub name: String,
    /// What the methods say.
    #[serde(flatten)]
    pub verdict: Verdict,
}

/// Answers for all requirements together, then for each part.
#[must_use]
pub fn answers(chance: &Chance) -> Vec<Answer> {
    let batches = Batches {
        counted: chance.counted.values().cloned().collect(),
        split: chance.split.values().cloned().collect(),
        stones: chance.stones.values().cloned().collect(),
        weighted: chance.weighted.values().cloned().collect(),
    };
    let names = std::iter::once("all requirements".to_owned()).chain(chance.parts.iter().cloned());
    names.enumerate().map(|(event, name)| Answer { name, verdict: Verdict::new(&batches, event) }).collect()
}

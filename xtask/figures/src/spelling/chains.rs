//! Chains that spell words, and what is noted about them.

use crate::Result;
use crate::clock::seconds;
use crate::stats::quantile;
use plaus_dist::Seed;
use plaus_mcmc::{Chain, Decision, Goal, Mixture, MoveCounts, SolutionClass};
use plaus_scenes::spelling::{Config, Savings, Spelling};
use plaus_scenes::{Rules, Scene};
use rayon::prelude::*;
use std::collections::BTreeSet;

/// A word with its moves.
pub(super) struct Word {
    pub(super) scene: Spelling,
    pub(super) moves: Mixture<Spelling>,
}

/// What was noted about one chain.
#[derive(Default)]
pub(super) struct Seen {
    /// Iteration and second of the first full word.
    pub(super) first: Option<(u64, f64)>,
    /// Processor seconds.
    pub(super) seconds: f64,
    pub(super) iterations: u64,
    /// Iterations at a full word.
    full: u64,
    classes: BTreeSet<SolutionClass>,
    pub(super) counts: Vec<MoveCounts>,
    /// The bins of every hundredth state, from the first full word on.
    bins: Vec<Vec<Option<u16>>>,
    /// Iterations at which k fell by half of the word at once.
    pub(super) drops: u64,
}

/// Length of chains.
#[derive(Debug, Clone, Copy)]
pub(super) struct Length {
    pub(super) seeds: u64,
    pub(super) iterations: u64,
    /// Whether they end at the first full word.
    pub(super) until_first: bool,
}

/// The notes on chains of one kind.
pub(super) struct Chains(pub(super) Vec<Seen>);

impl Word {
    pub(super) fn new(config: &Config) -> Result<Self> {
        Self::with_rules(config, &Rules::exact())
    }

    pub(super) fn with_rules(config: &Config, rules: &Rules) -> Result<Self> {
        let scene = Spelling::new(config)?;
        let moves = scene.moves(rules)?;
        Ok(Self { scene, moves })
    }

    pub(super) fn saving(self, savings: Savings) -> Self {
        Self { scene: self.scene.with_savings(savings), ..self }
    }

    /// Number of balls that must lie right.
    pub(super) fn bins(&self) -> usize {
        self.scene.word().designated().len()
    }

    /// Runs chains with the seeds 0, 1, …, on all threads; each is timed separately.
    pub(super) fn run(&self, length: Length) -> Result<Chains> {
        let chains = (0..length.seeds).into_par_iter().map(|seed| self.one(seed, length));
        chains.collect::<Result<Vec<_>>>().map(Chains)
    }

    fn one(&self, seed: u64, length: Length) -> Result<Seen> {
        let begin = seconds();
        let mut chain = Chain::start(&self.scene, &self.moves, Seed(seed).chain(0))?;
        let mut seen = Seen { iterations: length.iterations, ..Seen::default() };
        let sharp = self.bins().div_ceil(2) as u64;
        let mut k = self.scene.reward(&chain.state().outcome);
        let mut class = self.scene.class(chain.state().by_ref());
        for iteration in 1..=length.iterations {
            if chain.step()?.decision == Decision::Accepted {
                let before = std::mem::replace(&mut k, self.scene.reward(&chain.state().outcome));
                seen.drops += u64::from(before >= k + sharp);
                class = self.scene.class(chain.state().by_ref());
            }
            if seen.first.is_some() && iteration.is_multiple_of(100) {
                seen.bins.push(chain.state().outcome.bins.clone());
            }
            let Some(class) = class else { continue };
            seen.first.get_or_insert_with(|| (iteration, seconds() - begin));
            seen.full += 1;
            seen.classes.insert(class);
            if length.until_first {
                seen.iterations = iteration;
                break;
            }
        }
        seen.seconds = seconds() - begin;
        seen.counts = chain.counts().to_vec();
        Ok(seen)
    }
}

impl Chains {
    /// The values in ascending order.
    pub(super) fn sorted(&self, value: impl Fn(&Seen) -> f64) -> Vec<f64> {
        let mut values: Vec<f64> = self.0.iter().map(value).collect();
        values.sort_by(f64::total_cmp);
        values
    }

    /// The value that a share `q` of the chains does not exceed.
    pub(super) fn quantile(&self, q: f64, value: impl Fn(&Seen) -> f64) -> f64 {
        quantile(&self.sorted(value), q)
    }

    /// How many chains found a full word.
    pub(super) fn found(&self) -> usize {
        self.0.iter().filter(|seen| seen.first.is_some()).count()
    }

    /// The acceptance of all moves of one name.
    pub(super) fn acceptance(&self, moves: &Mixture<Spelling>, name: &str) -> f64 {
        let mut all = MoveCounts::default();
        let index = moves.names().iter().position(|known| known == name);
        self.0.iter().filter_map(|seen| seen.counts.get(index?)).for_each(|counts| all.add(counts));
        all.acceptance()
    }

    /// Share of balls that are in the same bin `lag` hundreds of iterations later, among those that were in a bin; NaN
    /// if chains are too short.
    pub(super) fn overlap(&self, lag: usize) -> f64 {
        let (mut same, mut all) = (0_u64, 0_u64);
        for pair in self.0.iter().flat_map(|seen| seen.bins.iter().zip(seen.bins.iter().skip(lag))) {
            for (before, after) in pair.0.iter().zip(pair.1).filter(|(before, _)| before.is_some()) {
                (same, all) = (same + u64::from(before == after), all + 1);
            }
        }
        same as f64 / all as f64
    }
}

impl Seen {
    /// ∞ if there was none.
    pub(super) fn first_iteration(&self) -> f64 {
        self.first.map_or(f64::INFINITY, |(iteration, _)| iteration as f64)
    }

    pub(super) fn first_second(&self) -> f64 {
        self.first.map_or(f64::INFINITY, |(_, second)| second)
    }

    /// Share of iterations at a full word.
    pub(super) fn share(&self) -> f64 {
        self.full as f64 / self.iterations as f64
    }

    /// Distinct full words per minute.
    pub(super) fn distinct(&self) -> f64 {
        60.0 * self.classes.len() as f64 / self.seconds
    }
}

//! How long a run is, and what ends it.

use crate::replicas::Tempering;
use plaus_dist::Seed;
use serde::{Deserialize, Serialize};
use std::ops::Range;

/// Length, recording interval and seed of a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct Plan {
    /// Seed of the run.
    pub seed: Seed,
    /// Number of chains, at least 1.
    pub chains: u32,
    /// Iterations before the sampling phase; recorded, but kept apart.
    pub warmup: u64,
    /// Iterations of the sampling phase, whose states diagnostics use.
    pub iterations: u64,
    /// Every `thin`-th iteration is recorded; at least 1.
    pub thin: u64,
    /// Largest number of iterations between two points at which the run can stop and later continue; at least 1. A run
    /// begins with shorter blocks, of about an eighth of the iterations done.
    pub block: u64,
    /// Stop at the first iteration by which the chains together have recorded this many distinct solutions, including
    /// those of the warm-up: see [`Plan::counts_from`].
    pub solutions: Option<u64>,
    /// Rungs from the prior to the target that each chain's replicas climb and descend; 1 for no tempering. Only states
    /// of the target are recorded, and iterations are those of each rung.
    pub rungs: u32,
    /// Iterations between two swaps.
    pub swap_every: u64,
    /// Whether the warm-up also chooses the number of rungs; `rungs`, at least 2, is then the number to begin with.
    #[serde(default)]
    pub adapt_rungs: bool,
    /// Whether moves' scales are adapted in the warm-up, see [`crate::adapt`].
    pub adapt: bool,
    /// Whether the moves' weights are learnt in the warm-up as well, see [`crate::weigh`]; never without `adapt`.
    #[serde(default)]
    pub weigh: bool,
    /// Whether a chain's warm-up ends before its last iteration once everything that it adapts has settled and half of
    /// the iterations came after its first solution. The chain then stands still for the rest of the warm-up.
    #[serde(default)]
    pub settle: bool,
    /// In so many iterations from the first on, part of the warm-up, each chain searches by climbs: from a fresh draw
    /// of the prior it climbs until it is at a solution, or until the climb has become too long, and then begins anew.
    /// So every solution found there has a search of its own. Only without tempering. Default 0: none.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub climbs: u64,
    /// Whether only solutions of the sampling phase count, although the run looks for solutions. Default: no.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub sampled: bool,
}

impl Plan {
    /// The number of solutions to ask for where all are wanted that the planned iterations find.
    pub const ALL: u64 = u64::MAX;
    /// Iterations of a run that is to end by its solutions or its time alone: more than any run makes.
    pub const ENDLESS: u64 = 1_000_000_000_000;
    /// Iterations of the shortest climb.
    pub const CLIMB: u64 = 512;
    /// How many times as much the constraint counts in a climb, so that what meets it worse is hardly ever kept: of
    /// 1, 4, 10 and 20 in five worlds, 1 took three times as long, and the others were alike.
    pub(crate) const PRESS: f64 = 10.0;

    /// The number of distinct solutions with which the run ends early; `None` if nothing ends it early.
    #[must_use]
    pub fn enough(&self) -> Option<u64> {
        self.solutions.filter(|&wanted| wanted < Self::ALL)
    }

    /// Whether only its solutions or its time are to end the run.
    #[must_use]
    pub fn is_endless(&self) -> bool {
        self.iterations == Self::ENDLESS
    }

    /// One past the last iteration: the states are those of iterations `0 .. end`.
    #[must_use]
    pub fn end(&self) -> u64 {
        self.warmup.saturating_add(self.iterations)
    }

    /// The first iteration whose state may count as a distinct solution. If the run looks for solutions, this is the
    /// start, unless only sampled ones count; otherwise it is the first of the sampling phase.
    #[must_use]
    pub fn counts_from(&self) -> u64 {
        if self.solutions.is_some() && !self.sampled { 0 } else { self.warmup }
    }

    /// Whether a climb has become too long by the time that the iterations `0 .. done` are done: climbs are cut at
    /// fixed iterations, after 1, 1, 2, 1, 1, 2, 4, … times [`Plan::CLIMB`] iterations. Whatever the best length is,
    /// which is not known, this takes longer by a logarithmic factor at most (Luby, Sinclair & Zuckerman 1993).
    #[must_use]
    pub(crate) fn cuts_climb(&self, done: u64) -> bool {
        done.is_multiple_of(Self::CLIMB) && luby_ends(done / Self::CLIMB)
    }

    pub(crate) fn tempering(&self) -> Tempering {
        let Self { rungs, swap_every, warmup, adapt_rungs, .. } = *self;
        Tempering { rungs, swap_every, warmup, adapt_rungs }
    }

    /// Checks the plan for `some` of its chains, which are new, or have done as many iterations as `ends` says.
    pub(super) fn check(&self, some: &Range<u32>, ends: &[u64]) -> Result<(), PlanError> {
        if some.end > self.chains || (some.is_empty() && self.chains > 0) {
            return Err(PlanError::Chains { some: some.clone(), chains: self.chains });
        }
        let rungs = u64::from(self.rungs);
        let sizes = [
            ("chains", u64::from(self.chains)),
            ("thin", self.thin),
            ("block", self.block),
            ("rungs", rungs),
            ("swap_every", self.swap_every),
        ];
        for (name, value) in sizes {
            if value == 0 {
                return Err(PlanError::Zero(name));
            }
        }
        if self.end() >= 1 << 48 {
            return Err(PlanError::TooLong(self.end()));
        }
        let aligned = ends.windows(2).all(|pair| pair[0] == pair[1]);
        if !ends.is_empty() && (ends.len() != some.len() || !aligned || ends.contains(&0)) {
            return Err(PlanError::Starts { chains: some.len() as u32, found: ends.len() });
        }
        Ok(())
    }
}

#[allow(clippy::trivially_copy_pass_by_ref, reason = "serde passes references")]
fn is_zero(number: &u64) -> bool {
    *number == 0
}

/// Whether the sum of some first numbers of the sequence 1, 1, 2, 1, 1, 2, 4, 1, … is `sum`, at least 1. The first
/// 2^k − 1 numbers, k·2^(k − 1) in sum, come twice before the number 2^k does.
fn luby_ends(mut sum: u64) -> bool {
    loop {
        let whole = |k: u32| u64::from(k) << (k - 1);
        // The longest beginning of the kind that is no longer than `sum`; what follows it begins as the whole does.
        let Some(k) = (1..=57).take_while(|&k| whole(k) <= sum).last() else { return sum == 0 };
        sum -= whole(k);
        if sum == 0 || sum >= whole(k) {
            // It comes twice; within the number that follows nothing ends.
            return sum == 0 || sum == whole(k);
        }
    }
}

/// A plan that cannot be run.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum PlanError {
    /// A number that must be positive is 0.
    #[error("`{0}` is 0, but must be at least 1")]
    Zero(&'static str),
    /// The last iteration does not fit in 48 bits: streams would repeat.
    #[error("{0} iterations are more than the limit of 2^48")]
    TooLong(u64),
    /// The plan does not have these chains, or there are none.
    #[error("chains {} to {} are not among the plan's {chains}", .some.start, .some.end)]
    Chains {
        /// Chains that were to be run.
        some: Range<u32>,
        /// Chains of the plan.
        chains: u32,
    },
    /// Starts for another number of chains, or not all at the same iteration.
    #[error("{found} starts for {chains} chains, or starts at different iterations: they are not snapshots of one run")]
    Starts {
        /// Chains that were to be run.
        chains: u32,
        /// Starts given.
        found: usize,
    },
}

#[cfg(test)]
mod tests {
    use super::luby_ends;

    /// Against the sequence's own definition.
    #[test]
    fn climbs_are_cut_where_the_sequence_of_luby_says() {
        fn luby(index: u64) -> u64 {
            let bits = u64::BITS - index.leading_zeros();
            if index + 1 == 1 << bits { 1 << (bits - 1) } else { luby(index + 1 - (1 << (bits - 1))) }
        }
        let ends: Vec<u64> = (1..3000)
            .scan(0, |sum, index| {
                *sum += luby(index);
                Some(*sum)
            })
            .collect();
        assert_eq!(ends[..9], [1, 2, 4, 5, 6, 8, 12, 13, 14]);
        let last = ends[ends.len() - 1];
        assert!((1..=last).filter(|&sum| luby_ends(sum)).eq(ends));
    }
}

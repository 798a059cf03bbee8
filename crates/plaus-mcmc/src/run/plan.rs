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
}

impl Plan {
    /// The number of solutions to ask for where all are wanted that the planned iterations find.
    pub const ALL: u64 = u64::MAX;
    /// Iterations of a run that is to end by its solutions or its time alone: more than any run makes.
    pub const ENDLESS: u64 = 1_000_000_000_000;

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
    /// start; otherwise it is the first of the sampling phase.
    #[must_use]
    pub fn counts_from(&self) -> u64 {
        if self.solutions.is_some() { 0 } else { self.warmup }
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

/// A plan that cannot be run.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
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

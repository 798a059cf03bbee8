//! Parallel tempering: chains between the prior and the target exchange their places, so that the target's chain is restarted again and again from
//! fresh draws, and is still exact.
//!
//! Rung 0 samples the prior (restricted to what the constraint does not forbid), the last rung the target, those between them `p_w p_c^β`. After some iterations
//! of each, neighbours swap with probability `min(1, exp((β_b − β_a)(log p_c(x_a) − log p_c(x_b))))`, which leaves the product of all rungs invariant.
//! Pairs (0,1), (2,3), … alternate with (1,2), (3,4), …: a replica then keeps its direction until a swap is rejected, and makes the way in a time that grows
//! like the number of rungs, not its square (Okabe et al. 2001; Syed et al. 2022, see [`Ladder::barrier`](crate::Ladder::barrier)).

use crate::chain::{Chain, ChainError};
use crate::moves::Mixture;
use crate::target::{ModelError, StateOf, Target};
use crate::tempered::Tempered;
use crate::view::View;
use plaus_dist::{ChainStreams, LogPotential, Purpose, Seed, math, open_unit};
use rayon::prelude::*;

/// A tempered view of a target.
type Rung<'a, T> = Tempered<'a, T>;

/// What was seen at a rung.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct RungStatistics {
    /// Swaps with the rung above that were proposed.
    pub proposed: u64,
    /// Those that were made.
    pub swapped: u64,
}

/// Which end of the ladder a replica has visited last.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Last {
    Neither,
    Prior,
    Target,
}

/// Replicas, one a rung at any time.
pub struct Replicas<'r, 'a, T: Target> {
    target: &'r T,
    /// Each replica keeps its place in this list, whatever its rung.
    chains: Vec<Chain<'r, Rung<'a, T>>>,
    /// The replica at each rung.
    at: Vec<usize>,
    betas: Vec<f64>,
    last: Vec<Last>,
    rounds: u64,
    swaps: ChainStreams,
    statistics: Vec<RungStatistics>,
    restarts: u64,
    round_trips: u64,
}

impl<'r, 'a, T: Target + 'static> Replicas<'r, 'a, T> {
    /// One replica a rung, from start draws of the target. `rungs` and `moves`, of equal number, go from the prior to the target; the moves of the first should draw
    /// anew, so that what comes from there shares nothing with what went there. Streams are those of chains `first_chain`, `first_chain + 1`, … of `seed`.
    ///
    /// # Errors
    /// [`ChainError`] where a chain cannot start.
    pub fn start(
        rungs: &'r [Tempered<'a, T>],
        moves: &'r [Mixture<Tempered<'a, T>>],
        seed: Seed,
        first_chain: u64,
    ) -> Result<Self, ChainError> {
        let pairs = (first_chain..).zip(rungs.iter().zip(moves));
        let chains: Vec<_> = pairs
            .map(|(chain, (rung, moves))| Chain::start(rung, moves, seed.chain(chain)))
            .collect::<Result<_, _>>()?;
        let count = chains.len();
        let Some(target) = rungs.first().map(View::seen) else { return Err(ChainError::NoStart) };
        Ok(Self {
            target,
            chains,
            at: (0..count).collect(),
            betas: rungs[..count].iter().map(Tempered::beta).collect(),
            last: vec![Last::Neither; count],
            rounds: 0,
            swaps: seed.chain(first_chain),
            statistics: vec![RungStatistics::default(); count.saturating_sub(1)],
            restarts: 0,
            round_trips: 0,
        })
    }

    /// One round: `iterations` of every replica at its rung, then swaps of every other pair of neighbours. Replicas run in parallel on the current pool of threads;
    /// their number has no influence on the result.
    ///
    /// # Errors
    /// [`ChainError`] where a replica fails.
    pub fn round(&mut self, iterations: u64) -> Result<(), ChainError> {
        let walk = |chain: &mut Chain<'r, Rung<'a, T>>| (0..iterations).try_for_each(|_| chain.step().map(drop));
        self.chains.par_iter_mut().map(walk).collect::<Vec<_>>().into_iter().collect::<Result<(), _>>()?;
        self.rounds += 1;
        self.swap().map_err(|source| ChainError::Model {
            iteration: self.rounds,
            step: Some("swap".into()),
            source,
        })?;
        self.note_ends();
        Ok(())
    }

    fn swap(&mut self) -> Result<(), ModelError> {
        let mut stream = self.swaps.at(self.rounds, Purpose::SWAP);
        for rung in (0..self.statistics.len()).filter(|rung| (*rung as u64 + self.rounds).is_multiple_of(2)) {
            let ln_u = math::ln(open_unit(&mut stream));
            let (low, high) = (self.at[rung], self.at[rung + 1]);
            let (below, above) = (self.chains[low].state(), self.chains[high].state());
            // Finite: what the constraint forbids is forbidden at every rung.
            let weights = [self.target.log_constraint(&below.outcome)?, self.target.log_constraint(&above.outcome)?];
            let log_alpha = log_alpha([self.betas[rung], self.betas[rung + 1]], weights.map(LogPotential::value));
            self.statistics[rung].proposed += 1;
            if ln_u < log_alpha {
                self.statistics[rung].swapped += 1;
                self.at.swap(rung, rung + 1);
                if let Ok([a, b]) = self.chains.get_disjoint_mut([low, high]) {
                    Chain::exchange_targets(a, b)?;
                }
            }
        }
        Ok(())
    }

    fn note_ends(&mut self) {
        let (Some(&bottom), Some(&top)) = (self.at.first(), self.at.last()) else { return };
        if self.last[bottom] == Last::Target {
            self.round_trips += 1;
        }
        self.last[bottom] = Last::Prior;
        if self.last[top] == Last::Prior {
            self.restarts += 1;
        }
        self.last[top] = Last::Target;
    }

    /// The state of the last rung: a state of the target's chain.
    #[must_use]
    pub fn top(&self) -> Option<&StateOf<Tempered<'a, T>>> {
        self.rung(self.at.len().checked_sub(1)?)
    }

    /// The state at a rung.
    #[must_use]
    pub fn rung(&self, rung: usize) -> Option<&StateOf<Tempered<'a, T>>> {
        self.chains.get(*self.at.get(rung)?).map(Chain::state)
    }

    /// The replica at the last rung: while it is the same, so is the solution's origin.
    #[must_use]
    pub fn top_replica(&self) -> Option<usize> {
        self.at.last().copied()
    }

    /// Rounds made.
    #[must_use]
    pub fn rounds(&self) -> u64 {
        self.rounds
    }

    /// How often a replica came to the last rung that had been at the first since it was there before: each brings a state that shares nothing with those the
    /// target's chain had of that replica before. The first arrivals count.
    #[must_use]
    pub fn restarts(&self) -> u64 {
        self.restarts
    }

    /// How often a replica came to the first rung from the last.
    #[must_use]
    pub fn round_trips(&self) -> u64 {
        self.round_trips
    }

    /// Swaps between each rung and the next.
    #[must_use]
    pub fn statistics(&self) -> &[RungStatistics] {
        &self.statistics
    }

    /// Share of swaps rejected between each rung and the next; 0 where none was proposed.
    #[must_use]
    pub fn rejected(&self) -> Vec<f64> {
        let share = |one: &RungStatistics| (one.proposed - one.swapped) as f64 / one.proposed.max(1) as f64;
        self.statistics.iter().map(share).collect()
    }
}

/// Log of the ratio by which a swap is accepted, of states with these log constraints (at β = 1) at these inverse temperatures.
fn log_alpha(betas: [f64; 2], log_constraints: [f64; 2]) -> f64 {
    (betas[1] - betas[0]) * (log_constraints[0] - log_constraints[1])
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `π_a(x) π_b(y) α(x,y) = π_a(y) π_b(x) α(y,x)` with `π_β ∝ p_c^β`, for all pairs of weights and of rungs; and the wrong sign is seen.
    #[test]
    fn swaps_balance_in_detail() {
        let weights = [0.0, 1.0, 2.5, 7.0];
        let unbalance = |sign: f64| {
            let mut worst = 0.0_f64;
            for betas in [[0.0, 1.0], [0.0, 0.3], [0.3, 0.31], [0.5, 1.0]] {
                for x in weights {
                    for y in weights {
                        let flow = |x: f64, y: f64| {
                            let alpha = math::exp(sign * log_alpha(betas, [x, y])).min(1.0);
                            math::exp(betas[0] * x + betas[1] * y - 7.0) * alpha
                        };
                        worst = worst.max((flow(x, y) - flow(y, x)).abs());
                    }
                }
            }
            worst
        };
        assert!(unbalance(1.0) < 1e-12, "{}", unbalance(1.0));
        assert!(unbalance(-1.0) > 0.1);
    }
}

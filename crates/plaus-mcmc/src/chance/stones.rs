//! Stepping stones: tempered replicas on a ladder between prior and target, where each rung is a stone to the next.
//!
//! With V the log constraint, rung k samples `π_k ∝ p_w exp(β_k V)`, from β_0 = 0 to β_K = 1. The normalising constant
//! of the target against the prior is a product of ratios that each step can see well (Xie, Lewis, Fan, Kuo & Chen,
//! "Improving marginal likelihood estimation for Bayesian phylogenetic model selection", Systematic Biology 60, 2011):
//!
//! `Z = P(V > −∞) · Π_k E_k[exp((β_k+1 − β_k) V)]`,  and  `P(goal) = Z · E_K[1_goal exp(−V)]`.
//!
//! The first factor is needed because rung 0 samples only what the constraint allows. A batch is one set of replicas
//! with its own ladder, adapted in its warm-up.

use super::{ChanceError, ChancePulse, at_least};
use crate::moves::Mixture;
use crate::parallel;
use crate::redraw::Redraw;
use crate::replicas::{Course, Replicas, Tempering};
use crate::target::Goal;
use plaus_dist::{Seed, math};
use serde::{Deserialize, Serialize};

/// Settings of stepping stones.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Stones {
    /// Rungs of the ladder, at least 2.
    pub rungs: u32,
    /// Iterations between two swaps, at least 1.
    pub swap_every: u64,
    /// Iterations in which the ladder is adapted, and nothing is used.
    pub warmup: u64,
    /// Iterations of each rung that the estimate uses, at least 1.
    pub iterations: u64,
}

/// The result of a batch.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Stoned {
    /// The estimated probability of the goal.
    pub probability: f64,
    /// The estimated `ln Z`; −10³⁰⁸ if nothing is allowed.
    pub log_z: f64,
    /// Share of the target's states that reach the goal.
    pub satisfying: f64,
    /// The barrier between prior and target: see [`Ladder::barrier`](crate::Ladder::barrier).
    pub barrier: f64,
    /// Number of simulations, including those that stopped early.
    pub simulations: u64,
}

/// The logarithm of a mean of exponentials, one after the other.
#[derive(Debug, Clone, Copy)]
struct LogMean {
    most: f64,
    sum: f64,
    count: u64,
}

impl LogMean {
    const NONE: Self = Self { most: f64::NEG_INFINITY, sum: 0.0, count: 0 };

    /// Adds `exp(log)`.
    fn note(&mut self, log: f64) {
        self.count += 1;
        if log <= self.most {
            self.sum += if log == f64::NEG_INFINITY { 0.0 } else { math::exp(log - self.most) };
        } else {
            self.sum = 1.0 + if self.sum > 0.0 { self.sum * math::exp(self.most - log) } else { 0.0 };
            self.most = log;
        }
    }

    fn value(self) -> f64 {
        if self.sum > 0.0 { self.most + math::ln(self.sum / self.count as f64) } else { f64::NEG_INFINITY }
    }
}

/// Estimates the probability of the goal of `target` from one set of tempered replicas, which walk by its `moves`.
///
/// # Errors
/// [`ChanceError`] if a chain fails, the plan makes no batch, or the pulse was stopped.
pub fn stones<T: Goal>(
    target: &T,
    moves: &Mixture<T>,
    seed: Seed,
    batch: u32,
    plan: Stones,
    pulse: &ChancePulse,
) -> Result<Stoned, ChanceError> {
    let Stones { rungs, swap_every, iterations, .. } = plan;
    for (name, value, least) in
        [("rungs", u64::from(rungs), 2), ("swap_every", swap_every, 1), ("iterations", iterations, 1)]
    {
        at_least(name, value, least)?;
    }
    // Batches run in parallel. Within a batch, passing replicas from thread to thread after each iteration would cost
    // more than their work.
    parallel::alone(|| lay(target, moves, seed, batch, plan, pulse))
}

fn lay<T: Goal>(
    target: &T,
    moves: &Mixture<T>,
    seed: Seed,
    batch: u32,
    plan: Stones,
    pulse: &ChancePulse,
) -> Result<Stoned, ChanceError> {
    let Stones { rungs, swap_every, warmup, iterations } = plan;
    let fresh = Mixture::of(Box::new(Redraw));
    let tempering = Tempering { rungs, swap_every, warmup, adapt_rungs: false };
    let course = Course { target, moves, fresh: &fresh, tempering };
    let fail = |source| ChanceError::Chain { batch, source };
    // Numbers of chains from the far end, which no run uses.
    let mut replicas = Replicas::start(course, seed, u32::MAX - batch).map_err(fail)?.adapting(warmup);
    let mut seen = made(&replicas, pulse, 0)?;
    while replicas.iteration() < warmup {
        replicas.advance((replicas.iteration() + swap_every).min(warmup), |_, _| {}).map_err(fail)?;
        seen = made(&replicas, pulse, seen)?;
    }
    let mut walk = Walk { steps: vec![LogMean::NONE; rungs as usize - 1], goal: LogMean::NONE, satisfying: 0 };
    let before = allowed(&replicas);
    while replicas.iteration() < warmup + iterations {
        replicas.advance(replicas.iteration() + 1, |_, _| {}).map_err(fail)?;
        walk.note(target, &replicas);
        if replicas.iteration().is_multiple_of(swap_every) {
            seen = made(&replicas, pulse, seen)?;
        }
    }
    let simulations = made(&replicas, pulse, seen)?;
    let after = allowed(&replicas);
    let allowed = (after.0 - before.0) as f64 / (after.1 - before.1).max(1) as f64;
    let log_z = math::ln(allowed) + walk.steps.iter().map(|step| step.value()).sum::<f64>();
    Ok(Stoned {
        probability: math::exp(log_z + walk.goal.value()).min(1.0),
        log_z: log_z.max(f64::MIN),
        satisfying: walk.satisfying as f64 / iterations as f64,
        barrier: replicas.climb().rejected().iter().sum(),
        simulations,
    })
}

/// Data collected from the rungs after each iteration.
struct Walk {
    steps: Vec<LogMean>,
    goal: LogMean,
    satisfying: u64,
}

impl Walk {
    fn note<T: Goal>(&mut self, target: &T, replicas: &Replicas<'_, T>) {
        let betas = replicas.climb().ladder().betas();
        for (rung, (step, betas)) in self.steps.iter_mut().zip(betas.windows(2)).enumerate() {
            if let Some(state) = replicas.rung(rung) {
                step.note((betas[1] - betas[0]) * state.log_constraint.value());
            }
        }
        let top = replicas.top().state();
        let satisfies = target.class(top.by_ref()).is_some();
        self.satisfying += u64::from(satisfies);
        self.goal.note(if satisfies { -top.log_constraint.value() } else { f64::NEG_INFINITY });
    }
}

/// Number of draws of the first rung that the constraint allows, and of all that were simulated.
fn allowed<T: Goal>(replicas: &Replicas<'_, T>) -> (u64, u64) {
    let counts = replicas.counts_of(0).first().copied().unwrap_or_default();
    (counts.accepted, counts.accepted + counts.rejected + counts.rejected_early)
}

/// Reports simulations beyond the `seen` ones to the pulse; gives their total.
fn made<T: Goal>(replicas: &Replicas<'_, T>, pulse: &ChancePulse, seen: u64) -> Result<u64, ChanceError> {
    let rungs = 0..replicas.climb().ladder().betas().len();
    let counts = rungs.flat_map(|rung| replicas.counts_of(rung));
    let all = counts.map(|one| one.accepted + one.rejected + one.rejected_early).sum::<u64>();
    pulse.made(all.saturating_sub(seen))?;
    Ok(all)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn means_of_exponentials_neither_overflow_nor_vanish() {
        let mean = |logs: &[f64]| {
            let mut mean = LogMean::NONE;
            logs.iter().for_each(|&log| mean.note(log));
            mean.value()
        };
        assert_eq!(mean(&[]), f64::NEG_INFINITY);
        assert_eq!(mean(&[f64::NEG_INFINITY; 3]), f64::NEG_INFINITY);
        for shift in [-1e4, 0.0, 1e4] {
            // The mean of 1, 2 and 3 is 2; four roundings of numbers of the shift's size.
            let found = mean(&[shift, shift + math::ln(2.0), f64::NEG_INFINITY, shift + math::ln(5.0)]);
            assert!((found - shift - math::ln(2.0)).abs() < 4.0 * 1e4 * f64::EPSILON, "{shift}: {found}");
        }
    }
}

//! Importance sampling from a widened prior.
//!
//! Draws come from the prior with all its Gaussian numbers spread 1, 1.5, 2 or 3 times as far about their means, each
//! in a quarter of the draws. A draw at standard scores z weighs `1 / mean_s Π exp(z²/2 − z²/2s²)/s`, the prior's
//! density over the mixture's, so the weighted mean is unbiased, and no weight exceeds 4. It reaches far into tails in
//! any direction without climbing: what hides a way to the goal from particles, levels that lead elsewhere, does not
//! hide it here. Where many numbers matter at once, widened draws weigh next to nothing, and it is no better than
//! counting a quarter of its draws.

use super::{ChanceError, ChancePulse, DRAW, Parts, at_least, streams};
use crate::law::Law;
use crate::target::{Goal, ModelError, State};
use crate::vars::Variables;
use plaus_dist::{Seed, math};
use serde::{Deserialize, Serialize};

/// How many times as far Gaussian numbers are spread, in turn.
const SPREADS: [f64; 4] = [1.0, 1.5, 2.0, 3.0];

/// Number of draws between two checks for a stop.
const AT_A_TIME: u64 = 16;

/// The result of a batch.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Weighted {
    /// The estimated probability of the goal, then of each of its parts.
    pub probability: Vec<f64>,
    /// Sums of the squares of weights, for each of them: with the sums of weights they tell how many hits count.
    pub squares: Vec<f64>,
    /// Number of draws, including those that the prior forbids.
    pub draws: u64,
    /// Number of simulations.
    pub simulations: u64,
}

/// The variables that can be spread: Gaussian numbers on which no other law depends.
#[must_use]
pub fn spreadable<T: Variables>(target: &T) -> Vec<usize> {
    let vars = target.vars();
    let depended: Vec<usize> = vars.iter().filter_map(|var| var.law.depends_on()).collect();
    let mut all = vars.which(|var| matches!(var.law, Law::Gaussian(_)) && !var.optional);
    all.retain(|var| !depended.contains(var));
    all
}

/// Estimates from `draws` draws of the widened prior how likely the goal of `target` is, and each of its `parts`.
///
/// # Errors
/// [`ChanceError`] if the model fails, there are no draws to make, or the pulse was stopped.
pub fn importance<T: Goal + Variables>(
    target: &T,
    parts: Parts<'_, T>,
    seed: Seed,
    batch: u32,
    draws: u64,
    pulse: &ChancePulse,
) -> Result<Weighted, ChanceError> {
    at_least("draws", draws, SPREADS.len() as u64)?;
    let (vars, streams, mut scratch) = (spreadable(target), streams(seed, batch), T::Scratch::default());
    let mut met = vec![false; 1 + parts.count];
    let (mut sums, mut squares) = (vec![0.0; met.len()], vec![0.0; met.len()]);
    let (mut simulations, mut told) = (0, 0);
    // Of draws that are not spread: how many, and how many the prior allows.
    let (mut plain, mut allowed) = (0_u64, 0_u64);
    for number in 0..draws {
        let fail = |source: ModelError| ChanceError::Model { batch, draw: number, source };
        let spread = SPREADS[(number % SPREADS.len() as u64) as usize];
        // Draws of its own: an estimate that shared those of counting would agree without being independent.
        let mut draw = target.start(&mut streams.at((1 << 46) + number, DRAW));
        let log = widen(target, &vars, &mut draw, spread);
        let is_allowed = !target.log_prior(&draw).map_err(fail)?.is_zero();
        if spread == 1.0 {
            (plain, allowed) = (plain + 1, allowed + u64::from(is_allowed));
        }
        if is_allowed {
            let state = State::evaluate(target, draw, &mut scratch).map_err(fail)?;
            simulations += 1;
            parts.look(target, state.by_ref(), &mut met);
            let weight = math::exp(log);
            for (event, _) in met.iter().enumerate().filter(|(_, met)| **met) {
                sums[event] += weight;
                squares[event] += math::square(weight);
            }
        }
        if (number + 1).is_multiple_of(AT_A_TIME) || number + 1 == draws {
            pulse.made(simulations - told)?;
            told = simulations;
        }
    }
    let whole = draws as f64 * allowed.max(1) as f64 / plain as f64;
    squares.iter_mut().for_each(|sum| *sum /= math::square(whole));
    // May exceed 1: if batches were cut off there, their mean would be too low.
    Ok(Weighted { probability: sums.iter().map(|sum| sum / whole).collect(), squares, draws, simulations })
}

/// Spreads numbers of a draw about their means; returns the logarithm of its weight.
fn widen<T: Variables>(target: &T, vars: &[usize], draw: &mut T::Draw, spread: f64) -> f64 {
    let mut squares = 0.0;
    for &var in vars {
        let (Law::Gaussian(law), shift) = (&target.vars().get(var).law, target.shift(draw, var)) else { continue };
        let Some([value]) = target.get_mut(draw, var) else { continue };
        let off = spread * (*value + shift - law.mean());
        if spread != 1.0 {
            *value = law.mean() + off - shift;
        }
        squares += math::square(off / law.sd());
    }
    let density = |s: f64| 0.5 * squares * (1.0 - 1.0 / (s * s)) - vars.len() as f64 * math::ln(s);
    let sum = SPREADS.iter().map(|&s| density(s)).fold(f64::NEG_INFINITY, math::ln_add_exp);
    math::ln(SPREADS.len() as f64) - sum
}

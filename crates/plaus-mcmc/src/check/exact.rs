//! Exact draws of a target, and other states to check moves from.

use super::CheckError;
use crate::chain::Chain;
use crate::moves::Mixture;
use crate::target::{ModelError, State, StateOf, Target};
use plaus_dist::{LogPotential, Seed, Stream, math, open_unit};
use rand::RngExt;

/// Number of draws tried for one that is kept, before giving up.
const TRIES: u64 = 10_000_000;

/// Draws from the prior, as [`Target::start`] makes them, without those of prior density 0. They are exact draws of
/// `target` if its constraint is switched off ([`super::PriorOnly`]) **and** `start` draws from the prior. If `start`
/// does not, [`super::one_step()`] detects it.
pub fn prior<T: Target>(target: &T) -> impl FnMut(&mut Stream) -> Result<StateOf<T>, ModelError> {
    let mut scratch = T::Scratch::default();
    move |stream| {
        for _ in 0..TRIES {
            let draw = target.start(stream);
            if !target.log_prior(&draw)?.is_zero() {
                return State::evaluate(target, draw, &mut scratch);
            }
        }
        Err(ModelError::new(format!("none of {TRIES} start draws has positive prior density")))
    }
}

/// Exact draws of `target` by rejection: a draw from the prior is kept with probability `exp(log p_c − bound)`. Each
/// costs about `exp(bound)` over the mean of `p_c` under the prior. A sampler that fails 10⁷ times in a row gives up
/// with an error, and so does one that meets a constraint above `bound`.
///
/// `bound` is the largest possible `log p_c`, or any larger number.
pub fn rejection<T: Target>(
    target: &T,
    bound: LogPotential,
) -> impl FnMut(&mut Stream) -> Result<StateOf<T>, ModelError> {
    let mut prior = prior(target);
    move |stream| {
        for _ in 0..TRIES {
            let state = prior(stream)?;
            if state.log_constraint > bound {
                let (found, bound) = (state.log_constraint.value(), bound.value());
                return Err(ModelError::new(format!("log constraint {found} exceeds the bound {bound} of rejection")));
            }
            if math::ln(open_unit(stream)) < state.log_constraint.value() - bound.value() {
                return Ok(state);
            }
        }
        Err(ModelError::new(format!("rejection kept none of {TRIES} draws from the prior")))
    }
}

/// One of `states`, each equally likely.
pub fn any_of<D: Clone, O: Clone>(
    states: &[State<D, O>],
) -> impl FnMut(&mut Stream) -> Result<State<D, O>, ModelError> {
    move |stream| {
        if states.is_empty() {
            return Err(ModelError::new("there is no state to start from"));
        }
        Ok(states[stream.random_range(0..states.len() as u64) as usize].clone())
    }
}

/// Every `every`-th state that a chain visits, `count` of them, without its start. These states are typical of the
/// target; with [`any_of`] they are a source for [`super::ratios()`].
///
/// # Errors
/// [`CheckError::Chain`] if the chain fails.
pub fn visited<T: Target>(
    target: &T,
    moves: &Mixture<T>,
    seed: Seed,
    every: u64,
    count: usize,
) -> Result<Vec<StateOf<T>>, CheckError> {
    let walk = || {
        let mut chain = Chain::start(target, moves, seed.chain(0))?;
        let mut states = Vec::with_capacity(count);
        while states.len() < count {
            for _ in 0..every.max(1) {
                chain.step()?;
            }
            states.push(chain.state().clone());
        }
        Ok(states)
    };
    walk().map_err(|source| CheckError::Chain { index: 0, source })
}

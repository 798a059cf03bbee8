//! Independent draws of the target, by rejection from the prior.

use crate::moves::{At, Mixture, Move, Proposal, Transition};
use crate::parallel;
use crate::target::{Goal, ModelError, Simulated, State, StateOf, Target, at_most, most_of};
use plaus_dist::{LogPotential, LogRatio, Purpose, Seed, Stream, math, open_unit};
use std::ops::Range;

/// Purpose of the random numbers for a draw of a trial.
const TRIAL: Purpose = Purpose(6);

/// Proposes [`Target::start`]'s draw, which is kept with probability `p_c / M` whatever the current state; `M` is
/// [`Target::most`]. This is correct for a target whose start has the law of its prior. A chain with no other move
/// holds each kept draw until the next one, so the kept draws are independent draws of the target.
///
/// In comparison, [`Redraw`](crate::Redraw) with its Metropolis ratio keeps more draws, but holds each one longer the
/// better it is.
#[derive(Debug, Clone, Copy, Default)]
pub struct Independent;

impl Independent {
    /// Its name as a move.
    pub const NAME: &'static str = "draw_prior";

    /// The moves of a chain with no other move.
    #[must_use]
    pub fn mixture<T: Target>() -> Mixture<T> {
        Mixture::of(Box::new(Self))
    }
}

impl<T: Target> Move<T> for Independent {
    fn name(&self) -> &str {
        Self::NAME
    }

    fn propose(&self, at: At<'_, T>, candidate: &mut T::Draw, stream: &mut Stream) -> Result<Proposal, ModelError> {
        *candidate = at.target.start(stream);
        Ok(Proposal::Anew)
    }

    /// The ratio of the proposal alone. The accept step does not use it.
    fn log_ratio(&self, step: Transition<'_, T>) -> Result<LogRatio, ModelError> {
        Ok(LogRatio::new(step.from.log_prior.value() - step.to.log_prior.value())?)
    }
}

/// The result of rejection from the prior.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Tried {
    /// Number of draws made.
    pub draws: u64,
    /// Number of solutions that were kept.
    pub kept: u64,
    /// The work of all draws, see [`Target::work`].
    pub work: u64,
}

impl Tried {
    /// These and others together.
    #[must_use]
    pub fn and(self, other: Self) -> Self {
        Self { draws: self.draws + other.draws, kept: self.kept + other.kept, work: self.work + other.work }
    }
}

/// Draws made one after the other with the same scratch. Default 8.
const IN_A_ROW: u64 = 8;

/// Makes the draws from the prior with these numbers, on the current pool of threads, and stops each as soon as it is
/// certain not to be kept. They are functions of target, seed and number, and differ from the draws of all chains of a
/// run.
///
/// # Errors
/// [`ModelError`] if the model fails, no bound on its constraint is known, or a log constraint exceeds its bound.
pub fn try_draws<T: Goal>(target: &T, seed: Seed, numbers: Range<u64>) -> Result<Tried, ModelError> {
    let most = most_of(target)?;
    let streams = seed.chain(1 << 62);
    let one = |scratch: &mut T::Scratch, number| -> Result<Tried, ModelError> {
        let before = target.work();
        let state = attempt(target, most, &mut streams.at(number, TRIAL), scratch)?;
        let is_solution = state.is_some_and(|state| target.class(state.by_ref()).is_some());
        Ok(Tried { draws: 1, kept: u64::from(is_solution), work: target.work() - before })
    };
    let made = each::<T, Tried>(numbers, one)?;
    Ok(made.into_iter().fold(Tried::default(), Tried::and))
}

/// Makes the draws from the prior with these numbers, like [`try_draws`], and returns those that are kept: independent
/// draws of the target.
///
/// # Errors
/// As [`try_draws`].
pub fn keep_draws<T: Target>(target: &T, seed: Seed, numbers: Range<u64>) -> Result<Vec<StateOf<T>>, ModelError> {
    let most = most_of(target)?;
    let streams = seed.chain(1 << 62 | 1);
    let one = |scratch: &mut T::Scratch, number| attempt(target, most, &mut streams.at(number, TRIAL), scratch);
    Ok(each::<T, _>(numbers, one)?.into_iter().flatten().collect())
}

/// One draw from the prior, if it is kept.
fn attempt<T: Target>(
    target: &T,
    most: LogPotential,
    stream: &mut Stream,
    scratch: &mut T::Scratch,
) -> Result<Option<StateOf<T>>, ModelError> {
    let draw = target.start(stream);
    let log_prior = target.log_prior(&draw)?;
    if log_prior.is_zero() {
        return Ok(None);
    }
    let floor = LogPotential::new(math::ln(open_unit(stream)) + most.value())?;
    let Simulated::Complete(outcome) = target.simulate(&draw, None, floor, scratch)? else { return Ok(None) };
    let log_constraint = at_most(target.log_constraint(&outcome)?, most)?;
    Ok((log_constraint > floor).then_some(State { draw, outcome, log_prior, log_constraint }))
}

/// The results of `one` for each number, in order, on the current pool of threads; several in a row share their
/// scratch.
fn each<T: Target, R: Send>(
    numbers: Range<u64>,
    one: impl Fn(&mut T::Scratch, u64) -> Result<R, ModelError> + Sync,
) -> Result<Vec<R>, ModelError> {
    let parts = numbers.end.saturating_sub(numbers.start).div_ceil(IN_A_ROW);
    let made = parallel::try_map(parts as usize, |part| {
        let from = numbers.start + part as u64 * IN_A_ROW;
        let mut scratch = T::Scratch::default();
        let row = from..numbers.end.min(from + IN_A_ROW);
        row.map(|number| one(&mut scratch, number)).collect::<Result<Vec<R>, ModelError>>()
    })?;
    Ok(made.into_iter().flatten().collect())
}

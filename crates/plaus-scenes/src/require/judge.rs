//! A requirement that the caller's own code judges, such as a function in a script.

use super::answer::Answer;
use super::score::Mark;
use crate::animation::Motion;
use crate::scene::Scene;
use plaus_dist::LogPotential;
use plaus_mcmc::{ModelError, StateRef, Target};
use std::fmt::Debug;

/// A state with the answer of the scene and its requirements.
pub type Candidate<'a, S> = StateRef<'a, <S as Target>::Draw, Answer<<S as Target>::Outcome>>;

/// A further requirement on the states of a scene. It must be a function of the state alone: the same state always gets
/// the same mark. It is asked last of all, and only if its answer can change whether a candidate is accepted.
pub trait Judge<S: Scene>: Debug + Send + Sync {
    /// The largest possible log potential, or any larger number; `None` if there is no such bound, and then no
    /// simulation stops early.
    fn most(&self) -> Option<LogPotential>;

    /// Whether it needs motions.
    fn wants_motion(&self) -> bool;

    /// Judges a state, whose motion is given if it is wanted.
    ///
    /// # Errors
    /// [`ModelError`] if it cannot.
    fn judge(&self, state: Candidate<'_, S>, motion: Option<Motion>) -> Result<Mark, ModelError>;
}

impl<S: Scene> dyn Judge<S> {
    /// Its judgement, which must not exceed the stated bound.
    ///
    /// # Errors
    /// [`ModelError`] if it cannot judge, or the bound is exceeded.
    pub(super) fn mark(&self, state: Candidate<'_, S>, motion: Option<Motion>) -> Result<Mark, ModelError> {
        let mark = self.judge(state, motion)?;
        match self.most().map(LogPotential::value).filter(|most| mark.log > *most) {
            None => Ok(mark),
            Some(most) => {
                let found = mark.log;
                let message = format!("a requirement's log potential of {found} exceeds its stated bound, {most}");
                Err(ModelError::new(message))
            }
        }
    }

    /// What all else must exceed so that the whole can exceed `floor`.
    pub(super) fn floor_before(&self, floor: LogPotential) -> Result<LogPotential, ModelError> {
        self.most().map_or(Ok(LogPotential::ZERO), |most| floor_beside(floor, most))
    }
}

/// What a factor must exceed so that it can exceed `floor` together with another one, which is `most` at most. Rounding
/// is monotone: one ≤ floor − most gives one + other ≤ floor, also in floating point.
///
/// # Errors
/// [`ModelError`] if the bounds are not numbers.
pub(super) fn floor_beside(floor: LogPotential, most: LogPotential) -> Result<LogPotential, ModelError> {
    if most == LogPotential::ONE || floor.is_zero() {
        return Ok(floor);
    }
    Ok(LogPotential::new((floor.value() - most.value()).next_down().min(f64::MAX))?)
}

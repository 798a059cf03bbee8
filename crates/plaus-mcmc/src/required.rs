//! A target with an additional requirement: `p_w · p_c · p_r`, where a [`Requirement`] judges the state that the target
//! made.
//!
//! The target's own moves propose for it ([`Required::moves`]), its simulation still stops early, and the requirement
//! is evaluated last, only if its answer can change the decision. So an expensive requirement, such as a function in a
//! script, is evaluated rarely, and the chain remains exact.

use crate::chain::ChainError;
use crate::failures::Failure;
use crate::look::Look;
use crate::moves::Mixture;
use crate::record::Block;
use crate::run::{Control, Ending, Plan, Progress, Pulse, RunError, Sink, Snapshot, Start, run_some};
use crate::target::{Goal, ModelError, Simulated, SolutionClass, State, StateRef, StateRefOf, Target};
use crate::view::{Sees, lent};
use plaus_dist::{LogDensity, LogPotential, Stream};
use std::ops::Range;

/// A requirement's judgement of a state.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mark {
    /// Log of its factor in the target, up to a constant.
    pub log: LogPotential,
    /// Whether it is met: a state that satisfies its target's constraint is a solution only if it is.
    pub met: bool,
}

/// A further requirement on a target's states. It must be a function of the state alone: the same state always gets the
/// same mark.
pub trait Requirement<T: Target>: Sync {
    /// The largest possible log potential, or any larger number; `None` if there is no such bound, and then no
    /// simulation stops early.
    fn most(&self) -> Option<LogPotential>;

    /// Called before a simulation whose state may be judged. It can tell the target's memory what to keep for that.
    fn prepare(&self, _target: &T, _scratch: &mut T::Scratch) {}

    /// Judges a state; `scratch` is the memory of its simulation, if that has just run.
    ///
    /// # Errors
    /// [`ModelError`] if it cannot.
    fn judge(&self, target: &T, state: StateRefOf<'_, T>, scratch: &T::Scratch) -> Result<Mark, ModelError>;
}

/// An outcome, and the mark of its state.
#[derive(Debug, Clone, PartialEq)]
pub struct Judged<O> {
    /// The outcome as the target alone has it.
    pub outcome: O,
    /// The target's own log constraint.
    pub own: LogPotential,
    /// The requirement's judgement.
    pub mark: Mark,
}

/// The judged outcome of a target.
type JudgedOf<T> = Judged<<T as Target>::Outcome>;

/// Where a target's chains continue.
type StartsOf<T> = Vec<Start<<T as Target>::Draw, <T as Target>::Outcome>>;

/// A target under a requirement.
#[derive(Debug)]
pub struct Required<'a, T, R> {
    target: &'a T,
    requirement: R,
}

impl<'a, T: Target, R: Requirement<T>> Required<'a, T, R> {
    /// `target` under `requirement`.
    pub fn new(target: &'a T, requirement: R) -> Self {
        Self { target, requirement }
    }

    /// The target's moves, with their probabilities, as moves of this one.
    #[must_use]
    pub fn moves(moves: &Mixture<T>) -> Mixture<Self>
    where
        T: 'static,
    {
        lent(moves)
    }

    /// What the requirement says of a state of the target; `scratch` is the memory that it was simulated with, or a
    /// new one.
    ///
    /// # Errors
    ///
    /// [`ModelError`] if the requirement fails, or its log potential exceeds its stated bound.
    pub fn judge(&self, state: StateRefOf<'_, T>, scratch: &T::Scratch) -> Result<Mark, ModelError> {
        let mark = self.requirement.judge(self.target, state, scratch)?;
        if let Some(most) = self.requirement.most().filter(|most| mark.log > *most) {
            let (found, most) = (mark.log.value(), most.value());
            return Err(ModelError::new(format!(
                "a requirement's log potential of {found} exceeds its stated bound, {most}"
            )));
        }
        Ok(mark)
    }

    /// Converts a start of the target's chain, as [`Plain`] left it, into a start of this one's: judges every state
    /// again.
    fn restore(&self, start: Start<T::Draw, T::Outcome>) -> Result<Start<T::Draw, JudgedOf<T>>, ModelError> {
        let Start { snapshot, distinct } = start;
        let snapshot = snapshot.try_map(|recorded| {
            let own = self.target.log_constraint(&recorded.outcome)?;
            let alone = StateRef { log_constraint: own, ..recorded.by_ref() };
            let mark = self.judge(alone, &T::Scratch::default())?;
            let State { draw, outcome, log_prior, log_constraint } = recorded;
            if own + mark.log == log_constraint {
                return Ok(State { draw, outcome: Judged { outcome, own, mark }, log_prior, log_constraint });
            }
            let (was, is) = (log_constraint.value(), (own + mark.log).value());
            Err(ModelError::new(format!(
                "the requirement has changed since the run was made: a stored state had log potential {was}, and now has {is}"
            )))
        })?;
        Ok(Start { snapshot, distinct })
    }

    /// What the target's own constraint must exceed so that this one can exceed `floor`.
    fn floor_seen(&self, floor: LogPotential) -> Result<LogPotential, ModelError> {
        self.requirement.most().map_or(Ok(LogPotential::ZERO), |most| floor_beside(floor, most))
    }
}

/// What a factor must exceed so that it can exceed `floor` together with another one, which is `most` at most. Rounding
/// is monotone: one ≤ floor − most gives one + other ≤ floor, also in floating point.
///
/// # Errors
///
/// [`ModelError`] if the bounds are not numbers.
pub fn floor_beside(floor: LogPotential, most: LogPotential) -> Result<LogPotential, ModelError> {
    if most == LogPotential::ONE || floor.is_zero() {
        return Ok(floor);
    }
    Ok(LogPotential::new((floor.value() - most.value()).next_down().min(f64::MAX))?)
}

impl<T: Target, R: Requirement<T>> Target for Required<'_, T, R> {
    type Draw = T::Draw;
    type Outcome = Judged<T::Outcome>;
    type Scratch = T::Scratch;

    fn start(&self, stream: &mut Stream) -> T::Draw {
        self.target.start(stream)
    }

    fn log_prior(&self, draw: &T::Draw) -> Result<LogDensity, ModelError> {
        self.target.log_prior(draw)
    }

    fn simulate(
        &self,
        draw: &T::Draw,
        current: Option<StateRefOf<'_, Self>>,
        floor: LogPotential,
        scratch: &mut T::Scratch,
    ) -> Result<Simulated<Self::Outcome>, ModelError> {
        let seen_floor = self.floor_seen(floor)?;
        self.requirement.prepare(self.target, scratch);
        let current = current.map(Self::state);
        let Simulated::Complete(outcome) = self.target.simulate(draw, current, seen_floor, scratch)? else {
            return Ok(Simulated::CannotExceedFloor);
        };
        let log_constraint = self.target.log_constraint(&outcome)?;
        if self.target.failure(&outcome).is_some() {
            // It is to be counted; there may be nothing to judge.
            let mark = Mark { met: false, log: LogPotential::ZERO };
            return Ok(Simulated::Complete(Judged { outcome, own: log_constraint, mark }));
        }
        if log_constraint <= seen_floor && !floor.is_zero() {
            return Ok(Simulated::CannotExceedFloor);
        }
        let log_prior = self.target.log_prior(draw)?;
        let mark = self.judge(StateRef { draw, outcome: &outcome, log_prior, log_constraint }, scratch)?;
        Ok(Simulated::Complete(Judged { outcome, own: log_constraint, mark }))
    }

    fn log_constraint(&self, outcome: &Self::Outcome) -> Result<LogPotential, ModelError> {
        Ok(outcome.own + outcome.mark.log)
    }

    fn most(&self) -> Option<LogPotential> {
        Some(self.target.most()? + self.requirement.most()?)
    }

    fn failure(&self, outcome: &Self::Outcome) -> Option<Failure> {
        self.target.failure(&outcome.outcome)
    }

    fn decided(&self, accepted: bool, scratch: &mut T::Scratch) {
        self.target.decided(accepted, scratch);
    }

    fn work(&self) -> u64 {
        self.target.work()
    }

    fn numbers(&self, state: StateRefOf<'_, Self>) -> Vec<f64> {
        self.target.numbers(<Self as Sees<T>>::state(state))
    }
}

impl<T: Goal, R: Requirement<T>> Goal for Required<'_, T, R> {
    fn class(&self, state: StateRefOf<'_, Self>) -> Option<SolutionClass> {
        if state.outcome.mark.met { self.target.class(Self::state(state)) } else { None }
    }

    fn look(&self, state: StateRefOf<'_, Self>) -> Look {
        self.target.look(Self::state(state))
    }
}

impl<T: Target, R: Requirement<T>> Sees<T> for Required<'_, T, R> {
    fn seen(&self) -> &T {
        self.target
    }

    fn state(state: StateRefOf<'_, Self>) -> StateRefOf<'_, T> {
        let StateRef { draw, outcome: Judged { outcome, own, .. }, log_prior, .. } = state;
        StateRef { draw, outcome, log_prior, log_constraint: *own }
    }

    fn draw_mut(draw: &mut T::Draw) -> &mut T::Draw {
        draw
    }
}

/// Like [`run_some`](crate::run_some()), for the target of `required` with its `moves`, to a sink of that target: its
/// states are recorded, with the log constraint of both. The plan is paired with the range of its chains to run, and
/// with where they continue, as such a run left them.
///
/// # Errors
///
/// Those of [`run()`](crate::run()); also if a stored state is judged differently than before.
pub fn run<T: Goal + 'static, R: Requirement<T>, K: Sink<T::Draw, T::Outcome>>(
    required: &Required<'_, T, R>,
    moves: &Mixture<T>,
    (plan, some, starts): (Plan, Range<u32>, StartsOf<T>),
    threads: usize,
    sink: &mut K,
    pulse: &Pulse,
) -> Result<Ending, RunError<K::Error>> {
    let moves = Required::<T, R>::moves(moves);
    let restored = (some.start..).zip(starts).map(|(chain, start)| {
        let iteration = start.snapshot.end_iteration;
        let failed = |source| RunError::Chain { chain, source: ChainError::Model { iteration, step: None, source } };
        required.restore(start).map_err(failed)
    });
    let restored = restored.collect::<Result<Vec<_>, _>>()?;
    run_some(required, &moves, plan, some, restored, threads, &mut Plain(sink), pulse)
}

/// Passes what a chain under a requirement records to a sink of the target: states without their marks, but with the
/// log constraint of both.
struct Plain<'s, K>(&'s mut K);

/// A state without its mark, but with the log constraint of both.
fn plain<D, O>(state: State<D, Judged<O>>) -> State<D, O> {
    let State { draw, outcome, log_prior, log_constraint } = state;
    State { draw, outcome: outcome.outcome, log_prior, log_constraint }
}

impl<D: Clone, O: Clone, K: Sink<D, O>> Sink<D, Judged<O>> for Plain<'_, K> {
    type Error = K::Error;

    fn block(
        &mut self,
        chain: u32,
        block: Block<D, Judged<O>>,
        snapshot: &Snapshot<D, Judged<O>>,
    ) -> Result<(), K::Error> {
        let snapshot = snapshot.clone().try_map(|state| Ok(plain(state)))?;
        self.0.block(chain, block.map(plain), &snapshot)
    }

    fn round(&mut self, progress: &Progress<'_>) -> Result<Control, K::Error> {
        self.0.round(progress)
    }
}

//! What a chain samples: a prior over opaque draws, a simulation, and a constraint on its outcome.

use crate::failures::Failure;
use crate::look::Look;
use plaus_dist::{LogDensity, LogPotential, NotANumber, Stream};
use serde::{Deserialize, Serialize};

/// A failure of a model that no rejection may hide: a density that is not a number, a broken invariant, a world that is
/// none. A simulation that fails for one draw is no such failure, see [`Target::failure`].
#[derive(Debug, thiserror::Error)]
#[error(transparent)]
pub struct ModelError(Box<dyn std::error::Error + Send + Sync>);

impl ModelError {
    /// Wraps any error, or a message.
    pub fn new(source: impl Into<Box<dyn std::error::Error + Send + Sync>>) -> Self {
        Self(source.into())
    }

    /// Whether the model did not fail, but was [`Interrupted`].
    #[must_use]
    pub fn is_interruption(&self) -> bool {
        self.downcast_ref::<Interrupted>().is_some()
    }

    /// The wrapped error, if it is an `E`.
    #[must_use]
    pub fn downcast_ref<E: std::error::Error + 'static>(&self) -> Option<&E> {
        self.0.downcast_ref()
    }
}

/// A simulation was ended from outside, by whoever does not want its result any more. No fault of the model.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("interrupted")]
pub struct Interrupted;

impl From<Interrupted> for ModelError {
    fn from(interrupted: Interrupted) -> Self {
        Self::new(interrupted)
    }
}

impl From<NotANumber> for ModelError {
    fn from(error: NotANumber) -> Self {
        Self::new(error)
    }
}

/// The distribution `p(A) ∝ p_w(draw) · p_c(outcome)` over animations `A = (draw, outcome)`.
///
/// A draw holds the value of every random variable of a world; the outcome is the result of a deterministic simulation
/// of it. The chain looks into neither. Evaluation goes in order of cost: prior, then simulation, then constraint.
pub trait Target: Sync {
    /// Values of all random variables. `clone_from` should reuse its allocation: the chain calls it once in each
    /// iteration.
    type Draw: Clone + PartialEq + Send + Sync;
    /// The part of a simulation's result that the constraint, the record and the moves need.
    type Outcome: Clone + Send + Sync;
    /// Working memory of one chain, reused from simulation to simulation. It may save time, but must never change a
    /// result.
    type Scratch: Default + Send;

    /// A draw to start a chain from, usually a draw from the prior.
    fn start(&self, stream: &mut Stream) -> Self::Draw;

    /// Log prior density `log p_w(draw)`, up to one constant for all draws, including draws of different dimension.
    ///
    /// # Errors
    ///
    /// [`ModelError`] if the density is not a number.
    fn log_prior(&self, draw: &Self::Draw) -> Result<LogDensity, ModelError>;

    /// Simulates `draw`.
    ///
    /// `floor` is what [`Target::log_constraint`] must exceed for the draw to be accepted. If it certainly cannot, the
    /// simulation may stop and return [`Simulated::CannotExceedFloor`]. `current` is the chain's state; unchanged parts
    /// of it may be reused as long as the outcome has the same bits as without that.
    ///
    /// # Errors
    /// [`ModelError`] if there is nothing to simulate, or it was [`Interrupted`]; `scratch` is then of no use. If the
    /// simulation of this draw breaks down, that is an outcome, of log constraint −∞: see [`Target::failure`].
    fn simulate(
        &self,
        draw: &Self::Draw,
        current: Option<StateRefOf<'_, Self>>,
        floor: LogPotential,
        scratch: &mut Self::Scratch,
    ) -> Result<Simulated<Self::Outcome>, ModelError>;

    /// Log constraint `log p_c(outcome)`, up to a constant.
    ///
    /// # Errors
    ///
    /// [`ModelError`] if it is not a number.
    fn log_constraint(&self, outcome: &Self::Outcome) -> Result<LogPotential, ModelError>;

    /// What failed, if this is the outcome of a simulation that did: its log constraint is −∞. Chains count failures
    /// and go on, see [`Failures`](crate::Failures).
    fn failure(&self, _outcome: &Self::Outcome) -> Option<Failure> {
        None
    }

    /// The largest possible log constraint, or any larger number. `None` if no bound is known; then no independent
    /// draws can be made by rejection (see [`crate::Proposal::Anew`]). A bound that is too high only costs time.
    fn most(&self) -> Option<LogPotential> {
        None
    }

    /// The work that simulations have done on this thread so far, for this target or any other. It never decreases, and
    /// the same simulation adds the same amount on every machine. Moves are weighted by it, see [`crate::weigh`]; if it
    /// stays 0, all iterations count alike.
    fn work(&self) -> u64 {
        0
    }

    /// The numbers of a state that measure how far moves lead, see [`crate::weigh`]; the same count for every state. If
    /// there are none, moves keep their weights.
    fn numbers(&self, _state: StateRefOf<'_, Self>) -> Vec<f64> {
        Vec::new()
    }

    /// Called after each decision on a simulated candidate. `accepted` says whether the candidate became the current
    /// state, so that what `scratch` remembers about the current state can follow.
    fn decided(&self, _accepted: bool, _scratch: &mut Self::Scratch) {}
}

/// A target whose states may satisfy its constraint, in ways that can be distinguished.
pub trait Goal: Target {
    /// The class of solutions `state` belongs to, or `None` if it does not satisfy the constraint. Two satisfying
    /// states of the same class count as one distinct solution.
    fn class(&self, state: StateRefOf<'_, Self>) -> Option<SolutionClass>;

    /// How a viewer sees a solution, by which runs that look for a number of solutions tell clearly different ones. By
    /// default all that differ in class are.
    fn look(&self, _state: StateRefOf<'_, Self>) -> Look {
        Look::default()
    }
}

/// A label for a class of solutions: equal for solutions that a user would call the same. See [`SolutionClass::of`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(transparent)]
pub struct SolutionClass(pub u64);

impl SolutionClass {
    /// The label of the empty sequence.
    pub const EMPTY: Self = Self(0x9e37_79b9_7f4a_7c15);

    /// The label of the sequence that continues this one's by `feature`.
    #[inline]
    #[must_use]
    pub fn with(self, feature: i64) -> Self {
        Self(mix(self.0.rotate_left(23) ^ mix(feature.cast_unsigned().wrapping_add(0x51ed))))
    }

    /// The label of a sequence of whole numbers (cells, bins, faces). Different sequences collide with probability
    /// 2⁻⁶⁴.
    #[must_use]
    pub fn of(features: impl IntoIterator<Item = i64>) -> Self {
        features.into_iter().fold(Self::EMPTY, Self::with)
    }
}

/// MurmurHash3's finaliser: a bijection of 64 bits.
#[inline]
fn mix(mut z: u64) -> u64 {
    z = (z ^ (z >> 33)).wrapping_mul(0xff51_afd7_ed55_8ccd);
    z = (z ^ (z >> 33)).wrapping_mul(0xc4ce_b9fe_1a85_ec53);
    z ^ (z >> 33)
}

/// How a simulation ended.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Simulated<O> {
    /// It ran to its end.
    Complete(O),
    /// It stopped early, because the constraint could not exceed the floor in any case.
    CannotExceedFloor,
}

/// A draw with everything evaluated about it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct State<D, O> {
    /// Values of all random variables.
    pub draw: D,
    /// The simulation's result.
    pub outcome: O,
    /// `log p_w(draw)`.
    pub log_prior: LogDensity,
    /// `log p_c(outcome)`.
    pub log_constraint: LogPotential,
}

/// The state of a target.
pub type StateOf<T> = State<<T as Target>::Draw, <T as Target>::Outcome>;

/// A borrowed state, whose parts may be stored in different places: a target that wraps another one passes the inner
/// state on without copying it.
#[derive(Debug)]
pub struct StateRef<'a, D, O> {
    /// Values of all random variables.
    pub draw: &'a D,
    /// What the simulation made of them.
    pub outcome: &'a O,
    /// `log p_w(draw)`.
    pub log_prior: LogDensity,
    /// `log p_c(outcome)`.
    pub log_constraint: LogPotential,
}

/// A borrowed state of a target.
pub type StateRefOf<'a, T> = StateRef<'a, <T as Target>::Draw, <T as Target>::Outcome>;

impl<D, O> Clone for StateRef<'_, D, O> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<D, O> Copy for StateRef<'_, D, O> {}

impl<D, O> State<D, O> {
    /// The state, borrowed.
    #[must_use]
    pub fn by_ref(&self) -> StateRef<'_, D, O> {
        let Self { draw, outcome, log_prior, log_constraint } = self;
        StateRef { draw, outcome, log_prior: *log_prior, log_constraint: *log_constraint }
    }

    /// `log p(A)`, up to the target's constant.
    #[must_use]
    pub fn log_p(&self) -> LogPotential {
        self.log_prior + self.log_constraint
    }

    /// Evaluates `draw` completely, reusing nothing and never stopping early.
    ///
    /// # Errors
    /// [`ModelError`] if the target fails.
    pub fn evaluate<T>(target: &T, draw: D, scratch: &mut T::Scratch) -> Result<Self, ModelError>
    where
        T: Target<Draw = D, Outcome = O> + ?Sized,
    {
        let log_prior = target.log_prior(&draw)?;
        Self::simulate(target, draw, log_prior, scratch)
    }

    /// Simulates a draw whose prior is known.
    pub(crate) fn simulate<T>(
        target: &T,
        draw: D,
        log_prior: LogDensity,
        scratch: &mut T::Scratch,
    ) -> Result<Self, ModelError>
    where
        T: Target<Draw = D, Outcome = O> + ?Sized,
    {
        match target.simulate(&draw, None, LogPotential::ZERO, scratch)? {
            Simulated::Complete(outcome) => {
                let log_constraint = target.log_constraint(&outcome)?;
                Ok(Self { draw, outcome, log_prior, log_constraint })
            }
            Simulated::CannotExceedFloor => {
                Err(ModelError::new("a simulation stopped early although no floor was set: a bug of the target"))
            }
        }
    }
}

/// The largest possible log constraint, according to the target.
pub(crate) fn most_of<T: Target>(target: &T) -> Result<LogPotential, ModelError> {
    let message = "its constraint has no known bound, so draws from the prior cannot be kept by rejection";
    target.most().ok_or_else(|| ModelError::new(message))
}

/// A log constraint, checked against that.
pub(crate) fn at_most(log_constraint: LogPotential, most: LogPotential) -> Result<LogPotential, ModelError> {
    if log_constraint > most {
        let (found, most) = (log_constraint.value(), most.value());
        return Err(ModelError::new(format!("a log constraint of {found} exceeds its stated bound, {most}: a bug")));
    }
    Ok(log_constraint)
}

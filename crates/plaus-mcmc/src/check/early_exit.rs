//! Do optimisations change a state?

use super::CheckError;
use crate::chain::{Chain, ChainError, Decision};
use crate::moves::Mixture;
use crate::target::{ModelError, Simulated, State, StateRefOf, Target};
use crate::view::{View, lend};
use plaus_dist::{LogDensity, LogPotential, Seed, Stream};
use std::fmt;
use std::sync::Arc;

/// A target simulated in the plain way: never stopped early, nothing reused from the current state, nothing remembered
/// between simulations.
#[derive(Debug)]
pub struct NeverEarly<'a, T> {
    target: &'a T,
}

impl<'a, T: Target> NeverEarly<'a, T> {
    /// The plain twin of `target`.
    #[must_use]
    pub fn new(target: &'a T) -> Self {
        Self { target }
    }
}

impl<T: Target> Target for NeverEarly<'_, T> {
    type Draw = T::Draw;
    type Outcome = T::Outcome;
    type Scratch = ();

    fn start(&self, stream: &mut Stream) -> T::Draw {
        self.target.start(stream)
    }

    fn log_prior(&self, draw: &T::Draw) -> Result<LogDensity, ModelError> {
        self.target.log_prior(draw)
    }

    fn simulate(
        &self,
        draw: &T::Draw,
        _current: Option<StateRefOf<'_, Self>>,
        _floor: LogPotential,
        (): &mut (),
    ) -> Result<Simulated<T::Outcome>, ModelError> {
        self.target.simulate(draw, None, LogPotential::ZERO, &mut T::Scratch::default())
    }

    fn log_constraint(&self, outcome: &T::Outcome) -> Result<LogPotential, ModelError> {
        self.target.log_constraint(outcome)
    }
}

impl<T: Target + 'static> View for NeverEarly<'_, T> {
    type Seen = T;

    fn seen(&self) -> &T {
        self.target
    }
}

/// Where the two chains part.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Difference {
    /// The first iteration at which they differ; 0 is the start.
    pub iteration: u64,
    /// The part of the state, or of the step, that differs.
    pub field: &'static str,
}

/// What [`early_exit()`] found.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct EarlyExitReport {
    /// Seed of both chains.
    pub seed: Seed,
    /// Iterations compared.
    pub iterations: u64,
    /// How many of them stopped a simulation early. If there are none, the check has not tested early stops.
    pub stopped_early: u64,
    /// Where the chains part, if they do.
    pub difference: Option<Difference>,
}

impl EarlyExitReport {
    /// Whether both chains had the same states.
    #[must_use]
    pub fn passed(&self) -> bool {
        self.difference.is_none()
    }
}

impl fmt::Display for EarlyExitReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { seed, iterations, stopped_early, difference } = self;
        match difference {
            None => {
                write!(f, "savings: passed, the same {iterations} states (seed {seed}, {stopped_early} early stops)")
            }
            Some(Difference { iteration, field }) => {
                write!(f, "savings: FAILED, {field} differs at iteration {iteration} of seed {seed}")
            }
        }
    }
}

/// Runs a chain with all optimisations of its target (early stops, reuse of the current state, scratch memory) beside
/// its plain twin ([`NeverEarly`]), and compares them state by state, bit by bit.
///
/// Draws and outcomes are compared by `==`, so one that holds a NaN differs from itself.
///
/// # Errors
/// [`CheckError::Chain`] if either chain fails.
pub fn early_exit<T>(
    target: &T,
    moves: Arc<Mixture<T>>,
    seed: Seed,
    iterations: u64,
) -> Result<EarlyExitReport, CheckError>
where
    T: Target + 'static,
    T::Outcome: PartialEq,
{
    let twin = NeverEarly::new(target);
    let twin_moves = lend::<NeverEarly<'_, T>>(Arc::clone(&moves))?;
    let streams = seed.chain(0);
    let mut report = EarlyExitReport { seed, iterations, stopped_early: 0, difference: None };
    let mut walk = || -> Result<(), ChainError> {
        let mut quick = Chain::start(target, &moves, streams)?;
        let mut plain = Chain::start(&twin, &twin_moves, streams)?;
        report.difference = differing(quick.state(), plain.state()).map(|field| Difference { iteration: 0, field });
        while report.difference.is_none() && quick.iteration() < iterations {
            let (quick_step, plain_step) = (quick.step()?, plain.step()?);
            report.stopped_early += u64::from(quick_step.decision == Decision::RejectedEarly);
            let accepted = |decision| decision == Decision::Accepted;
            let field = if quick_step.move_id != plain_step.move_id {
                Some("the move")
            } else if accepted(quick_step.decision) != accepted(plain_step.decision) {
                Some("the decision")
            } else {
                differing(quick.state(), plain.state())
            };
            report.difference = field.map(|field| Difference { iteration: quick.iteration(), field });
        }
        Ok(())
    };
    walk().map_err(|source| CheckError::Chain { index: 0, source })?;
    Ok(report)
}

/// Which part of the two states differs.
fn differing<D: PartialEq, O: PartialEq>(a: &State<D, O>, b: &State<D, O>) -> Option<&'static str> {
    let bits = |state: &State<D, O>| (state.log_prior.value().to_bits(), state.log_constraint.value().to_bits());
    if a.draw != b.draw {
        Some("the draw")
    } else if a.outcome != b.outcome {
        Some("the outcome")
    } else if bits(a) != bits(b) {
        Some("a log density")
    } else {
        None
    }
}

//! The prior as a target: the constraint switched off.

use crate::target::{ModelError, Simulated, StateOf, Target};
use crate::view::View;
use plaus_dist::{LogDensity, LogPotential, Stream};

/// A target with its constraint switched off (λ = 1), so that the prior is what a chain must leave invariant. Draws,
/// outcomes and simulation are the target's own, and its moves serve unchanged through [`crate::view::lend`].
#[derive(Debug)]
pub struct PriorOnly<'a, T> {
    target: &'a T,
}

impl<'a, T: Target> PriorOnly<'a, T> {
    /// The prior of `target`.
    #[must_use]
    pub fn new(target: &'a T) -> Self {
        Self { target }
    }
}

impl<T: Target> Target for PriorOnly<'_, T> {
    type Draw = T::Draw;
    type Outcome = T::Outcome;
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
        current: Option<&StateOf<Self>>,
        floor: LogPotential,
        scratch: &mut T::Scratch,
    ) -> Result<Simulated<T::Outcome>, ModelError> {
        if LogPotential::ONE > floor {
            self.target.simulate(draw, current, LogPotential::ZERO, scratch)
        } else {
            Ok(Simulated::CannotExceedFloor)
        }
    }

    fn log_constraint(&self, _outcome: &T::Outcome) -> Result<LogPotential, ModelError> {
        Ok(LogPotential::ONE)
    }

    fn settle(&self, accepted: bool, scratch: &mut T::Scratch) {
        self.target.settle(accepted, scratch);
    }
}

impl<T: Target + 'static> View for PriorOnly<'_, T> {
    type Seen = T;

    fn seen(&self) -> &T {
        self.target
    }
}

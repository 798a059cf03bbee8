//! The prior above a level of the constraint.

use crate::target::{ModelError, Simulated, StateOf, Target};
use crate::view::View;
use plaus_dist::{LogDensity, LogPotential, Stream};

/// `p_w(draw)` restricted to outcomes whose log constraint is above a level: 1 there, 0 elsewhere. Where a simulation
/// cannot exceed the level it may stop, as it does below the floor of a chain.
pub(super) struct Above<'a, T> {
    pub(super) target: &'a T,
    pub(super) level: LogPotential,
}

impl<T: Target> Target for Above<'_, T> {
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
        if floor >= LogPotential::ONE {
            return Ok(Simulated::CannotExceedFloor);
        }
        self.target.simulate(draw, current, self.level, scratch)
    }

    fn log_constraint(&self, outcome: &T::Outcome) -> Result<LogPotential, ModelError> {
        let is_above = self.target.log_constraint(outcome)? > self.level;
        Ok(if is_above { LogPotential::ONE } else { LogPotential::ZERO })
    }

    fn settle(&self, accepted: bool, scratch: &mut T::Scratch) {
        self.target.settle(accepted, scratch);
    }
}

impl<T: Target + 'static> View for Above<'_, T> {
    type Seen = T;

    fn seen(&self) -> &T {
        self.target
    }
}

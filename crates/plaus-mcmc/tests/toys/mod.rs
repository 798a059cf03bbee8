//! Worlds so small that everything about them is known, and wrong twins of their moves. Several test binaries share
//! them; none uses all of them.
#![allow(dead_code, unreachable_pub, clippy::unwrap_used)]

pub mod balls;
pub mod balls_moves;
pub mod halting;
pub mod remembering;
pub mod ring;
pub mod slots;
pub mod vertices;

use plaus_dist::{LogDensity, LogPotential, Stream, open_unit};
use plaus_mcmc::{ModelError, Simulated, StateRefOf, Target, view::View};

/// A whole number below `n`, each equally likely up to 2⁻⁵².
pub fn below(n: usize, stream: &mut Stream) -> usize {
    (open_unit(stream) * n as f64) as usize
}

/// A chain that ignores −∞ priors: it treats what is forbidden as if it were certain.
pub struct IgnoresForbidden<'a, T>(pub &'a T);

impl<T: Target> Target for IgnoresForbidden<'_, T> {
    type Draw = T::Draw;
    type Outcome = T::Outcome;
    type Scratch = T::Scratch;
    fn start(&self, stream: &mut Stream) -> T::Draw {
        self.0.start(stream)
    }
    fn log_prior(&self, draw: &T::Draw) -> Result<LogDensity, ModelError> {
        let seen = self.0.log_prior(draw)?;
        Ok(if seen.is_zero() { LogDensity::ONE } else { seen })
    }
    fn simulate(
        &self,
        draw: &T::Draw,
        current: Option<StateRefOf<'_, Self>>,
        floor: LogPotential,
        scratch: &mut T::Scratch,
    ) -> Result<Simulated<T::Outcome>, ModelError> {
        self.0.simulate(draw, current, floor, scratch)
    }
    fn log_constraint(&self, outcome: &T::Outcome) -> Result<LogPotential, ModelError> {
        self.0.log_constraint(outcome)
    }
}

impl<T: Target + 'static> View for IgnoresForbidden<'_, T> {
    type Seen = T;
    fn seen(&self) -> &T {
        self.0
    }
}

//! Simulations that are interrupted.

use super::balls::{Balls, Drops};
use plaus_dist::{LogDensity, LogPotential, Stream};
use plaus_mcmc::view::View;
use plaus_mcmc::{Goal, Interrupted, ModelError, Pulse, Simulated, SolutionClass, StateRefOf, Target};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

/// A target whose n-th simulation, and all after it, are interrupted by a request to stop. If it is `quiet`, it says
/// that they cannot be accepted: wrong.
pub struct Halting {
    pub balls: Balls,
    pub left: AtomicU64,
    pub pulse: Arc<Pulse>,
    pub quiet: bool,
}

impl Target for Halting {
    type Draw = Drops;
    type Outcome = Vec<u32>;
    type Scratch = <Balls as Target>::Scratch;
    fn start(&self, stream: &mut Stream) -> Drops {
        self.balls.start(stream)
    }
    fn log_prior(&self, drops: &Drops) -> Result<LogDensity, ModelError> {
        self.balls.log_prior(drops)
    }
    fn simulate(
        &self,
        drops: &Drops,
        current: Option<StateRefOf<'_, Self>>,
        floor: LogPotential,
        scratch: &mut Self::Scratch,
    ) -> Result<Simulated<Vec<u32>>, ModelError> {
        if self.left.fetch_sub(1, Relaxed) == 1 {
            self.pulse.stop();
        }
        match (self.pulse.flag().load(Relaxed), self.quiet) {
            (false, _) => self.balls.simulate(drops, current, floor, scratch),
            (true, true) => Ok(Simulated::CannotExceedFloor),
            (true, false) => Err(Interrupted.into()),
        }
    }
    fn log_constraint(&self, loads: &Vec<u32>) -> Result<LogPotential, ModelError> {
        self.balls.log_constraint(loads)
    }
    fn most(&self) -> Option<LogPotential> {
        self.balls.most()
    }
}

impl Goal for Halting {
    fn class(&self, state: StateRefOf<'_, Self>) -> Option<SolutionClass> {
        self.balls.class(state)
    }
}

impl View for Halting {
    type Seen = Balls;
    fn seen(&self) -> &Balls {
        &self.balls
    }
}

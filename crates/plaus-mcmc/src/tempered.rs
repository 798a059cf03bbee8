//! A target whose constraint counts less: `p_w · p_c^β`.

use crate::target::{ModelError, Simulated, StateOf, Target};
use crate::view::View;
use plaus_dist::{LogDensity, LogPotential, ParamError, Stream};

/// The target `p_w(draw) · p_c(outcome)^β`: for `p_c = λ^k`, the same target at `λ^β`.
///
/// β = 1 is the target itself; β = 0 is the prior restricted to outcomes the constraint does not forbid (−∞ stays −∞). For the whole prior see
/// [`crate::check::PriorOnly`]. The moves of the target serve it through [`crate::view::lend`].
#[derive(Debug)]
pub struct Tempered<'a, T> {
    target: &'a T,
    beta: f64,
}

impl<'a, T: Target> Tempered<'a, T> {
    /// `target` at inverse temperature `beta`.
    ///
    /// # Errors
    /// [`ParamError`] unless 0 ≤ `beta` ≤ 1e300.
    pub fn new(target: &'a T, beta: f64) -> Result<Self, ParamError> {
        if (0.0..=1e300).contains(&beta) {
            Ok(Self { target, beta })
        } else {
            let allowed = "from 0 to 1e300";
            Err(ParamError { distribution: "Tempered", parameter: "beta", value: beta, allowed })
        }
    }

    /// The inverse temperature.
    #[must_use]
    pub fn beta(&self) -> f64 {
        self.beta
    }

    /// A floor for the target itself: whatever constraint does not exceed it does not exceed `floor` when tempered, in floating point.
    /// `None` where no constraint can exceed `floor`.
    fn floor_seen(&self, floor: LogPotential) -> Option<LogPotential> {
        if self.beta == 0.0 {
            return (floor < LogPotential::ONE).then_some(LogPotential::ZERO);
        }
        let mut seen = (floor.value() / self.beta).min(f64::MAX);
        // Multiplication by β rounds monotonically, so the inequality at the floor holds for all below. One or two steps are enough.
        while seen * self.beta > floor.value() {
            seen = seen.next_down();
        }
        LogPotential::new(seen).ok()
    }
}

impl<T: Target> Target for Tempered<'_, T> {
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
        match self.floor_seen(floor) {
            Some(floor) => self.target.simulate(draw, current, floor, scratch),
            None => Ok(Simulated::CannotExceedFloor),
        }
    }

    fn log_constraint(&self, outcome: &T::Outcome) -> Result<LogPotential, ModelError> {
        Ok(self.target.log_constraint(outcome)?.tempered(self.beta)?)
    }

    fn settle(&self, accepted: bool, scratch: &mut T::Scratch) {
        self.target.settle(accepted, scratch);
    }
}

impl<T: Target + 'static> View for Tempered<'_, T> {
    type Seen = T;

    fn seen(&self) -> &T {
        self.target
    }
}

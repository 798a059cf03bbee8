//! A target with a weaker constraint: `p_w · p_c^β`.

use crate::target::{ModelError, Target};
use crate::view::Reweighed;
use plaus_dist::{LogPotential, ParamError};

/// The target `p_w(draw) · p_c(outcome)^β`: for `p_c = λ^k`, the same target at `λ^β`.
///
/// β = 1 is the target itself; β = 0 is the prior restricted to outcomes that the constraint allows (−∞ stays −∞). For
/// the whole prior see [`crate::check::PriorOnly`]. The target's moves can be used through [`crate::view::lend`].
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
}

/// A floor for the constraint itself: a constraint that does not exceed it does not exceed `floor` when raised to the
/// power of `beta`, in floating point. `None` if no constraint can exceed `floor`.
pub(crate) fn floor_seen(floor: LogPotential, beta: f64) -> Option<LogPotential> {
    if beta == 1.0 {
        return Some(floor);
    }
    if beta == 0.0 {
        return (floor < LogPotential::ONE).then_some(LogPotential::ZERO);
    }
    let mut seen = (floor.value() / beta).min(f64::MAX);
    // Multiplication by β rounds monotonically, so if the inequality holds at the floor, it holds for everything below.
    // One or two steps are enough.
    while seen * beta > floor.value() {
        seen = seen.next_down();
    }
    LogPotential::new(seen).ok()
}

impl<T: Target> Reweighed for Tempered<'_, T> {
    type Seen = T;

    fn seen(&self) -> &T {
        self.target
    }

    fn floor_seen(&self, floor: LogPotential) -> Option<LogPotential> {
        floor_seen(floor, self.beta)
    }

    fn weigh(&self, outcome: &T::Outcome) -> Result<LogPotential, ModelError> {
        Ok(self.target.log_constraint(outcome)?.tempered(self.beta)?)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::target::{Simulated, StateRefOf};
    use plaus_dist::{LogDensity, Purpose, Seed, Stream, open_unit};

    /// A target that does nothing but temper.
    struct Nothing;

    impl Target for Nothing {
        type Draw = ();
        type Outcome = f64;
        type Scratch = ();
        fn start(&self, _: &mut Stream) {}
        fn log_prior(&self, (): &()) -> Result<LogDensity, ModelError> {
            Ok(LogDensity::ONE)
        }
        fn simulate(
            &self,
            (): &(),
            _: Option<StateRefOf<'_, Self>>,
            _: LogPotential,
            (): &mut (),
        ) -> Result<Simulated<f64>, ModelError> {
            Ok(Simulated::Complete(0.0))
        }
        fn log_constraint(&self, outcome: &f64) -> Result<LogPotential, ModelError> {
            Ok(LogPotential::new(*outcome)?)
        }
    }

    /// A constraint at the floor that is handed on does not exceed the floor asked for, in floating point. One that is
    /// three units in the last place higher reaches it.
    #[test]
    fn a_floor_handed_on_is_never_too_high_and_hardly_too_low() {
        let mut stream = Seed(1).chain(0).at(0, Purpose(100));
        for _ in 0..100_000 {
            let mut around = |scale: f64| (open_unit(&mut stream) - 0.5) * scale;
            let (floor, beta) = (around(200.0), around(6.0).abs());
            let tempered = Tempered::new(&Nothing, beta).unwrap();
            let seen = floor_seen(LogPotential::new(floor).unwrap(), beta).unwrap().value();
            let weight = |x: f64| tempered.log_constraint(&x).unwrap().value();
            assert!(weight(seen) <= floor, "floor {floor}, beta {beta}");
            let above = (0..3).fold(seen, |x, _| x.next_up());
            assert!(weight(above) >= floor, "floor {floor}, beta {beta}");
        }
    }

    #[test]
    fn floors_at_the_extremes() {
        let floor =
            |beta: f64, floor: f64| floor_seen(LogPotential::new(floor).unwrap(), beta).map(LogPotential::value);
        assert_eq!(floor(0.0, -1.0), Some(f64::NEG_INFINITY));
        assert_eq!(floor(0.0, 0.0), None);
        assert_eq!(floor(1e-300, 1e300), Some(f64::MAX));
        assert_eq!(floor(1e-300, -1e300), Some(f64::NEG_INFINITY));
        assert_eq!(floor(1e300, f64::NEG_INFINITY), Some(f64::NEG_INFINITY));
        assert_eq!(floor(1.0, -3.5), Some(-3.5));
    }
}

//! One event before another.

use crate::require::event::Event;
use crate::require::kinds::Ask;
use crate::require::looks::Looks;
use crate::require::missed::Nat;
use crate::require::place::Place;
use crate::require::probe::Probe;
use crate::require::score::{FAR, Reach};
use crate::scene::ConfigError;
use crate::settings::settings;

settings! {
    /// One event happens, and another does not happen before it.
    pub struct Before {
        /// What comes first, and must come.
        first: Event;
        /// What comes later, if it happens at all.
        then: Event;
        /// How much later, at least.
        by_ms: f64 = 0.0, 0.0..=1e6, "ms";
        /// How many milliseconds too early cost one nat.
        scale_ms: f64 = 20.0, 1e-6..=1e6, "ms";
    }
}

impl Ask for Before {
    fn check(&self, place: &Place<'_>) -> Result<(), ConfigError> {
        self.first.check(&place.at("first"))?;
        self.then.check(&place.at("then"))?;
        if self.first.is_same(&self.then) {
            return Err(place.wrong("an event cannot come before itself"));
        }
        Ok(())
    }

    fn subject(&self) -> Option<&str> {
        None
    }

    fn nat(&self) -> Option<Nat> {
        Some(Nat::of(self.scale_ms, "ms"))
    }

    fn reach(&self, probe: &Probe<'_>) -> Reach {
        let (first, then) = (self.first.time(probe), self.then.time(probe));
        let margin = |first: f64, then: f64| match (first.is_finite(), then.is_finite()) {
            (false, _) => -FAR,
            (true, false) => FAR,
            (true, true) => (then - first - 1e-3 * self.by_ms) / (1e-3 * self.scale_ms),
        };
        Reach::between(margin(first.high, then.low), margin(first.low, then.high))
    }

    fn events(&self) -> Vec<Event> {
        vec![self.first.clone(), self.then.clone()]
    }

    fn looks(&self) -> Looks {
        Looks::default().or_impacts()
    }
}

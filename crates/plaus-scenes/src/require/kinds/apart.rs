//! How far apart in time two events are.

use crate::require::event::Event;
use crate::require::kinds::Ask;
use crate::require::looks::Looks;
use crate::require::missed::Nat;
use crate::require::place::Place;
use crate::require::probe::Probe;
use crate::require::score::{Band, Reach, Span};
use crate::scene::ConfigError;
use crate::settings::settings;

settings! {
    /// Two events happen, and the time between them lies within limits, whichever of them comes first: `at_most_ms`
    /// alone means "together".
    pub struct Apart {
        /// One event.
        one: Event;
        /// The other event.
        other: Event;
        /// The least time between them. Unset: no lower limit.
        #[schemars(extend("x-example" = 500.0))]
        at_least_ms: Option<f64>, 0.0..=1e9, "ms";
        /// The most time between them. Unset: no upper limit.
        #[schemars(extend("x-example" = 20.0))]
        at_most_ms: Option<f64>, 0.0..=1e9, "ms";
        /// How many milliseconds outside the limits cost one nat.
        scale_ms: f64 = 20.0, 1e-6..=1e6, "ms";
    }
}

impl Ask for Apart {
    fn check(&self, place: &Place<'_>) -> Result<(), ConfigError> {
        self.one.check(&place.at("one"))?;
        self.other.check(&place.at("other"))?;
        if self.one.is_same(&self.other) {
            return Err(place.wrong("there is no time between an event and itself"));
        }
        place.limits(self.at_least_ms, self.at_most_ms)
    }

    fn subject(&self) -> Option<&str> {
        None
    }

    fn nat(&self) -> Option<Nat> {
        Some(Nat::of(self.scale_ms, "ms"))
    }

    fn reach(&self, probe: &Probe<'_>) -> Reach {
        let (one, other) = (self.one.time(probe), self.other.time(probe));
        if one.low == f64::INFINITY || other.low == f64::INFINITY {
            return Reach::NEVER;
        }
        let low = (one.low - other.high).max(other.low - one.high).max(0.0);
        let high = (one.high - other.low).max(other.high - one.low);
        let band = Band::of_limits(self.at_least_ms, self.at_most_ms, self.scale_ms);
        band.reach(Span { low: 1e3 * low, high: 1e3 * high })
    }

    fn events(&self) -> Vec<Event> {
        vec![self.one.clone(), self.other.clone()]
    }

    fn looks(&self) -> Looks {
        Looks::default().or_impacts()
    }
}

//! How far apart in time two events are.

use crate::require::event::Event;
use crate::require::kinds::Ask;
use crate::require::looks::Looks;
use crate::require::missed::Nat;
use crate::require::place::Place;
use crate::require::probe::Probe;
use crate::require::score::{Band, Reach, Span};
use crate::scene::ConfigError;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Two events happen, and the time between them lies within limits, whichever of them comes first: `at_most_ms` alone
/// means "together".
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Apart {
    /// One event.
    pub one: Event,
    /// The other event.
    pub other: Event,
    /// The least time between them. Unset: no lower limit.
    #[schemars(extend("minimum" = 0.0, "maximum" = 1e9, "x-unit" = "ms", "x-example" = 500.0))]
    pub at_least_ms: Option<f64>,
    /// The most time between them. Unset: no upper limit.
    #[schemars(extend("minimum" = 0.0, "maximum" = 1e9, "x-unit" = "ms", "x-example" = 20.0))]
    pub at_most_ms: Option<f64>,
    /// How many milliseconds outside the limits cost one nat.
    #[schemars(extend("minimum" = 1e-6, "maximum" = 1e6, "x-unit" = "ms"))]
    pub scale_ms: f64,
}

impl Default for Apart {
    fn default() -> Self {
        let (one, other) = (Event::default(), Event::default());
        Self { one, other, at_least_ms: None, at_most_ms: None, scale_ms: 20.0 }
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

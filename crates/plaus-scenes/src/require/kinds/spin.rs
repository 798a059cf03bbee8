//! How fast a body turns at an impact.

use crate::require::event::{Event, What};
use crate::require::kinds::Ask;
use crate::require::looks::Looks;
use crate::require::missed::Nat;
use crate::require::place::Place;
use crate::require::probe::Probe;
use crate::require::score::{Band, Reach};
use crate::scene::ConfigError;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The angular speed of a body, as it hits something or as it leaves it, lies within limits.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Spin {
    /// Name of a body, or a pattern such as `ball_*` for any matching body. May be left out if there is only one body.
    pub body: String,
    /// What it hits: a body, a part of the scenery, or a pattern; empty: anything.
    pub with: String,
    /// Which of its impacts, counted from 1; −1 is the last, −2 the last but one.
    #[schemars(range(min = -10_000, max = 10_000))]
    pub nth: i32,
    /// Only count impacts at which the two meet at this speed or faster.
    #[schemars(extend("minimum" = 0.0, "maximum" = 1000.0, "x-unit" = "m/s"))]
    pub faster_than: f64,
    /// The least allowed. Unset: no lower limit.
    #[schemars(extend("minimum" = 0.0, "maximum" = 1e6, "x-unit" = "rad/s", "x-example" = 1.0))]
    pub at_least: Option<f64>,
    /// The most allowed. Unset: no upper limit.
    #[schemars(extend("minimum" = 0.0, "maximum" = 1e6, "x-unit" = "rad/s", "x-example" = 1.0))]
    pub at_most: Option<f64>,
    /// Whether the angular speed after the impact counts, instead of the one before it.
    pub after: bool,
    /// How far outside the limits costs one nat.
    #[schemars(extend("minimum" = 1e-9, "maximum" = 1e6, "x-unit" = "rad/s"))]
    pub scale: f64,
}

impl Default for Spin {
    fn default() -> Self {
        let Event { body, with, nth, faster_than, .. } = Event::default();
        Self { body, with, nth, faster_than, at_least: None, at_most: None, after: false, scale: 2.0 }
    }
}

impl Spin {
    fn event(&self) -> Event {
        let Self { body, with, nth, faster_than, .. } = self.clone();
        Event { body, what: What::Impact, with, nth, faster_than }
    }

    fn band(&self) -> Band {
        Band::of_limits(self.at_least, self.at_most, self.scale)
    }
}

impl Ask for Spin {
    fn check(&self, place: &Place<'_>) -> Result<(), ConfigError> {
        place.turned()?;
        self.event().check(place)?;
        place.limits(self.at_least, self.at_most)
    }

    fn subject(&self) -> Option<&str> {
        Some(&self.body)
    }

    fn nat(&self) -> Option<Nat> {
        Some(Nat::of(self.scale, "rad/s"))
    }

    fn reach(&self, probe: &Probe<'_>) -> Reach {
        let probe = probe.turned();
        self.event().measured(&probe, &self.band(), |hit| {
            let track = probe.party(hit, &self.body)?;
            Some(probe.at_hit(track, hit.time, self.after)?.spin.length())
        })
    }

    fn events(&self) -> Vec<Event> {
        vec![self.event()]
    }

    fn looks(&self) -> Looks {
        Looks::default().or_impacts()
    }
}

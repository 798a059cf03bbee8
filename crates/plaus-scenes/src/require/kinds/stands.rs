//! A body that stands.

use crate::require::kinds::Ask;
use crate::require::kinds::faces_up::tilt;
use crate::require::looks::Looks;
use crate::require::missed::Nat;
use crate::require::place::Place;
use crate::require::probe::Probe;
use crate::require::score::Reach;
use crate::require::when::When;
use crate::scene::ConfigError;
use glam::DVec3;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A body stands: its third axis is nearly upright, at the end or at some time. For a body that has fallen, use `not`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Stands {
    /// Name of a body. May be left out if there is only one.
    pub body: String,
    /// A body that leans farther than this has fallen.
    #[schemars(extend("minimum" = 0.1, "maximum" = 180.0, "x-unit" = "degree"))]
    pub within_deg: f64,
    /// How many degrees beyond that cost one nat.
    #[schemars(extend("minimum" = 1e-3, "maximum" = 1e4, "x-unit" = "degree"))]
    pub scale_deg: f64,
    /// At which time: `at_s`, `frame` or `from_s`. Unset: at the end.
    pub when: When,
}

impl Default for Stands {
    fn default() -> Self {
        Self { body: String::new(), within_deg: 45.0, scale_deg: 10.0, when: When::default() }
    }
}

impl Ask for Stands {
    fn check(&self, place: &Place<'_>) -> Result<(), ConfigError> {
        place.turned()?;
        place.one_body("body", &self.body)?;
        self.when.check(place)
    }

    fn subject(&self) -> Option<&str> {
        Some(&self.body)
    }

    fn nat(&self) -> Option<Nat> {
        Some(Nat::of(self.scale_deg, "degrees"))
    }

    fn reach(&self, probe: &Probe<'_>) -> Reach {
        let probe = probe.turned();
        let margin = |angle: f64| (self.within_deg - angle) / self.scale_deg;
        let Some(time) = probe.moment(self.when.instant()) else { return Reach::between(margin(180.0), margin(0.0)) };
        let angle = probe.track(&self.body).map(|track| tilt(track, DVec3::Z, time));
        angle.map_or(Reach::NEVER, |angle| Reach::certain(margin(angle)))
    }

    fn looks(&self) -> Looks {
        Looks::at(self.when.instant())
    }
}

//! An impact within a window of time.

use crate::require::claim::Claim;
use crate::require::event::{Event, What};
use crate::require::kinds::Ask;
use crate::require::looks::Looks;
use crate::require::missed::Nat;
use crate::require::place::Place;
use crate::require::probe::Probe;
use crate::require::score::Reach;
use crate::require::timed::Timed;
use crate::require::when::When;
use crate::scene::ConfigError;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A chosen impact of a body happens within a window of time: the first, the last, or another.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Impact {
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
    /// The window of time in which it must happen.
    pub when: When,
}

impl Default for Impact {
    fn default() -> Self {
        let Event { body, with, nth, faster_than, .. } = Event::default();
        Self { body, with, nth, faster_than, when: When::default() }
    }
}

impl Impact {
    fn event(&self) -> Event {
        let Self { body, with, nth, faster_than, .. } = self.clone();
        Event { body, what: What::Impact, with, nth, faster_than }
    }
}

impl Ask for Impact {
    fn check(&self, place: &Place<'_>) -> Result<(), ConfigError> {
        self.event().check(place)?;
        self.when.check(place)
    }

    fn subject(&self) -> Option<&str> {
        Some(&self.body)
    }

    fn nat(&self) -> Option<Nat> {
        Some(self.when.nat())
    }

    fn reach(&self, probe: &Probe<'_>) -> Reach {
        self.when.band().reach(self.event().time(probe))
    }

    fn times(&self, probe: &Probe<'_>) -> Vec<Timed> {
        vec![Timed::of_event(&self.event(), &self.when, probe)]
    }

    fn looks(&self) -> Looks {
        Looks::after(self.when.window()).or_impacts()
    }

    fn claims(&self) -> Vec<Claim> {
        vec![Claim::time(self.event(), self.when.window())]
    }
}

//! Falling within a window of time.

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
use crate::settings::settings;

settings! {
    /// A body falls within a window of time: its third axis, upright at first, leans too far.
    pub struct Falls {
        /// Name of a body, or a pattern such as `domino_*` for the last of the matching bodies. May be left out if
        /// there is only one body.
        body: String;
        /// A body that leans farther than this has fallen.
        fallen_deg: f64 = 45.0, 0.1..=179.0, "degree";
        /// The window of time in which it must fall.
        when: When;
    }
}

impl Falls {
    fn event(&self) -> Event {
        let Self { body, fallen_deg, .. } = self.clone();
        Event { body, what: What::Fall, fallen_deg, ..Event::default() }
    }
}

impl Ask for Falls {
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

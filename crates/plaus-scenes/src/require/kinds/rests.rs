//! Coming to rest within a window of time.

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
    /// A body comes to rest within a window of time: `to_s` alone means "by then", `from_s` alone "not before".
    pub struct Rests {
        /// Name of a body, or a pattern such as `ball_*` for the last of the matching bodies. May be left out if there
        /// is only one body.
        body: String;
        /// The window of time in which it must come to rest.
        when: When;
    }
}

impl Rests {
    fn event(&self) -> Event {
        Event { body: self.body.clone(), what: What::Rest, ..Event::default() }
    }
}

impl Ask for Rests {
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
        Looks::after(self.when.window())
    }

    fn claims(&self) -> Vec<Claim> {
        vec![Claim::time(self.event(), self.when.window())]
    }
}

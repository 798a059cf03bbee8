//! An impact within a window of time.

use crate::require::claim::Claim;
use crate::require::event::of_impact;
use crate::require::kinds::Ask;
use crate::require::looks::Looks;
use crate::require::missed::Nat;
use crate::require::place::Place;
use crate::require::probe::Probe;
use crate::require::score::Reach;
use crate::require::timed::Timed;
use crate::require::when::When;
use crate::scene::ConfigError;

of_impact! {
    /// A chosen impact of a body happens within a window of time: the first, the last, or another.
    pub struct Impact {
        /// The window of time in which it must happen.
        when: When;
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

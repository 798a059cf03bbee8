//! A body that stands.

use super::points::Points;
use crate::require::aim::Aim;
use crate::require::claim::Claim;
use crate::require::kinds::Ask;
use crate::require::looks::Looks;
use crate::require::missed::Nat;
use crate::require::place::Place;
use crate::require::probe::Probe;
use crate::require::score::Reach;
use crate::require::sides::Axis;
use crate::require::when::When;
use crate::scene::ConfigError;
use crate::settings::settings;

settings! {
    /// A body stands: its third axis is nearly upright, at the end or at some time. For a body that has fallen, use
    /// `not`.
    pub struct Stands {
        /// Name of a body. May be left out if there is only one.
        body: String;
        /// A body that leans farther than this has fallen.
        within_deg: f64 = 45.0, 0.1..=180.0, "degree";
        /// How many degrees beyond that cost one nat.
        scale_deg: f64 = 10.0, 1e-3..=1e4, "degree";
        /// At which time: `at_s`, `frame` or `from_s`. Unset: at the end.
        when: When;
    }
}

impl Stands {
    /// Its third axis points up.
    fn points(&self) -> Points {
        let Self { body, within_deg, scale_deg, when } = self.clone();
        Points { body, axis: Axis::Z, within_deg, scale_deg, when, toward: Points::UP, ..Points::default() }
    }
}

impl Ask for Stands {
    fn check(&self, place: &Place<'_>) -> Result<(), ConfigError> {
        self.points().check(place)
    }

    fn subject(&self) -> Option<&str> {
        Some(&self.body)
    }

    fn nat(&self) -> Option<Nat> {
        Some(Nat::of(self.scale_deg, "degrees"))
    }

    fn reach(&self, probe: &Probe<'_>) -> Reach {
        self.points().reach(probe)
    }

    fn looks(&self) -> Looks {
        Looks::at(self.when.instant())
    }

    fn claims(&self) -> Vec<Claim> {
        self.points().claims()
    }

    fn aims(&self) -> Vec<Aim> {
        self.points().aims()
    }
}

//! Which face, or axis, of a body is up.

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
    /// A face of a die, or an axis of a body, points up: at the end, or at some time.
    pub struct FacesUp {
        /// Name of a body. May be left out if there is only one.
        body: String;
        /// Which face, for a die or a body with marked `faces`: the one that counts, which of a die with 4 faces lies
        /// below. Unset: `axis` is used.
        #[schemars(extend("x-example" = 6))]
        face: Option<u32>, 1..=100;
        /// Which axis of the body.
        axis: Axis = Axis::Z;
        /// How far from upright it may be.
        within_deg: f64 = 20.0, 0.1..=180.0, "degree";
        /// How many degrees beyond that cost one nat.
        scale_deg: f64 = 10.0, 1e-3..=1e4, "degree";
        /// At which time: `at_s`, `frame` or `from_s`. Unset: at the end.
        when: When;
    }
}

impl FacesUp {
    /// The face or axis points up.
    fn points(&self) -> Points {
        let Self { body, face, axis, within_deg, scale_deg, when } = self.clone();
        Points { body, face, axis, within_deg, scale_deg, when, toward: Points::UP }
    }
}

impl Ask for FacesUp {
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

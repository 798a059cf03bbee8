//! How long a body's path is.

use crate::require::kinds::Ask;
use crate::require::looks::Looks;
use crate::require::missed::Nat;
use crate::require::place::Place;
use crate::require::probe::Probe;
use crate::require::score::{Band, Reach, Span};
use crate::require::ways;
use crate::require::when::When;
use crate::scene::ConfigError;
use crate::settings::settings;

settings! {
    /// The length of a body's path lies within limits.
    pub struct PathLength {
        /// Name of a body. May be left out if there is only one.
        body: String;
        /// The least allowed. Unset: no lower limit.
        #[schemars(extend("x-example" = 500.0))]
        at_least_mm: Option<f64>, 0.0..=1e9, "mm";
        /// The most allowed. Unset: no upper limit.
        #[schemars(extend("x-example" = 500.0))]
        at_most_mm: Option<f64>, 0.0..=1e9, "mm";
        /// How many millimetres outside cost one nat.
        scale_mm: f64 = 20.0, 1e-6..=1e9, "mm";
        /// Only this window counts.
        when: When;
    }
}

impl Ask for PathLength {
    fn check(&self, place: &Place<'_>) -> Result<(), ConfigError> {
        place.one_body("body", &self.body)?;
        self.when.check(place)?;
        place.limits(self.at_least_mm, self.at_most_mm)
    }

    fn subject(&self) -> Option<&str> {
        Some(&self.body)
    }

    fn nat(&self) -> Option<Nat> {
        Some(Nat::of(self.scale_mm, "mm"))
    }

    fn reach(&self, probe: &Probe<'_>) -> Reach {
        let window = self.when.window();
        let so_far: f64 = 1e3 * probe.legs(&self.body, window).iter().map(ways::Leg::path_length).sum::<f64>();
        let high = if probe.sees_all(window) { so_far } else { f64::MAX };
        let band = Band::of_limits(self.at_least_mm, self.at_most_mm, 1.0 * self.scale_mm);
        band.reach(Span { low: so_far, high })
    }

    fn looks(&self) -> Looks {
        Looks::after(self.when.window()).or_impacts()
    }
}

//! How long a body is in flight.

use crate::require::kinds::Ask;
use crate::require::looks::Looks;
use crate::require::missed::Nat;
use crate::require::place::Place;
use crate::require::probe::Probe;
use crate::require::score::{Band, Reach, Span};
use crate::require::when::When;
use crate::scene::ConfigError;
use crate::settings::settings;

settings! {
    /// The total time that a body is in flight, under gravity alone, lies within limits.
    pub struct AirTime {
        /// Name of a body. May be left out if there is only one.
        body: String;
        /// The least allowed. Unset: no lower limit.
        #[schemars(extend("x-example" = 0.5))]
        at_least_s: Option<f64>, 0.0..=3600.0, "s";
        /// The most allowed. Unset: no upper limit.
        #[schemars(extend("x-example" = 0.5))]
        at_most_s: Option<f64>, 0.0..=3600.0, "s";
        /// How many milliseconds outside the limits cost one nat.
        scale_ms: f64 = 20.0, 1e-6..=1e9, "ms";
        /// Only this window counts.
        when: When;
    }
}

impl Ask for AirTime {
    fn check(&self, place: &Place<'_>) -> Result<(), ConfigError> {
        place.one_body("body", &self.body)?;
        self.when.check(place)?;
        place.limits(self.at_least_s, self.at_most_s)
    }

    fn subject(&self) -> Option<&str> {
        Some(&self.body)
    }

    fn nat(&self) -> Option<Nat> {
        Some(Nat::of(self.scale_ms, "ms"))
    }

    fn reach(&self, probe: &Probe<'_>) -> Reach {
        let window = self.when.window();
        let so_far: f64 =
            probe.legs(&self.body, window).iter().filter(|leg| leg.is_flight()).map(|leg| leg.length).sum();
        let high = if probe.sees_all(window) { so_far } else { f64::MAX };
        let band = Band::of_limits(self.at_least_s, self.at_most_s, 1e-3 * self.scale_ms);
        band.reach(Span { low: so_far, high })
    }

    fn looks(&self) -> Looks {
        Looks::after(self.when.window()).or_impacts()
    }
}

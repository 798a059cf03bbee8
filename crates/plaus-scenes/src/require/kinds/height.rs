//! How high a body comes.

use crate::require::extreme::Extreme;
use crate::require::kinds::Ask;
use crate::require::looks::Looks;
use crate::require::missed::Nat;
use crate::require::place::Place;
use crate::require::probe::Probe;
use crate::require::score::{Band, Reach};
use crate::require::when::When;
use crate::scene::ConfigError;
use crate::settings::settings;

settings! {
    /// The height of a body's middle lies within limits: the greatest on its way, or the least.
    pub struct Height {
        /// Name of a body. May be left out if there is only one.
        body: String;
        /// The least allowed. Unset: no lower limit.
        #[schemars(extend("x-example" = 300.0))]
        at_least_mm: Option<f64>, -1e6..=1e6, "mm";
        /// The most allowed. Unset: no upper limit.
        #[schemars(extend("x-example" = 320.0))]
        at_most_mm: Option<f64>, -1e6..=1e6, "mm";
        /// Whether the greatest height counts or the least.
        which: Extreme;
        /// How many millimetres outside the limits cost one nat.
        scale_mm: f64 = 5.0, 1e-6..=1e6, "mm";
        /// At this time (`at_s`, `frame`), or in this window (`from_s`, `to_s`). Unset: at any time.
        when: When;
    }
}

impl Ask for Height {
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
        let band = Band::of_limits(self.at_least_mm, self.at_most_mm, self.scale_mm);
        let about = (self.body.as_str(), &self.when);
        self.which.reach(probe, about, (&band, -f64::MAX), |leg| leg.heights().map(|z| 1e3 * z))
    }

    fn looks(&self) -> Looks {
        Looks::after(self.when.moments()).or_impacts()
    }
}

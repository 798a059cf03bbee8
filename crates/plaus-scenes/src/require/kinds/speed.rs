//! How fast a body is at an impact.

use crate::require::event::{Event, of_impact};
use crate::require::kinds::Ask;
use crate::require::looks::Looks;
use crate::require::missed::Nat;
use crate::require::place::Place;
use crate::require::probe::Probe;
use crate::require::score::{Band, Reach};
use crate::scene::ConfigError;

of_impact! {
    /// The speed of a body, as it hits something or as it leaves it, lies within limits.
    pub struct Speed {
        /// The least allowed. Unset: no lower limit.
        #[schemars(extend("x-example" = 1.0))]
        at_least: Option<f64>, 0.0..=1e6, "m/s";
        /// The most allowed. Unset: no upper limit.
        #[schemars(extend("x-example" = 1.0))]
        at_most: Option<f64>, 0.0..=1e6, "m/s";
        /// Whether the speed after the impact counts, instead of the one before it.
        after: bool;
        /// How far outside the limits costs one nat.
        scale: f64 = 0.1, 1e-9..=1e6, "m/s";
    }
}

impl Speed {
    fn band(&self) -> Band {
        Band::of_limits(self.at_least, self.at_most, self.scale)
    }
}

impl Ask for Speed {
    fn check(&self, place: &Place<'_>) -> Result<(), ConfigError> {
        self.event().check(place)?;
        place.limits(self.at_least, self.at_most)
    }

    fn subject(&self) -> Option<&str> {
        Some(&self.body)
    }

    fn nat(&self) -> Option<Nat> {
        Some(Nat::of(self.scale, "m/s"))
    }

    fn reach(&self, probe: &Probe<'_>) -> Reach {
        self.event().measured(probe, &self.band(), |hit| {
            let track = probe.party(hit, &self.body)?;
            Some(probe.at_hit(track, hit.time, self.after)?.velocity.length())
        })
    }

    fn events(&self) -> Vec<Event> {
        vec![self.event()]
    }

    fn looks(&self) -> Looks {
        Looks::default().or_impacts()
    }
}

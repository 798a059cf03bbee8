//! How hard a body hits something.

use crate::require::event::{Event, of_impact};
use crate::require::kinds::Ask;
use crate::require::looks::Looks;
use crate::require::missed::Nat;
use crate::require::place::Place;
use crate::require::probe::Probe;
use crate::require::score::{Band, Reach};
use crate::scene::ConfigError;

of_impact! {
    /// The impulse of an impact lies within limits.
    pub struct Impulse {
        /// The least allowed. Unset: no lower limit.
        #[schemars(extend("x-example" = 0.01))]
        at_least: Option<f64>, 0.0..=1e6, "N·s";
        /// The most allowed. Unset: no upper limit.
        #[schemars(extend("x-example" = 0.01))]
        at_most: Option<f64>, 0.0..=1e6, "N·s";
        /// How far outside costs one nat, as a part of the limit: 0.1 is a tenth.
        scale: f64 = 0.1, 1e-6..=1e3;
    }
}

impl Impulse {
    fn band(&self) -> Band {
        let limit = self.at_most.or(self.at_least).filter(|limit| *limit > 0.0).unwrap_or(1.0);
        Band::of_limits(self.at_least, self.at_most, self.scale * limit)
    }
}

impl Ask for Impulse {
    fn check(&self, place: &Place<'_>) -> Result<(), ConfigError> {
        self.event().check(place)?;
        place.limits(self.at_least, self.at_most)
    }

    fn subject(&self) -> Option<&str> {
        Some(&self.body)
    }

    fn nat(&self) -> Option<Nat> {
        Some(Nat::of(self.band().scale, "N s"))
    }

    fn reach(&self, probe: &Probe<'_>) -> Reach {
        self.event().measured(probe, &self.band(), |hit| Some(hit.impulse))
    }

    fn events(&self) -> Vec<Event> {
        vec![self.event()]
    }

    fn looks(&self) -> Looks {
        Looks::default().or_impacts()
    }
}

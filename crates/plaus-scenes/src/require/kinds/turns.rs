//! How many turns a body makes.

use crate::require::kinds::Ask;
use crate::require::looks::Looks;
use crate::require::missed::Nat;
use crate::require::place::Place;
use crate::require::probe::Probe;
use crate::require::score::{Band, Reach, Span};
use crate::require::when::When;
use crate::scene::ConfigError;
use crate::settings::settings;
use glam::DVec3;
use std::f64::consts::TAU;

settings! {
    /// The number of turns that a body makes lies within limits.
    pub struct Turns {
        /// Name of a body. May be left out if there is only one.
        body: String;
        /// The least allowed. Unset: no lower limit.
        #[schemars(extend("x-example" = 1.5))]
        at_least: Option<f64>, -1e6..=1e6;
        /// The most allowed. Unset: no upper limit.
        #[schemars(extend("x-example" = 2.5))]
        at_most: Option<f64>, -1e6..=1e6;
        /// Only turns about this direction of the scenario's axes count: anticlockwise for one who looks against it;
        /// clockwise ones are subtracted. Unset: all turns, whatever their axis.
        #[schemars(extend("x-example" = [0.0, 0.0, 1.0]))]
        about: Option<[f64; 3]>;
        /// How many turns outside the limits cost one nat.
        scale: f64 = 0.1, 1e-6..=1e6;
        /// Only this window counts.
        when: When;
    }
}

impl Ask for Turns {
    fn check(&self, place: &Place<'_>) -> Result<(), ConfigError> {
        place.one_body("body", &self.body)?;
        place.turned()?;
        self.about.map_or(Ok(()), |about| place.direction("about", about))?;
        self.when.check(place)?;
        place.limits(self.at_least, self.at_most)
    }

    fn subject(&self) -> Option<&str> {
        Some(&self.body)
    }

    fn nat(&self) -> Option<Nat> {
        Some(Nat::of(self.scale, "turns"))
    }

    fn reach(&self, probe: &Probe<'_>) -> Reach {
        let (probe, window) = (probe.turned(), self.when.window());
        let band = Band::of_limits(self.at_least, self.at_most, self.scale);
        let legs = probe.legs(&self.body, window);
        let whole = probe.sees_all(window);
        band.reach(match self.about {
            None => {
                let so_far = legs.iter().map(|leg| leg.spin() * leg.length).sum::<f64>() / TAU;
                Span { low: so_far, high: if whole { so_far } else { f64::MAX } }
            }
            // They may all be taken back.
            Some(_) if !whole => Span { low: -f64::MAX, high: f64::MAX },
            Some(about) => {
                let turned: DVec3 = legs.iter().map(|leg| leg.turned()).sum();
                Span::at(turned.dot(DVec3::from_array(about).normalize_or_zero()) / TAU)
            }
        })
    }

    fn looks(&self) -> Looks {
        Looks::after(self.when.window()).or_impacts()
    }
}

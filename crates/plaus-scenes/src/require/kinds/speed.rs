//! How fast a body is at an impact.

use crate::require::event::{Event, of_impact};
use crate::require::extreme::Extreme;
use crate::require::kinds::Ask;
use crate::require::looks::Looks;
use crate::require::missed::Nat;
use crate::require::place::Place;
use crate::require::probe::Probe;
use crate::require::score::{Band, Reach};
use crate::require::ways::Leg;
use crate::require::when::When;
use crate::scene::ConfigError;

of_impact! {
    /// The speed of a body's middle lies within limits: as it hits something, as it leaves it, or in a window of time.
    pub struct Speed {
        /// The least allowed. Unset: no lower limit.
        #[schemars(extend("x-example" = 1.0))]
        at_least: Option<f64>, 0.0..=1e6, "m/s";
        /// The most allowed. Unset: no upper limit.
        #[schemars(extend("x-example" = 1.0))]
        at_most: Option<f64>, 0.0..=1e6, "m/s";
        /// Whether the speed after the impact counts, instead of the one before it.
        after: bool;
        /// At this time (`at_s`, `frame`), or in this window (`from_s`, `to_s`), instead of at an impact.
        when: When;
        /// Of a window: whether the greatest counts or the least.
        which: Extreme;
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
        let of_impact = self.event() != Event { body: self.body.clone(), ..Event::default() } || self.after;
        self.which.check(place, (&self.body, &self.when), of_impact)?;
        place.limits(self.at_least, self.at_most)
    }

    fn subject(&self) -> Option<&str> {
        Some(&self.body)
    }

    fn nat(&self) -> Option<Nat> {
        Some(Nat::of(self.scale, "m/s"))
    }

    fn reach(&self, probe: &Probe<'_>) -> Reach {
        if self.when.is_set() {
            let about = (self.body.as_str(), &self.when);
            return self.which.reach(probe, about, (&self.band(), 0.0), Leg::speeds);
        }
        self.event().measured(probe, &self.band(), |hit| {
            let track = probe.party(hit, &self.body)?;
            Some(probe.at_hit(track, hit.time, self.after)?.velocity.length())
        })
    }

    fn events(&self) -> Vec<Event> {
        if self.when.is_set() { Vec::new() } else { vec![self.event()] }
    }

    fn looks(&self) -> Looks {
        Looks::after(self.when.moments()).or_impacts()
    }
}

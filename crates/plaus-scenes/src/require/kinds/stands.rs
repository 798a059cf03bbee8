//! A body that stands.

use crate::require::aim::{Aim, End, Up};
use crate::require::kinds::Ask;
use crate::require::kinds::faces_up::tilt;
use crate::require::looks::Looks;
use crate::require::missed::Nat;
use crate::require::place::Place;
use crate::require::probe::Probe;
use crate::require::score::Reach;
use crate::require::when::When;
use crate::scene::ConfigError;
use crate::settings::settings;
use glam::DVec3;

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

impl Ask for Stands {
    fn check(&self, place: &Place<'_>) -> Result<(), ConfigError> {
        place.turned()?;
        place.one_body("body", &self.body)?;
        self.when.check(place)
    }

    fn subject(&self) -> Option<&str> {
        Some(&self.body)
    }

    fn nat(&self) -> Option<Nat> {
        Some(Nat::of(self.scale_deg, "degrees"))
    }

    fn reach(&self, probe: &Probe<'_>) -> Reach {
        let probe = probe.turned();
        let margin = |angle: f64| (self.within_deg - angle) / self.scale_deg;
        let Some(time) = probe.moment(self.when.instant()) else { return Reach::between(margin(180.0), margin(0.0)) };
        let angle = probe.track(&self.body).map(|track| tilt(track, DVec3::Z, time));
        angle.map_or(Reach::NEVER, |angle| Reach::certain(margin(angle)))
    }

    fn looks(&self) -> Looks {
        Looks::at(self.when.instant())
    }

    fn aims(&self) -> Vec<Aim> {
        let up = Up { axis: DVec3::Z, within: self.within_deg, scale: self.scale_deg };
        let is_at_end = self.when.instant().is_none();
        is_at_end.then(|| Aim { body: self.body.clone(), end: End::Up(up) }).into_iter().collect()
    }
}

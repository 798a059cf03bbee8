//! Where a body comes to rest.

use crate::require::aim::{Aim, End, Zone};
use crate::require::claim::Claim;
use crate::require::event::{Event, What};
use crate::require::kinds::Ask;
use crate::require::missed::Nat;
use crate::require::place::Place;
use crate::require::probe::Probe;
use crate::require::score::Reach;
use crate::require::spot::Spot;
use crate::require::ways::level;
use crate::scene::ConfigError;
use crate::settings::settings;
use glam::DVec3;

settings! {
    /// A body comes to rest with its middle near a place.
    pub struct RestsAt {
        /// Name of a body. May be left out if there is only one.
        body: String;
        /// The place along x.
        x_mm: f64 = 0.0, -1e6..=1e6, "mm";
        /// The place along y.
        y_mm: f64 = 0.0, -1e6..=1e6, "mm";
        /// The height. Unset: any.
        #[schemars(extend("x-example" = 8.0))]
        z_mm: Option<f64>, -1e6..=1e6, "mm";
        /// A body that rests closer than this meets the requirement.
        within_mm: f64 = 10.0, 1e-3..=1e6, "mm";
        /// How many millimetres farther away cost one nat.
        scale_mm: f64 = 5.0, 1e-6..=1e6, "mm";
    }
}

impl Ask for RestsAt {
    fn check(&self, place: &Place<'_>) -> Result<(), ConfigError> {
        place.one_body("body", &self.body)
    }

    fn subject(&self) -> Option<&str> {
        Some(&self.body)
    }

    fn nat(&self) -> Option<Nat> {
        Some(Nat::of(self.scale_mm, "mm"))
    }

    fn reach(&self, probe: &Probe<'_>) -> Reach {
        let margin = |off: f64| (self.within_mm - off) / self.scale_mm;
        if !probe.is_whole() {
            return Reach::up_to(margin(0.0));
        }
        let last = probe.track(&self.body).and_then(|track| track.pieces.last()).filter(|piece| piece.rests());
        let Some(last) = last else { return Reach::NEVER };
        let at = 1e3 * level(last.position);
        let off = at - DVec3::new(self.x_mm, self.y_mm, self.z_mm.unwrap_or(at.z));
        Reach::certain(margin(off.length()))
    }

    fn events(&self) -> Vec<Event> {
        vec![Event { body: self.body.clone(), what: What::Rest, ..Event::default() }]
    }

    fn spots(&self) -> Vec<Spot> {
        vec![Spot { at_mm: [self.x_mm, self.y_mm, self.z_mm.unwrap_or(0.0)], within_mm: self.within_mm }]
    }

    fn claims(&self) -> Vec<Claim> {
        let at = [Some(self.x_mm), Some(self.y_mm), self.z_mm];
        vec![Claim::Place { body: self.body.clone(), at, within: self.within_mm }]
    }

    fn aims(&self) -> Vec<Aim> {
        let zone = Zone::Disc { centre: [self.x_mm, self.y_mm], radius: self.within_mm, scale: self.scale_mm };
        vec![Aim { body: self.body.clone(), end: End::In(zone, true) }]
    }
}

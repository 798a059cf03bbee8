//! What a body lies on.

use crate::require::cast::matches;
use crate::require::event::{Event, What};
use crate::require::kinds::Ask;
use crate::require::looks::Looks;
use crate::require::missed::Nat;
use crate::require::place::Place;
use crate::require::probe::Probe;
use crate::require::score::Reach;
use crate::scene::ConfigError;
use crate::settings::settings;
use glam::DVec3;
use plaus_animation::Contact;

/// Height of a unit normal up to which what a body touches is a wall, on which it leans at most. Default 0.01: half a
/// degree, far above rounding.
const STEEPEST: f64 = 0.01;

settings! {
    /// A body lies on another, or on a part of the scenery, at the end of the motion: on all that bears it up, not on
    /// a wall that it leans on. If nothing bears it, or the scene does not tell what does, on what it touched last.
    pub struct RestsOn {
        /// Name of a body. May be left out if there is only one.
        body: String;
        /// What it lies on: a body, a part of the scenery, or a pattern.
        on: String;
        /// What it costs to lie on something else.
        nats: f64 = 2.0, 1e-3..=1000.0, "nat";
    }
}

impl Ask for RestsOn {
    fn check(&self, place: &Place<'_>) -> Result<(), ConfigError> {
        place.one_body("body", &self.body)?;
        if self.on.is_empty() {
            return Err(place.at("on").wrong("on what?"));
        }
        place.partner("on", &self.on)
    }

    fn subject(&self) -> Option<&str> {
        Some(&self.body)
    }

    fn nat(&self) -> Option<Nat> {
        Some(Nat::YES_OR_NO)
    }

    fn reach(&self, probe: &Probe<'_>) -> Reach {
        if !probe.is_whole() {
            return Reach::between(-self.nats, self.nats);
        }
        let body = probe.name(&self.body);
        let other = |one: &'_ str, other: &'_ str| if one == body { other.to_owned() } else { one.to_owned() };
        let motion = probe.motion();
        let mut at_end = motion.contacts.iter().filter(|contact| {
            contact.involves(body) && probe.lasts_until(contact) == f64::INFINITY && contact.normal != DVec3::ZERO
        });
        let bears = |contact: &Contact| {
            let up = if contact.body == body { contact.normal.y } else { -contact.normal.y };
            up > STEEPEST && matches(&self.on, &other(&contact.body, &contact.other))
        };
        if at_end.clone().next().is_some() {
            return Reach::certain(if at_end.any(bears) { self.nats } else { -self.nats });
        }
        let hit = motion.impacts.iter().rev().find(|hit| hit.involves(body));
        let hit = hit.map(|hit| (hit.time, other(&hit.body, &hit.other)));
        let contact = motion.contacts.iter().filter(|contact| contact.involves(body));
        let contact = contact.max_by(|a, b| a.end.total_cmp(&b.end));
        let contact = contact.map(|contact| (contact.end, other(&contact.body, &contact.other)));
        let last = hit.into_iter().chain(contact).max_by(|a, b| a.0.total_cmp(&b.0));
        let met = last.is_some_and(|(_, name)| matches(&self.on, &name));
        Reach::certain(if met { self.nats } else { -self.nats })
    }

    fn looks(&self) -> Looks {
        Looks::default().and_contacts()
    }

    fn events(&self) -> Vec<Event> {
        vec![Event { body: self.body.clone(), what: What::Rest, ..Event::default() }]
    }
}

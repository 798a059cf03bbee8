//! What a body lies on.

use crate::require::cast::matches;
use crate::require::event::{Event, What};
use crate::require::kinds::Ask;
use crate::require::missed::Nat;
use crate::require::place::Place;
use crate::require::probe::Probe;
use crate::require::score::Reach;
use crate::scene::ConfigError;
use crate::settings::settings;

settings! {
    /// A body lies on another, or on a part of the scenery: on what it touched last before it came to rest, according
    /// to the motion's impacts and contacts.
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
        let hit = motion.impacts.iter().rev().find(|hit| hit.involves(body));
        let hit = hit.map(|hit| (hit.time, other(&hit.body, &hit.other)));
        let contact = motion.contacts.iter().filter(|contact| contact.involves(body));
        let contact = contact.max_by(|a, b| a.end.total_cmp(&b.end));
        let contact = contact.map(|contact| (contact.end, other(&contact.body, &contact.other)));
        let last = hit.into_iter().chain(contact).max_by(|a, b| a.0.total_cmp(&b.0));
        let met = last.is_some_and(|(_, name)| matches(&self.on, &name));
        Reach::certain(if met { self.nats } else { -self.nats })
    }

    fn events(&self) -> Vec<Event> {
        vec![Event { body: self.body.clone(), what: What::Rest, ..Event::default() }]
    }
}

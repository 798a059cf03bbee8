//! The materials of things, and of pairs of them.

use super::contact::Contact;
use super::numbers::{number, quoted};
use super::things::{Role, Things};
use std::collections::BTreeMap;
use std::fmt::Write;

/// A material of the scenario.
struct Known {
    name: String,
    said: String,
    contact: Option<Contact>,
}

impl Things<'_> {
    /// Materials of things of which the file says what they weigh or how they touch, and their names: things of which
    /// it says the same have one. Then what pairs of them have.
    pub(super) fn materials(&self) -> (String, BTreeMap<usize, String>) {
        let (mut text, mut names) = (String::new(), BTreeMap::new());
        let mut known: Vec<Known> = Vec::new();
        // Where some have rules, what has none touches them by theirs.
        let has_rules = self.all.iter().any(|thing| thing.contact.is_some());
        for (index, thing) in self.all.iter().enumerate().filter(|(_, thing)| thing.role != Role::Gone) {
            let contact = thing.contact.or(has_rules.then_some(Contact::USUAL));
            let density = self.density(thing);
            if density.is_none() && contact.is_none() {
                continue;
            }
            let mut said = density.map_or_else(String::new, |density| format!("density = {}\n", number(density)));
            if let Some(Contact { values: [friction, restitution], .. }) = contact {
                let _ = write!(said, "friction = {}\nrestitution = {}\n", number(friction), number(restitution));
            }
            let name = match known.iter().find(|one| one.said == said && one.contact == contact) {
                Some(one) => one.name.clone(),
                None => {
                    let name = format!("of_{}", thing.name);
                    let _ = write!(text, "\n[[world.custom.materials]]\nname = {}\n{said}", quoted(&name));
                    known.push(Known { name: name.clone(), said, contact });
                    name
                }
            };
            names.insert(index, name);
        }
        for (index, one) in known.iter().enumerate() {
            for other in &known[..=index] {
                let (Some(a), Some(b)) = (one.contact, other.contact) else { continue };
                let values = a.between(&b);
                if values == [None; 2] {
                    continue;
                }
                let two = [other, one].map(|one| quoted(&one.name)).join(", ");
                let _ = write!(text, "\n[[world.custom.pairs]]\nbetween = [{two}]\n");
                for (key, value) in ["friction", "restitution"].into_iter().zip(values) {
                    if let Some(value) = value {
                        let _ = writeln!(text, "{key} = {}", number(value));
                    }
                }
            }
        }
        (text, names)
    }
}

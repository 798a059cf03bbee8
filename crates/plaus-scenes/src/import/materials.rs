//! The materials of things, and of pairs of them.

use super::contact::Contact;
use super::numbers::{number, plain_name, quoted};
use super::things::{Role, Things};
use std::collections::BTreeMap;
use std::fmt::Write;

/// Resistance to rolling and spinning of things of which nothing is said, so that what rolls comes to rest: that of
/// wood on wood.
const RESISTANCE: f64 = 0.01;

/// The material of things for which the file names none.
const PLAIN: &str = "plain";

/// A material of the scenario.
struct Known {
    name: String,
    said: String,
    contact: Option<Contact>,
    /// Its name in the file.
    given: Option<String>,
}

impl Things<'_> {
    /// Materials of things of which the file says what they weigh or how they touch, and their names: things of which
    /// it says the same have one. Where it says nothing of how anything touches, each of its materials resists rolling
    /// and spinning. Then what pairs of them have; and the name of the material of a floor.
    pub(super) fn materials(&self) -> (String, BTreeMap<usize, String>, Option<String>) {
        let (mut text, mut names) = (String::new(), BTreeMap::new());
        let mut known: Vec<Known> = Vec::new();
        // Where some have rules, what has none touches them by theirs.
        let has_rules = self.all.iter().any(|thing| thing.contact.is_some());
        // What is said of a model says how it rolls.
        let resists = self.content.is_some() && !has_rules && self.bodies().next().is_some();
        if resists {
            text += "\n# Resistances to rolling and spinning, of wood on wood, bring things to rest: replace them.\n";
        }
        for (index, thing) in self.all.iter().enumerate().filter(|(_, thing)| thing.role != Role::Gone) {
            let contact = thing.contact.or(has_rules.then_some(Contact::USUAL));
            let density = self.density(thing);
            if density.is_none() && contact.is_none() && !resists {
                continue;
            }
            let mut said = density.map_or_else(String::new, |density| format!("density = {}\n", number(density)));
            said += &contact.map_or_else(String::new, |contact| contact.lines());
            if resists {
                let _ = write!(said, "rolling = {RESISTANCE}\nspinning = {RESISTANCE}\n");
            }
            let given = thing.material.clone().filter(|_| resists);
            let same = |one: &&Known| one.said == said && one.contact == contact && one.given == given;
            let name = match known.iter().find(same) {
                Some(one) => one.name.clone(),
                None => {
                    let name = match (&given, density) {
                        (Some(given), _) => free(plain_name(given), &known),
                        (None, None) if resists => free(PLAIN.into(), &known),
                        _ => format!("of_{}", thing.name),
                    };
                    let _ = write!(text, "\n[[world.custom.materials]]\nname = {}\n{said}", quoted(&name));
                    known.push(Known { name: name.clone(), said, contact, given });
                    name
                }
            };
            names.insert(index, name);
        }
        for (index, one) in known.iter().enumerate() {
            for other in &known[..=index] {
                let (Some(a), Some(b)) = (one.contact, other.contact) else { continue };
                let said = a.between(&b);
                if !said.is_empty() {
                    let two = [other, one].map(|one| quoted(&one.name)).join(", ");
                    let _ = write!(text, "\n[[world.custom.pairs]]\nbetween = [{two}]\n{said}");
                }
            }
        }
        let ground = resists.then(|| known.first().map(|one| one.name.clone())).flatten();
        (text, names, ground)
    }
}

/// A name that no other material has.
fn free(plain: String, known: &[Known]) -> String {
    let is_free = |name: &String| known.iter().all(|one| one.name != *name);
    let more = (2..).map(|k| format!("{plain}_{k}"));
    std::iter::once(plain.clone()).chain(more).find(is_free).unwrap_or(plain)
}

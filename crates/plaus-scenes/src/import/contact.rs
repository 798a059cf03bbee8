//! Friction and restitution of things, and what two of them have together.

use super::things::{Role, Things};
use super::write::{number, quoted};
use std::collections::BTreeMap;
use std::fmt::Write;

/// What Plaus gives a thing of which nothing is said.
const USUAL: [f64; 2] = [0.5, 0.5];

/// How a value follows from those of two materials. Of two different rules the earlier one here holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Rule {
    Average,
    Minimum,
    Maximum,
    Multiply,
    /// Nothing is said: the other's rule, or else the average.
    Unsaid,
}

impl Rule {
    /// The rule of this name, as `KHR_physics_rigid_bodies` has it.
    pub(super) fn named(name: &str) -> Option<Self> {
        Some(match name {
            "average" => Self::Average,
            "minimum" => Self::Minimum,
            "maximum" => Self::Maximum,
            "multiply" => Self::Multiply,
            _ => return None,
        })
    }

    fn of(self, a: f64, b: f64) -> f64 {
        match self {
            Self::Average | Self::Unsaid => 0.5 * (a + b),
            Self::Minimum => a.min(b),
            Self::Maximum => a.max(b),
            Self::Multiply => a * b,
        }
    }
}

/// Friction and restitution of a thing, each with its rule.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Contact {
    pub(super) values: [f64; 2],
    pub(super) rules: [Rule; 2],
}

impl Contact {
    /// Of a thing of which nothing is said.
    pub(super) const USUAL: Self = Self { values: USUAL, rules: [Rule::Unsaid; 2] };

    /// As in MuJoCo: the larger friction, and nothing bounces.
    pub(super) fn of_mujoco(friction: f64) -> Self {
        Self { values: [friction, 0.0], rules: [Rule::Maximum; 2] }
    }

    /// Friction and restitution between two, where they are not the geometric means, as far as a scenario can say.
    fn between(&self, other: &Self) -> [Option<f64>; 2] {
        [0, 1].map(|k| {
            let (a, b) = (self.values[k], other.values[k]);
            let value = self.rules[k].min(other.rules[k]).of(a, b);
            (number(value) != number((a * b).sqrt())).then_some(value)
        })
    }
}

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

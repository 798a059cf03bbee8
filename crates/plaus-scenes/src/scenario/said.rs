//! What a scenario says itself, without the defaults that fill it up.

use super::Scenario;
use super::overrides;
use super::shape::scenario;
use super::tree::{Data, Tree};
use serde_json::Value;

impl Scenario {
    /// The keys that the file's text and the overrides give, with their effective values, as TOML.
    #[must_use]
    pub fn said(&self, text: &str, given: &[String]) -> String {
        let (mut tree, _) = Tree::parse(text);
        for said in given {
            let _ = overrides::apply(said, scenario(), &mut tree); // what is wrong was reported when it was read
        }
        let mut values = self.to_value();
        keep(&mut values, &tree);
        toml::to_string(&values).unwrap_or_default()
    }
}

/// Keeps what the tree has too.
fn keep(value: &mut Value, tree: &Tree) {
    match (value, &tree.data) {
        (Value::Object(entries), Data::Table(given)) => {
            entries.retain(|name, _| given.contains_key(name));
            entries.iter_mut().for_each(|(name, inner)| keep(inner, &given[name]));
        }
        (Value::Array(items), Data::List(given)) => items.iter_mut().zip(given).for_each(|(item, one)| keep(item, one)),
        _ => {}
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_what_was_given_is_said() {
        let text = "[sampler]\nseed = 3\n[world.custom]\n[[world.custom.bodies]]\nname = 'ball'\nat_mm = [0, 0, 90]\n\
                    shape = { ball = { radius_mm = 3e1 } }\n[[require]]\nrests_at = { x_mm = 5 }\n";
        let given = ["require[0].rests_at.within_mm=7", "chains=2"].map(str::to_owned);
        let read = Scenario::read("a.toml", text, &given).unwrap();
        let said = read.said(text, &given);
        let again = Scenario::read("again.toml", &said, &[]).unwrap();
        assert_eq!(again, read);
        let mut lines: Vec<&str> = said.lines().filter(|line| line.contains(" = ")).collect();
        lines.sort_unstable();
        let world = ["at_mm = [0.0, 0.0, 90.0]", "chains = 2", "name = \"ball\"", "radius_mm = 30.0", "seed = 3"];
        assert_eq!(lines, [&world[..], &["within_mm = 7.0", "x_mm = 5.0"]].concat(), "{said}");
    }
}

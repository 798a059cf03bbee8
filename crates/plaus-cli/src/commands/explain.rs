//! `plaus explain`

use crate::failure::{Failure, Outcome};
use crate::glossary;
use crate::output;
use plaus_scenes::registry::NAMES;
use plaus_scenes::scenario::{self, KeyDoc, NoKey};

/// What to explain.
#[derive(clap::Args)]
pub(crate) struct Args {
    /// A key such as sigma_d, world.ball2d.sigma_d or constraints[0].rest_at; a scene such as ball2d; or a word such as
    /// chain or distinct. Lists all keys and words if left out
    key: Option<String>,
}

impl Args {
    pub(super) fn run(self) -> Result<Outcome, Failure> {
        output::print(&self.text()?)?;
        Ok(Outcome::Done)
    }

    fn text(&self) -> Result<String, Failure> {
        Ok(match self.key.as_deref() {
            None => format!("{}\n  words: {}\n", list(""), glossary::words().collect::<Vec<_>>().join(", ")),
            Some(scene) if NAMES.contains(&scene) => {
                let table = format!("world.{scene}");
                let about = scenario::explain(&table).map(|doc| format!("{}\n\n", doc.description)).unwrap_or_default();
                format!("{about}{}", list(&format!("{table}.")))
            }
            Some(word) if glossary::meaning(word).is_some() => {
                let meaning = glossary::meaning(word).unwrap_or_default();
                let key = scenario::explain(word).map(|doc| format!("\n{}", describe(&doc))).unwrap_or_default();
                format!("{word}: {meaning}\n{key}")
            }
            Some(key) => {
                let doc = find(key).map_err(|error| unknown(key, error))?;
                let others = scenario::namesakes(key, &doc.key);
                let kinds = if doc.key == key { Vec::new() } else { scenario::kinds_with(key) };
                let also = choices(others.iter().chain(&kinds));
                let also = if also.is_empty() { also } else { format!("\nsee also:{also}\n") };
                describe(&doc) + &also
            }
        })
    }
}

/// The kind of a requirement, or a key.
fn find(key: &str) -> Result<KeyDoc, NoKey> {
    scenario::explain(&format!("require[].{key}")).or_else(|_| scenario::explain(key))
}

/// A line for each key that can be explained.
fn choices<'a>(keys: impl Iterator<Item = &'a String>) -> String {
    keys.map(|key| format!("\n  plaus explain {key}")).collect()
}

fn unknown(key: &str, error: NoKey) -> Failure {
    let kinds = scenario::kinds_with(key);
    Failure::Message(match error {
        NoKey::Unknown(_) if !kinds.is_empty() => {
            format!("`{key}` is a key of requirements; choose one:{}", choices(kinds.iter()))
        }
        NoKey::Unknown(Some(near)) => format!("there is no key or word `{key}`; did you mean `{near}`?"),
        NoKey::Unknown(None) => format!("there is no key or word `{key}`; `plaus explain` lists all"),
        NoKey::Ambiguous(keys) => {
            format!("several keys are called `{key}`; choose one:{}", choices(keys.iter().chain(&kinds)))
        }
    })
}

fn list(prefix: &str) -> String {
    let rows = scenario::keys().into_iter().filter(|doc| doc.key.starts_with(prefix)).map(|doc| {
        let first = doc.description.lines().next().unwrap_or_default();
        let sentence = first.split_once(". ").map_or(first, |(sentence, _)| sentence).trim_end_matches('.');
        // A default that takes several lines, joined into one.
        let default: Vec<&str> = doc.default.split_whitespace().collect();
        (doc.key, format!("{} = {}", sentence, default.join(" ")))
    });
    rows.map(|(key, about)| format!("{key}\n    {about}\n")).collect()
}

fn describe(doc: &KeyDoc) -> String {
    let unit = doc.unit.as_ref().map(|unit| format!(", in {unit}")).unwrap_or_default();
    let range = if doc.range.is_empty() { String::new() } else { format!(", {}", doc.range) };
    let mut rows = vec![vec!["kind".to_owned(), format!("{}{range}{unit}", doc.kind)]];
    if !doc.default.is_empty() {
        rows.push(vec!["default".to_owned(), doc.default.clone()]);
    }
    let facts = rows.iter().map(|row| format!("{:<8} {}\n", row[0], row[1])).collect::<String>();
    let inside = table_keys(&doc.key);
    format!("{}\n{facts}\n{}\n{inside}", doc.key, doc.description)
}

/// Lists the keys in a table; empty for a key that holds a value.
fn table_keys(key: &str) -> String {
    let keys = list(&format!("{key}."));
    if keys.is_empty() { keys } else { format!("\n{keys}") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_key_is_explained() {
        let keys = scenario::keys();
        assert!(keys.len() > 200, "{}", keys.len());
        for KeyDoc { key, .. } in keys {
            let text = Args { key: Some(key.clone()) }.text().ok();
            assert!(text.is_some_and(|text| text.starts_with(&key)), "{key}");
        }
        assert!(Args { key: Some("sigmad".to_owned()) }.text().is_err());
    }
}

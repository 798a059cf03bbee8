//! Overrides: `key=value`, laid over a file's tree before it is checked.

use super::nearest::{any_of, nearest, shown};
use super::problem::{Problem, Source};
use super::shape::Shape;
use super::tree::{Data, Place, Tree};
use std::collections::BTreeMap;
use toml::de::DeValue;

/// Why a name stands for no key.
#[derive(Debug, PartialEq, Eq)]
pub(super) enum NoKey {
    /// No key is called so; perhaps this one was meant.
    Unknown(Option<String>),
    /// Several keys end so.
    Ambiguous(Vec<String>),
}

/// Lays `said`, as in `sigma_d=0.05`, over `tree`. Tables on the way are made where they are missing.
///
/// # Errors
/// The problem with `said` itself; whether the value fits its key is checked later, with the whole tree.
pub(super) fn apply(said: &str, shape: &Shape, tree: &mut Tree) -> Result<(), Box<Problem>> {
    let blame = |problem: Problem| Box::new(problem.at(&Source::Override(said.into()), None));
    let Some((name, value)) = said.split_once('=') else {
        return Err(blame(Problem::new(shown(said), "an override is `key=value`, and this has no `=`")));
    };
    let name = name.trim();
    let key = resolve(name, &shape.paths(Some(tree)), &shape.paths(None))
        .map_err(|error| blame(error.problem(name, shape)))?;
    insert(tree, &key, value_of(value.trim(), said), said);
    Ok(())
}

/// The key that `name` stands for: its full dotted name, or an end of it that no other of `keys` has. Full names may be any of `all`.
///
/// # Errors
/// [`NoKey`].
pub(super) fn resolve(name: &str, keys: &[String], all: &[String]) -> Result<String, NoKey> {
    if let Some(key) = all.iter().find(|key| *key == name) {
        return Ok(key.clone());
    }
    let ends_so = |key: &&String| key.strip_suffix(name).is_some_and(|rest| rest.ends_with('.'));
    let mut found: Vec<String> = keys.iter().filter(ends_so).filter(|_| !name.is_empty()).cloned().collect();
    match (found.pop(), found.is_empty()) {
        (Some(key), true) => Ok(key),
        (Some(key), false) => Err(NoKey::Ambiguous([found, vec![key]].concat())),
        (None, _) => Err(NoKey::Unknown(nearest_key(name, keys))),
    }
}

/// The key nearest to `name`, compared as a whole and by their last parts.
fn nearest_key(name: &str, keys: &[String]) -> Option<String> {
    if let Some(key) = nearest(name, keys.iter().map(String::as_str)) {
        return Some(key.into());
    }
    let leaf = |key: &str| key.rsplit('.').next().unwrap_or_default().to_owned();
    let leaves: Vec<String> = keys.iter().map(|key| leaf(key)).collect();
    let found = nearest(&leaf(name), leaves.iter().map(String::as_str))?.to_owned();
    keys.iter().zip(leaves).find(|(_, leaf)| *leaf == found).map(|(key, _)| key.clone())
}

impl NoKey {
    fn problem(self, name: &str, shape: &Shape) -> Problem {
        match self {
            Self::Unknown(nearest) => {
                let help = nearest.map(|key| format!("did you mean `{key}`?")).or_else(|| known_beside(name, shape));
                Problem::new(name.chars().take(200).collect::<String>(), "unknown key").with_help(help)
            }
            Self::Ambiguous(keys) => {
                let keys = any_of(keys.into_iter().map(|key| format!("`{key}`")));
                Problem::new(name, "several keys end so").with_help(Some(format!("write {keys}")))
            }
        }
    }
}

/// What the last known table on the way to `name` holds.
fn known_beside(name: &str, shape: &Shape) -> Option<String> {
    let (mut table, mut rest) = (shape, name);
    while let Some((first, after)) = rest.split_once('.') {
        let Some(inner) = table.get(first) else { break };
        (table, rest) = (inner, after);
    }
    let known = table.keys().iter().map(|(key, _)| key.as_str()).collect::<Vec<_>>().join(", ");
    let path = name.strip_suffix(rest)?.trim_end_matches('.');
    if known.is_empty() || path.is_empty() { None } else { Some(format!("known in [{path}]: {known}")) }
}

/// The value as TOML, else as a bare string.
fn value_of(value: &str, said: &str) -> Tree {
    match DeValue::parse(value) {
        Ok(value) => Tree::of_override(value.get_ref(), said),
        Err(_) => Tree { place: Place::of_override(said), data: Data::Text(value.into()) },
    }
}

/// Puts `value` at the dotted `key`. Something other than a table in the way stays: it is wrong itself, and will be reported.
fn insert(tree: &mut Tree, key: &str, value: Tree, said: &str) {
    let Data::Table(entries) = &mut tree.data else { return };
    match key.split_once('.') {
        None => {
            entries.insert(key.into(), value);
        }
        Some((first, rest)) => {
            let table = || Tree { place: Place::of_override(said), data: Data::Table(BTreeMap::new()) };
            insert(entries.entry(first.into()).or_insert_with(table), rest, value, said);
        }
    }
}

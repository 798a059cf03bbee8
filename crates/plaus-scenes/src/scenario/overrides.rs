//! Overrides: `key=value`, applied to a file's tree before it is checked.

use super::nearest::{any_of, nearest, nearest_leaf, shown};
use super::problem::{Problem, Source};
use super::shape::{Kind, Shape};
use super::tree::{Data, Place, Tree, indexed, join, leaf};
use crate::words::listed;
use std::collections::BTreeMap;
use toml::de::DeValue;

/// Why a name does not refer to one key.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum NoKey {
    /// No key has this name; perhaps this one was meant.
    Unknown(Option<String>),
    /// All keys with this ending: at least two.
    Ambiguous(Vec<String>),
}

/// Applies `said`, such as `sigma_d=0.05`, to `tree`. Missing tables on the way are created.
///
/// # Errors
///
/// The problem with `said` itself. Whether the value fits its key is checked later, with the whole tree.
pub(super) fn apply(said: &str, shape: &Shape, tree: &mut Tree) -> Result<(), Box<Problem>> {
    let blame = |problem: Problem| Box::new(problem.at(&Source::Override(said.into()), None));
    let Some((name, value)) = said.split_once('=') else {
        return Err(blame(Problem::new(shown(said), "an override has the form `key=value`, but this has no `=`")));
    };
    let name = name.trim();
    let (key, places) = key_of(name, shape, Some(tree)).map_err(|error| blame(error.problem(name, shape)))?;
    let key = with_places(&key, &places, shape, tree).map_err(|problem| blame(*problem))?;
    insert(tree, shape, &key, value_of(value.trim(), said)).map_err(|problem| blame(*problem))
}

/// The key that `name` refers to, with `[]` for each index into a list, and the indices that `name` gives.
///
/// # Errors
/// [`NoKey`].
pub(super) fn key_of(name: &str, shape: &Shape, tree: Option<&Tree>) -> Result<(String, Vec<usize>), NoKey> {
    let (plain, places) = without_places(name);
    let found = resolve(&plain, &shape.paths(tree), &shape.paths(None));
    let found = match found {
        Err(NoKey::Unknown(near)) => {
            // Requirements have so many keys that an ending of one says little: they are written in full.
            let mut ends = shape.paths_in_lists(tree);
            ends.retain(|key| !key.starts_with("require[]"));
            let inside = resolve(&plain, &ends, &shape.paths_in_lists(None));
            inside.map_err(|error| match error {
                NoKey::Unknown(inside) => NoKey::Unknown(near.or(inside)),
                ambiguous @ NoKey::Ambiguous(_) => ambiguous,
            })
        }
        found => found,
    };
    found.map(|key| (key, places))
}

/// `constraints[0].rest_at` as `constraints[].rest_at` and 0.
fn without_places(name: &str) -> (String, Vec<usize>) {
    let places = name.split('.').filter_map(indexed).map(|(_, place)| place).collect();
    let plain = |part| indexed(part).map_or(String::from(part), |(list, _)| format!("{list}[]"));
    (name.split('.').map(plain).collect::<Vec<_>>().join("."), places)
}

/// `key` with an index for each `[]`. Missing indices are those of the only table in the tree that has the rest of the
/// key.
fn with_places(key: &str, places: &[usize], shape: &Shape, tree: &Tree) -> Result<String, Box<Problem>> {
    let lists = key.matches("[]").count();
    let Some((before, after)) = key.split_once("[]").filter(|_| lists > places.len()) else {
        return Ok(places.iter().fold(key.to_owned(), |key, place| key.replacen("[]", &format!("[{place}]"), 1)));
    };
    let wanted = after.trim_start_matches('.').split('.').next().unwrap_or_default();
    let (path, list) = tree.nearest(before);
    let given = match &list.data {
        Data::List(items) if path == before => items.clone(),
        _ => default_items(shape, before),
    };
    let having: Vec<String> = (0..given.len())
        .filter(|&place| wanted.is_empty() || given[place].get(wanted).is_some())
        .map(|place| format!("{before}[{place}]{after}"))
        .collect();
    match having.as_slice() {
        [one] => Ok(one.clone()),
        [] => {
            let message = format!("no table of `{before}` has `{wanted}`");
            let places: Vec<String> = (0..given.len()).map(|place| format!("`{before}[{place}]`")).collect();
            let help = (!given.is_empty()).then(|| format!("there are {}", listed(&places)));
            Err(Box::new(Problem::new(key, message).with_help(help)))
        }
        several => {
            let several = any_of(several.iter().map(|key| format!("`{key}`")));
            let message = "more than one entry of the list may be meant";
            Err(Box::new(Problem::new(key, message).with_help(Some(format!("write {several}")))))
        }
    }
}

/// The contents of the list at `key` if a scenario does not give it.
fn default_items(shape: &Shape, key: &str) -> Vec<Tree> {
    let default = shape.at(key).and_then(|shape| shape.default.as_ref());
    let text = default.and_then(|value| toml::Value::try_from(value).ok()).map(|value| value.to_string());
    match text.map(|text| value_of(&text, "").data) {
        Some(Data::List(items)) => items,
        _ => Vec::new(),
    }
}

/// The key that `name` refers to: its full dotted name, or an ending of it that no other of `keys` has. Full names may
/// be any of `all`.
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

/// The key nearest to `name`, comparing whole names and last parts.
fn nearest_key(name: &str, keys: &[String]) -> Option<String> {
    let whole = nearest(name, keys.iter().map(String::as_str));
    whole.or_else(|| nearest_leaf(leaf(name), keys)).map(String::from)
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
                Problem::new(name, "several keys have this ending").with_help(Some(format!("write {keys}")))
            }
        }
    }
}

/// The keys of the last known table on the way to `name`.
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

/// The value as TOML, or else as a bare string.
fn value_of(value: &str, said: &str) -> Tree {
    match DeValue::parse(value) {
        Ok(value) => Tree::of_override(value.get_ref(), said),
        Err(_) => Tree { place: Place::of_override(said), data: Data::Text(value.into()) },
    }
}

/// Puts `value` at the dotted `key` of `tree`. If something other than a table or a list is in the way, it stays: it is
/// wrong itself, and will be reported.
fn insert(tree: &mut Tree, shape: &Shape, key: &str, value: Tree) -> Result<(), Box<Problem>> {
    let (mut inner, mut here) = (tree, String::new());
    for name in key.split('.') {
        let is_one_of = |item: &Shape| matches!(item.kind, Kind::OneOf(_));
        let is_choice = here.ends_with(']') && shape.at(&without_places(&here).0).is_some_and(is_one_of);
        if let Some(other) = inner.first_key().filter(|_| is_choice && inner.get(name).is_none()) {
            let message = format!("`{here}` is `{other}`, not `{name}`");
            let help = "`plaus check` shows the whole scenario".to_owned();
            return Err(Box::new(Problem::new(here, message).with_help(Some(help))));
        }
        let Data::Table(entries) = &mut inner.data else { return Ok(()) };
        let Some((list, place)) = indexed(name) else {
            let empty = || Tree { place: value.place.clone(), data: Data::Table(BTreeMap::new()) };
            (inner, here) = (entries.entry(name.into()).or_insert_with(empty), join(&here, name));
            continue;
        };
        let default = || Data::List(default_items(shape, &without_places(&join(&here, list)).0));
        let given = entries.entry(list.into()).or_insert_with(|| Tree { place: value.place.clone(), data: default() });
        let Data::List(items) = &mut given.data else { return Ok(()) };
        here = join(&here, name);
        let count = items.len();
        inner = items.get_mut(place).ok_or_else(|| Box::new(beyond(&here, list, count)))?;
    }
    *inner = value;
    Ok(())
}

/// An index beyond the end of a list.
fn beyond(key: &str, name: &str, count: usize) -> Problem {
    let help = match count {
        0 => format!("`{name}` is empty"),
        1 => format!("`{name}` has one entry, `{name}[0]`"),
        _ => format!("`{name}` has {count} entries, `{name}[0]` to `{name}[{}]`", count - 1),
    };
    Problem::new(key, "the list has no such entry").with_help(Some(help))
}

//! TOML as a tree in which every value knows its origin.

use super::problem::{Problem, ScenarioError, Source};
use crate::scene::ConfigError;
use serde_json::Value;
use std::collections::BTreeMap;
use std::ops::Range;
use toml::de::{DeTable, DeValue};

/// A value and its origin.
#[derive(Debug, Clone)]
pub(super) struct Tree {
    pub(super) place: Place,
    pub(super) data: Data,
}

/// Where a value is.
#[derive(Debug, Clone)]
pub(super) struct Place {
    pub(super) source: Source,
    /// Bytes of the key.
    pub(super) key: Option<Range<usize>>,
    /// Bytes of the value.
    pub(super) value: Option<Range<usize>>,
}

/// A TOML value.
#[derive(Debug, Clone)]
pub(super) enum Data {
    Table(BTreeMap<String, Tree>),
    List(Vec<Tree>),
    /// Digits with a sign, and their base.
    Integer(String, u32),
    Float(String),
    Text(String),
    Boolean(bool),
    Datetime(String),
}

impl Place {
    /// Given by an override, or implied by one.
    pub(super) fn of_override(said: &str) -> Self {
        Self { source: Source::Override(said.into()), key: None, value: None }
    }

    /// `problem`, blamed on the key.
    pub(super) fn blame_key(&self, problem: Problem) -> Problem {
        problem.at(&self.source, self.key.clone())
    }

    /// `problem`, blamed on the key; for an entry of a list, on the whole entry.
    pub(super) fn blame(&self, problem: Problem) -> Problem {
        problem.at(&self.source, self.key.clone().or_else(|| self.value.clone()))
    }

    /// `problem`, blamed on the value.
    pub(super) fn blame_value(&self, problem: Problem) -> Problem {
        problem.at(&self.source, self.value.clone().or_else(|| self.key.clone()))
    }
}

impl Tree {
    /// The tree of a file, as far as it can be read, and the errors.
    pub(super) fn parse(text: &str) -> (Self, Vec<toml::de::Error>) {
        let (table, errors) = DeTable::parse_recoverable(text);
        let place = Place { source: Source::File, key: None, value: None };
        (Self { data: Data::of_table(table.get_ref(), &place), place }, errors)
    }

    /// The tree of a value that is in no text. What is null is not given.
    pub(super) fn of_value(value: &Value) -> Self {
        let data = match value {
            Value::Null => Data::Table(BTreeMap::new()),
            Value::Bool(value) => Data::Boolean(*value),
            Value::Number(number) if number.is_f64() => Data::Float(number.to_string()),
            Value::Number(number) => Data::Integer(number.to_string(), 10),
            Value::String(text) => Data::Text(text.clone()),
            Value::Array(items) => Data::List(items.iter().map(Self::of_value).collect()),
            Value::Object(entries) => {
                let given = entries.iter().filter(|(_, value)| !value.is_null());
                Data::Table(given.map(|(key, value)| (key.clone(), Self::of_value(value))).collect())
            }
        };
        Self { place: Place { source: Source::File, key: None, value: None }, data }
    }

    /// The tree of a value that an override gives.
    pub(super) fn of_override(value: &DeValue<'_>, said: &str) -> Self {
        let place = Place::of_override(said);
        Self { data: Data::of_toml(value, &place), place }
    }

    /// The value of a key, if this is a table that has it.
    pub(super) fn get(&self, key: &str) -> Option<&Self> {
        match &self.data {
            Data::Table(entries) => entries.get(key),
            _ => None,
        }
    }

    /// The key that comes first, if this is a table that is not empty.
    pub(super) fn first_key(&self) -> Option<&str> {
        match &self.data {
            Data::Table(entries) => entries.keys().next().map(String::as_str),
            _ => None,
        }
    }

    /// The value of a key, or of an entry of a list, as in `name[2]`.
    fn get_indexed(&self, name: &str) -> Option<&Self> {
        let Some((list, place)) = indexed(name) else { return self.get(name) };
        match &self.get(list)?.data {
            Data::List(items) => items.get(place),
            _ => None,
        }
    }

    /// The value at a dotted key, or the last one on the way there, with its own dotted key.
    pub(super) fn nearest(&self, key: &str) -> (String, &Self) {
        let (mut path, mut tree) = (String::new(), self);
        for name in key.split('.') {
            match tree.get_indexed(name) {
                Some(inner) => (path, tree) = (join(&path, name), inner),
                None => break,
            }
        }
        (path, tree)
    }
}

impl Data {
    /// The contents of lists and tables have places in their own source. Depth is bounded: the parser allows 80 levels.
    fn of_toml(value: &DeValue<'_>, place: &Place) -> Self {
        match value {
            DeValue::String(text) => Self::Text(text.to_string()),
            DeValue::Integer(number) => Self::Integer(number.as_str().into(), number.radix()),
            DeValue::Float(number) => Self::Float(number.as_str().into()),
            DeValue::Boolean(value) => Self::Boolean(*value),
            DeValue::Datetime(value) => Self::Datetime(value.to_string()),
            DeValue::Table(table) => Self::of_table(table, place),
            DeValue::Array(items) => {
                let items = items.iter().map(|item| {
                    let place = place.inner(None, item.span());
                    Tree { data: Self::of_toml(item.get_ref(), &place), place }
                });
                Self::List(items.collect())
            }
        }
    }

    fn of_table(table: &DeTable<'_>, place: &Place) -> Self {
        let entries = table.iter().map(|(key, value)| {
            let place = place.inner(Some(key.span()), value.span());
            (key.get_ref().to_string(), Tree { data: Self::of_toml(value.get_ref(), &place), place })
        });
        Self::Table(entries.collect())
    }
}

impl Place {
    /// The place of something inside: spans of an override's value do not refer to the file.
    fn inner(&self, key: Option<Range<usize>>, value: Range<usize>) -> Self {
        match self.source {
            Source::File => Self { source: Source::File, key, value: Some(value) },
            Source::Override(_) => self.clone(),
        }
    }
}

impl ScenarioError {
    /// An error that a scene found later, blamed on its key in the file, or on the table that lacks the key.
    #[must_use]
    pub fn locate(name: &str, text: &str, error: &ConfigError) -> Self {
        let (tree, _) = Tree::parse(text);
        Self::new(name, text, vec![located(&tree, error)])
    }
}

/// A scene's error about a key of `tree`.
pub(super) fn located(tree: &Tree, error: &ConfigError) -> Problem {
    let (found, value) = tree.nearest(&error.key);
    let problem = Problem::new(error.key.clone(), error.message.clone());
    let is_value = found == error.key && !matches!(value.data, Data::Table(_));
    // An entry of a list has no key of its own.
    if is_value || value.place.key.is_none() {
        value.place.blame_value(problem)
    } else {
        value.place.blame_key(problem)
    }
}

/// The list and the index of a name such as `name[2]`.
pub(super) fn indexed(name: &str) -> Option<(&str, usize)> {
    let (list, place) = name.strip_suffix(']')?.split_once('[')?;
    Some((list, place.parse().ok()?))
}

/// The last part of a dotted key.
pub(super) fn leaf(key: &str) -> &str {
    key.rsplit('.').next().unwrap_or(key)
}

/// The dotted key of `name` in the table `path`.
pub(super) fn join(path: &str, name: &str) -> String {
    if path.is_empty() { name.into() } else { format!("{path}.{name}") }
}

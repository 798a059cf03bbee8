//! A number with a name.

use super::amount::{self, Amount};
use crate::scenario::nearest;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// A number with a name, which other numbers can refer to.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Quantity {
    /// Its name.
    pub name: String,
    /// Its value, in the unit of the keys that name it: a number, a law, or arithmetic with other quantities.
    pub value: Amount<amount::Plain>,
}

/// What is wrong with a name that is none of these.
pub(super) fn unknown<V>(name: &str, quantities: &BTreeMap<String, V>) -> String {
    let known: Vec<&str> = quantities.keys().map(String::as_str).collect();
    let near = nearest(name, known.iter().copied());
    let near = near.map(|near| format!("did you mean {near:?}? ")).unwrap_or_default();
    let there = if known.is_empty() { "there are none".into() } else { format!("known: {}", known.join(", ")) };
    format!("there is no quantity {name:?}; {near}{there}")
}

//! Quantities are computed first, each after those that it names.

use super::amount::Amount;
use super::quantity::Quantity;
use super::values::{Collector, Owner};
use crate::scene::ConfigError;
use std::collections::BTreeMap;

/// Names that mean something else in formulas.
const TAKEN: [&str; 3] = ["i", "n", "pi"];

#[derive(Clone, Copy, PartialEq, Eq)]
enum Mark {
    New,
    /// What it names is looked at now.
    Open,
    Done,
}

impl Collector {
    /// With these quantities, each a group of its own where it is uncertain.
    pub(super) fn new(quantities: &[Quantity]) -> Result<Self, ConfigError> {
        let mut collector = Self::default();
        for index in in_order(quantities, &mut collector)? {
            let quantity = &quantities[index];
            let key = format!("world.custom.quantities[{index}]");
            collector.begin();
            let value = collector.number(&Owner::new(&quantity.name, &key), "value", "", &quantity.value)?;
            collector.quantities.insert(quantity.name.clone(), value);
        }
        Ok(collector)
    }
}

/// Indices in an order in which each comes after those that it names, otherwise as in the file.
///
/// # Errors
/// Names that are given twice or mean something else, formulas that are none, and quantities that name each other in a
/// circle.
fn in_order(quantities: &[Quantity], collector: &mut Collector) -> Result<Vec<usize>, ConfigError> {
    let keys: Vec<String> = (0..quantities.len()).map(|index| format!("world.custom.quantities[{index}]")).collect();
    let owner = |index: usize| Owner::new(&quantities[index].name, &keys[index]);
    let mut places = BTreeMap::new();
    for (index, quantity) in quantities.iter().enumerate() {
        let name = quantity.name.as_str();
        if TAKEN.contains(&name) {
            return Err(owner(index).wrong("name", format!("{name:?} has another meaning in arithmetic")));
        }
        if places.insert(name, index).is_some() {
            return Err(owner(index).wrong("name", format!("there is already a quantity called {name:?}")));
        }
    }
    let mut names = Vec::with_capacity(quantities.len());
    for (index, quantity) in quantities.iter().enumerate() {
        names.push(match &quantity.value {
            Amount::Said(text) if places.contains_key(text.as_str()) => vec![places[text.as_str()]],
            Amount::Said(text) => {
                let formula = collector.read(text).map_err(|message| owner(index).wrong("value", message))?;
                formula.names.iter().filter_map(|name| places.get(name.as_str()).copied()).collect()
            }
            _ => Vec::new(),
        });
    }
    sorted(&names).map_err(|circle| {
        let words: Vec<&str> = circle.iter().map(|index| quantities[*index].name.as_str()).collect();
        owner(circle[0]).wrong("value", format!("it depends on itself: {}", words.join(" → ")))
    })
}

/// The order, or a circle whose last is its first.
fn sorted(names: &[Vec<usize>]) -> Result<Vec<usize>, Vec<usize>> {
    let mut marks = vec![Mark::New; names.len()];
    let mut order = Vec::with_capacity(names.len());
    for first in 0..names.len() {
        // What is open, and how many of its names are done. No recursion: a chain of names may be long.
        let mut open: Vec<(usize, usize)> = Vec::new();
        if marks[first] == Mark::New {
            (marks[first], open) = (Mark::Open, vec![(first, 0)]);
        }
        while let Some((index, done)) = open.last_mut() {
            let Some(&next) = names[*index].get(*done) else {
                marks[*index] = Mark::Done;
                order.push(*index);
                open.pop();
                continue;
            };
            *done += 1;
            match marks[next] {
                Mark::Done => {}
                Mark::Open => {
                    let circle = open.iter().map(|(index, _)| *index).skip_while(|index| *index != next);
                    return Err(circle.chain([next]).collect());
                }
                Mark::New => {
                    marks[next] = Mark::Open;
                    open.push((next, 0));
                }
            }
        }
    }
    Ok(order)
}

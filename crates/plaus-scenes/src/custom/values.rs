//! From the numbers of a scenario to variables, and from draws to numbers.

use super::amount::{Amount, Domain, Measure};
use super::config::Quantity;
use crate::scenario::nearest;
use crate::scene::ConfigError;
use glam::{DQuat, DVec3};
use plaus_mcmc::{Law, Var};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// The values of all random variables.
#[derive(Debug, PartialEq, Serialize, Deserialize)]
pub struct Drawn {
    /// Those that are numbers, each in the unit of its key.
    pub numbers: Vec<f64>,
    /// Orientations that are random as a whole.
    pub turns: Vec<DQuat>,
}

impl Clone for Drawn {
    fn clone(&self) -> Self {
        Self { numbers: self.numbers.clone(), turns: self.turns.clone() }
    }
    fn clone_from(&mut self, source: &Self) {
        self.numbers.clone_from(&source.numbers);
        self.turns.clone_from(&source.turns);
    }
}

/// Where the value of a variable is in a draw.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Slot {
    Number(usize),
    Turn(usize),
}

/// A number, once a draw is known.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Value {
    Fixed(f64),
    /// The number of the draw with this index; and a value in the middle of its law.
    Drawn(usize, f64),
}

impl Value {
    pub(super) fn is_fixed(self) -> bool {
        matches!(self, Self::Fixed(_))
    }

    /// The number; without a draw one in the middle of its law.
    pub(super) fn of(self, draw: Option<&Drawn>) -> f64 {
        match self {
            Self::Fixed(value) => value,
            Self::Drawn(index, centre) => draw.map_or(centre, |draw| draw.numbers[index]),
        }
    }
}

/// Three numbers.
pub(super) type Values = [Value; 3];

/// Three numbers as a vector.
pub(super) fn vector(values: &Values, draw: Option<&Drawn>) -> DVec3 {
    DVec3::from_array(values.map(|value| value.of(draw)))
}

/// Collects variables.
#[derive(Debug, Default)]
pub(super) struct Collector {
    pub(super) vars: Vec<Var>,
    pub(super) slots: Vec<Slot>,
    /// Indices of the variables of each body, material and the like.
    pub(super) groups: Vec<Vec<usize>>,
    counts: [usize; 2],
    quantities: BTreeMap<String, (Value, [f64; 2])>,
}

/// What is named, for its variables: `ball`, at the key `world.custom.bodies[0]`.
#[derive(Debug, Clone, Copy)]
pub(super) struct Owner<'a> {
    pub(super) name: &'a str,
    pub(super) key: &'a str,
}

impl Owner<'_> {
    pub(super) fn wrong(&self, key: &str, message: impl std::fmt::Display) -> ConfigError {
        ConfigError::new(format!("{}.{key}", self.key), message)
    }
}

impl Collector {
    /// With these quantities, each a group of its own where it is uncertain.
    pub(super) fn new(quantities: &[Quantity]) -> Result<Self, ConfigError> {
        let mut collector = Self::default();
        for (index, quantity) in quantities.iter().enumerate() {
            let key = format!("world.custom.quantities[{index}]");
            let owner = Owner { name: &quantity.name, key: &key };
            if collector.quantities.contains_key(&quantity.name) {
                return Err(owner.wrong("name", format!("a second quantity called {:?}", quantity.name)));
            }
            if let Amount::Named(_) = quantity.value {
                return Err(owner.wrong("value", "a quantity is a number or a law, not the name of another"));
            }
            collector.begin();
            let value = collector.value(&owner, "value", "", &quantity.value)?;
            collector.quantities.insert(quantity.name.clone(), value);
        }
        Ok(collector)
    }

    /// Begins a new group.
    pub(super) fn begin(&mut self) {
        if self.groups.last().is_none_or(|group| !group.is_empty()) {
            self.groups.push(Vec::new());
        }
    }

    fn add(&mut self, var: Var, slot: Slot) {
        if self.groups.is_empty() {
            self.groups.push(Vec::new());
        }
        if let Some(group) = self.groups.last_mut() {
            group.push(self.vars.len());
        }
        self.vars.push(var);
        self.slots.push(slot);
    }

    /// The number at `key` of `owner`, whose variable is called `owner.short`.
    pub(super) fn number<M: Measure>(
        &mut self,
        owner: &Owner<'_>,
        key: &str,
        short: &str,
        amount: &Amount<M>,
    ) -> Result<Value, ConfigError> {
        let (value, support) = self.value(owner, key, short, amount)?;
        if M::DOMAIN.holds(support) {
            return Ok(value);
        }
        let [low, high] = support;
        let bounded = if let Amount::Law(law, _) = amount { law.bounded() } else { "that quantity needs other ends" };
        let must = M::DOMAIN.words();
        let message = format!("its values go from {low} to {high}, and must be {must}: {bounded}");
        Err(owner.wrong(key, message))
    }

    /// Three numbers: coordinates, edges, angles.
    pub(super) fn three<M: Measure>(
        &mut self,
        owner: &Owner<'_>,
        key: &str,
        shorts: [&str; 3],
        amounts: &[Amount<M>; 3],
    ) -> Result<Values, ConfigError> {
        let mut values = [Value::Fixed(0.0); 3];
        for (axis, value) in values.iter_mut().enumerate() {
            *value = self.number(owner, &format!("{key}[{axis}]"), shorts[axis], &amounts[axis])?;
        }
        Ok(values)
    }

    fn value<M: Measure>(
        &mut self,
        owner: &Owner<'_>,
        key: &str,
        short: &str,
        amount: &Amount<M>,
    ) -> Result<(Value, [f64; 2]), ConfigError> {
        match amount {
            Amount::Fixed(value) => Ok((Value::Fixed(*value), [*value; 2])),
            Amount::Named(name) => self.quantities.get(name).copied().ok_or_else(|| {
                let known: Vec<&str> = self.quantities.keys().map(String::as_str).collect();
                let near = nearest(name, known.iter().copied());
                let near = near.map(|near| format!("did you mean {near:?}? ")).unwrap_or_default();
                let there =
                    if known.is_empty() { "there are none".into() } else { format!("there are {}", known.join(", ")) };
                owner.wrong(key, format!("there is no quantity {name:?}; {near}{there}"))
            }),
            Amount::Law(law, _) => {
                let (made, support) = law.law(M::DOMAIN).map_err(|message| owner.wrong(key, message))?;
                let name = if short.is_empty() { owner.name.to_owned() } else { format!("{}.{short}", owner.name) };
                let index = self.counts[0];
                self.counts[0] += 1;
                self.add(Var::new(name, M::UNIT, made).column(1.0), Slot::Number(index));
                let centre = match M::DOMAIN {
                    Domain::Any | Domain::Turn => law.centre(),
                    Domain::NotNegative | Domain::Share => law.centre().max(0.0),
                };
                Ok((Value::Drawn(index, centre), support))
            }
        }
    }

    /// An orientation that is random as a whole: its place among those of the draw.
    pub(super) fn turn(&mut self, owner: &Owner<'_>) -> usize {
        let index = self.counts[1];
        self.counts[1] += 1;
        self.add(Var::new(format!("{}.turn", owner.name), "", Law::Own), Slot::Turn(index));
        index
    }

    /// A draw with places for all values.
    pub(super) fn empty(&self) -> Drawn {
        Drawn { numbers: vec![0.0; self.counts[0]], turns: vec![DQuat::IDENTITY; self.counts[1]] }
    }
}

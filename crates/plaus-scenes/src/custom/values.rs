//! From the numbers of a scenario to variables, and from draws to numbers.

use super::amount::{Amount, Measure};
use super::domain::Domain;
use super::formula::Formula;
use super::laws::LawOf;
use super::linear::Linear;
use super::quantity::unknown;
use super::range::Range;
use crate::in_place::clone_in_place;
use crate::scene::ConfigError;
use crate::uneven::Bumps;
use glam::{DQuat, DVec3};
use plaus_mcmc::{Law, Var};
use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, BTreeSet};
use std::f64::consts::PI;
use std::sync::Arc;

/// The values of all random variables.
#[derive(Debug, PartialEq, Serialize, Deserialize)]
pub struct Drawn {
    /// Those that are numbers, each in the unit of its key.
    pub numbers: Vec<f64>,
    /// Orientations that are random as a whole.
    pub turns: Vec<DQuat>,
    /// Tables with random bumps; behind them the scores of impacts, if any scatter.
    pub tables: Vec<Bumps>,
}

clone_in_place!(Drawn { numbers, turns, tables });

/// Where the value of a variable is in a draw.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Slot {
    Number(usize),
    Turn(usize),
    Table(usize),
}

/// A number, once a draw is known.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Value {
    Fixed(f64),
    /// The number of the draw with this index.
    Drawn(usize),
    /// What the formula with this index comes to.
    Worked(usize),
}

impl Value {
    pub(super) fn is_fixed(self) -> bool {
        matches!(self, Self::Fixed(_))
    }

    pub(super) fn of(self, numbers: &Numbers<'_>) -> f64 {
        match self {
            Self::Fixed(value) => value,
            Self::Drawn(index) => numbers.drawn[index],
            Self::Worked(index) => numbers.worked[index],
        }
    }

    /// In m, if it is a length.
    pub(super) fn metres(self, numbers: &Numbers<'_>) -> f64 {
        self.of(numbers) * MM
    }
}

/// Metres of a millimetre.
pub(super) const MM: f64 = 1e-3;

/// Three numbers.
pub(super) type Values = [Value; 3];

/// Three numbers as a vector.
pub(super) fn vector(values: &Values, numbers: &Numbers<'_>) -> DVec3 {
    DVec3::from_array(values.map(|value| value.of(numbers)))
}

/// All numbers of a draw: those that were drawn, and what follows from them.
#[derive(Debug)]
pub(super) struct Numbers<'a> {
    drawn: &'a [f64],
    worked: Vec<f64>,
    turns: &'a [DQuat],
    tables: &'a [Bumps],
}

impl Numbers<'_> {
    /// An orientation that is random as a whole.
    pub(super) fn turn(&self, index: usize) -> DQuat {
        self.turns[index]
    }

    /// A table with random bumps.
    pub(super) fn table(&self, index: usize) -> &Bumps {
        &self.tables[index]
    }
}

/// A formula with what its names and laws stand for.
#[derive(Debug, Clone)]
struct Step {
    formula: Arc<Formula>,
    values: Vec<Value>,
}

/// From draws to numbers.
#[derive(Debug, Clone)]
pub(super) struct Works {
    /// Each needs only those before it.
    steps: Vec<Step>,
    /// Values in the middle of their laws.
    middle: Drawn,
}

impl Works {
    /// Values in the middle of their laws.
    pub(super) fn middle(&self) -> &Drawn {
        &self.middle
    }

    /// Adds a formula without laws over `quantities`.
    pub(super) fn add(&mut self, text: &str, quantities: &BTreeMap<String, Value>) -> Result<Value, String> {
        let formula = Formula::read(text)?;
        if formula.laws() > 0 {
            return Err("a law is no number of a requirement: give it to one of the `quantities`, and name that".into());
        }
        let named = |name: &String| match quantities.get(name) {
            Some(value) => Ok(*value),
            None if name == "pi" => Ok(Value::Fixed(PI)),
            None => Err(unknown(name, quantities)),
        };
        let values = formula.names.iter().map(named).collect::<Result<_, _>>()?;
        self.steps.push(Step { formula: Arc::new(formula), values });
        Ok(Value::Worked(self.steps.len() - 1))
    }

    /// The numbers of a draw; without one, of values in the middle of their laws.
    pub(super) fn numbers<'a>(&'a self, draw: Option<&'a Drawn>) -> Numbers<'a> {
        let draw = draw.unwrap_or(&self.middle);
        let Drawn { numbers: drawn, turns, tables } = draw;
        let mut numbers = Numbers { drawn, worked: Vec::with_capacity(self.steps.len()), turns, tables };
        for step in &self.steps {
            let values: Vec<Range> = step.values.iter().map(|value| Range::point(value.of(&numbers))).collect();
            numbers.worked.push(step.formula.of(&values).0);
        }
        numbers
    }
}

/// Collects variables.
#[derive(Debug, Default)]
pub(super) struct Collector {
    pub(super) vars: Vec<Var>,
    pub(super) slots: Vec<Slot>,
    /// Indices of the variables of each body, material and the like.
    pub(super) groups: Vec<Vec<usize>>,
    /// What each drawn number may be, and a value in the middle of its law.
    drawn: Vec<(Range, f64)>,
    /// Orientations, and tables with random bumps.
    turns: usize,
    tables: usize,
    steps: Vec<Step>,
    /// What each may come to, and as a sum of multiples of values, or itself.
    worked: Vec<(Range, Linear<Value>)>,
    /// The variable of each drawn number, and those from which each formula follows.
    pub(super) var_of: Vec<usize>,
    vars_of: Vec<Vec<usize>>,
    /// Variables of what is being read.
    used: BTreeSet<usize>,
    pub(super) quantities: BTreeMap<String, Value>,
    /// Formulas that were read, by their texts: those of an array are read once.
    read: BTreeMap<String, Arc<Formula>>,
}

/// What is named, for its variables: `ball`, at the key `world.custom.bodies[0]`.
#[derive(Debug, Clone, Copy)]
pub(super) struct Owner<'a> {
    pub(super) name: &'a str,
    pub(super) key: &'a str,
    /// Of an array: which it is, from 0, and how many there are.
    pub(super) nth: Option<[u32; 2]>,
}

impl<'a> Owner<'a> {
    pub(super) fn new(name: &'a str, key: &'a str) -> Self {
        Self { name, key, nth: None }
    }

    pub(super) fn wrong(&self, key: &str, message: impl std::fmt::Display) -> ConfigError {
        ConfigError::new(format!("{}.{key}", self.key), message)
    }
}

impl Collector {
    /// The formula of a text.
    pub(super) fn read(&mut self, text: &str) -> Result<Arc<Formula>, String> {
        if let Some(known) = self.read.get(text) {
            return Ok(Arc::clone(known));
        }
        let formula = Arc::new(Formula::read(text)?);
        self.read.insert(text.to_owned(), Arc::clone(&formula));
        Ok(formula)
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
        self.used.insert(self.vars.len());
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
        let value = self.value(owner, key, short, amount)?;
        self.used.extend(self.follows_from(value));
        let Range(low, high) = self.range(value);
        let is_worked_out = matches!((amount, value), (Amount::Said(_), Value::Fixed(_)));
        if is_worked_out && !(M::LEAST..=M::MOST).contains(&low) {
            let [least, most] = [M::LEAST, M::MOST];
            return Err(owner.wrong(key, format!("its value is {low}: it must be from {least} to {most}")));
        }
        if M::DOMAIN.holds([low, high]) {
            return Ok(value);
        }
        let bounded = match amount {
            Amount::Law(law, _) => law.bounded(),
            _ => "quantities with other ends, or max(…) and min(…), keep it there",
        };
        let must = M::DOMAIN.words();
        let message = format!("its values go from {low} to {high}, and must be {must}: {bounded}");
        Err(owner.wrong(key, message))
    }

    /// The variables from which a value follows.
    pub(super) fn follows_from(&self, value: Value) -> Vec<usize> {
        match value {
            Value::Fixed(_) => Vec::new(),
            Value::Drawn(index) => vec![self.var_of[index]],
            Value::Worked(index) => self.vars_of[index].clone(),
        }
    }

    /// The variables of the numbers that were read since the last call.
    pub(super) fn used(&mut self) -> Vec<usize> {
        std::mem::take(&mut self.used).into_iter().collect()
    }

    /// Between which ends a value is.
    pub(super) fn ends(&self, value: Value) -> (f64, f64) {
        let Range(low, high) = self.range(value);
        (low, high)
    }

    /// What a value may be.
    fn range(&self, value: Value) -> Range {
        match value {
            Value::Fixed(value) => Range::point(value),
            Value::Drawn(index) => self.drawn[index].0,
            Value::Worked(index) => self.worked[index].0,
        }
    }

    pub(super) fn linear(&self, value: Value) -> Linear<Value> {
        match value {
            Value::Fixed(number) => Linear::number(number),
            Value::Drawn(_) => Linear::value(value),
            Value::Worked(index) => self.worked[index].1.clone(),
        }
    }

    /// The least that the sum of some values may be above another.
    pub(super) fn least_gap(&self, below: Value, above: &[Value]) -> f64 {
        let gap = above.iter().fold(self.linear(below).times(-1.0), |gap, one| gap.plus(&self.linear(*one)));
        gap.range(|value| self.range(value)).0
    }

    /// Three numbers: coordinates, edges, angles.
    pub(super) fn three<M: Measure>(
        &mut self,
        owner: &Owner<'_>,
        key: &str,
        shorts: [&str; 3],
        amounts: &[Amount<M>; 3],
    ) -> Result<Values, ConfigError> {
        let mut one = |axis: usize| self.number(owner, &format!("{key}[{axis}]"), shorts[axis], &amounts[axis]);
        Ok([one(0)?, one(1)?, one(2)?])
    }

    fn value<M: Measure>(
        &mut self,
        owner: &Owner<'_>,
        key: &str,
        short: &str,
        amount: &Amount<M>,
    ) -> Result<Value, ConfigError> {
        let wrong = |message: String| owner.wrong(key, message);
        match amount {
            Amount::Fixed(value) => Ok(Value::Fixed(*value)),
            Amount::Said(text) => match self.quantities.get(text) {
                Some(value) => Ok(*value),
                None => self.worked(owner, short, text).map_err(wrong),
            },
            Amount::Law(law, _) => {
                let name = if short.is_empty() { owner.name.to_owned() } else { format!("{}.{short}", owner.name) };
                self.drawn(law, name, M::UNIT, M::DOMAIN).map_err(wrong)
            }
        }
    }

    /// A new variable.
    pub(super) fn drawn(
        &mut self,
        law: &LawOf,
        name: String,
        unit: &'static str,
        domain: Domain,
    ) -> Result<Value, String> {
        let (made, [low, high]) = law.law(domain)?;
        let index = self.drawn.len();
        self.var_of.push(self.vars.len());
        self.add(Var::new(name, unit, made).column(1.0), Slot::Number(index));
        let centre = match domain {
            Domain::Any | Domain::Turn | Domain::Plain => law.centre(),
            Domain::NotNegative | Domain::Share => law.centre().max(0.0),
        };
        self.drawn.push((Range(low, high), centre));
        Ok(Value::Drawn(index))
    }

    /// What a formula comes to. Each of its laws is a new variable.
    fn worked(&mut self, owner: &Owner<'_>, short: &str, text: &str) -> Result<Value, String> {
        let formula = self.read(text)?;
        let mut values = Vec::with_capacity(formula.names.len() + formula.laws());
        for name in &formula.names {
            values.push(self.named(owner, name)?);
        }
        for place in 0..formula.laws() {
            let ranges: Vec<Range> = values.iter().map(|value| self.range(*value)).collect();
            let which = if place == 0 { String::new() } else { format!("_{}", place + 1) };
            let dot = if short.is_empty() { "" } else { "." };
            let name = format!("{}{dot}{short}.law{which}", owner.name);
            values.push(match formula.law(place, &ranges) {
                Some(law) => self.drawn(&law, name, "", Domain::Any)?,
                None => self.given(&formula, place, &values, &name)?,
            });
        }
        self.step(formula, values)
    }

    /// What a formula without laws comes to, for these meanings of its names.
    pub(super) fn follows(&mut self, text: &str, means: &[(&str, Value)]) -> Result<Value, String> {
        let formula = self.read(text)?;
        let meaning = |name: &String| means.iter().find(|(known, _)| known == name).map(|(_, value)| *value);
        let values: Option<Vec<Value>> = formula.names.iter().map(meaning).collect();
        self.step(formula, values.ok_or("a name without a meaning: a bug")?)
    }

    /// A formula whose values are known.
    pub(super) fn step(&mut self, formula: Arc<Formula>, values: Vec<Value>) -> Result<Value, String> {
        let ranges: Vec<Range> = values.iter().map(|value| self.range(*value)).collect();
        let range = formula.of(&ranges);
        if !range.is_number() {
            return Err("may be undefined: it divides by what may be 0, or takes a root or power of what may be \
                        negative"
                .into());
        }
        if values.iter().all(|value| value.is_fixed()) {
            return Ok(Value::Fixed(range.0));
        }
        let mut vars: Vec<usize> = values.iter().flat_map(|value| self.follows_from(*value)).collect();
        vars.sort_unstable();
        vars.dedup();
        self.vars_of.push(vars);
        let linear: Vec<Linear<Value>> = values.iter().map(|value| self.linear(*value)).collect();
        let value = Value::Worked(self.steps.len());
        self.worked.push((range, formula.linear(&linear).unwrap_or_else(|| Linear::value(value))));
        self.steps.push(Step { formula, values });
        Ok(value)
    }

    /// What a name in a formula means.
    fn named(&self, owner: &Owner<'_>, name: &str) -> Result<Value, String> {
        if let Some(value) = self.quantities.get(name) {
            return Ok(*value);
        }
        match (name, owner.nth) {
            ("pi", _) => return Ok(Value::Fixed(PI)),
            ("i", Some([nth, _])) => return Ok(Value::Fixed(f64::from(nth))),
            ("n", Some([_, count])) => return Ok(Value::Fixed(f64::from(count))),
            ("i" | "n", None) => return Err(format!("{name:?} counts in arrays: it needs a `count` in this table")),
            _ => {}
        }
        let counting = "; `i` counts the bodies of an array from 0, `n` is their number";
        let counts = if owner.nth.is_some() { counting } else { "" };
        Err(format!("{}{counts}", unknown(name, &self.quantities)))
    }

    /// An orientation that is random as a whole: its place among those of the draw.
    pub(super) fn turn(&mut self, owner: &Owner<'_>) -> usize {
        let index = self.turns;
        self.turns += 1;
        self.add(Var::new(format!("{}.turn", owner.name), "", Law::Own), Slot::Turn(index));
        index
    }

    /// A table with random bumps, or the scores of impacts: its place among those of the draw.
    pub(super) fn table(&mut self, name: String) -> usize {
        let index = self.tables;
        self.tables += 1;
        self.add(Var::new(name, "", Law::Own), Slot::Table(index));
        index
    }

    /// A draw with places for all values.
    pub(super) fn empty(&self) -> Drawn {
        Drawn {
            numbers: vec![0.0; self.drawn.len()],
            turns: vec![DQuat::IDENTITY; self.turns],
            tables: vec![Bumps::default(); self.tables],
        }
    }

    /// The way from draws to numbers.
    pub(super) fn works(&self) -> Works {
        let numbers = self.drawn.iter().map(|(_, centre)| *centre).collect();
        Works { steps: self.steps.clone(), middle: Drawn { numbers, ..self.empty() } }
    }
}

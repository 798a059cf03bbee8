//! A shape with its numbers as values, and how they are read.

use super::{Amount, Collector, ConfigError, Made, Numbers, Owner, Value, Values, WorldError};
use crate::custom::amount::Measure;
use glam::DVec3;
use std::fmt;
use std::sync::Arc;

/// Makes a shape of a draw's numbers.
type Make = dyn Fn(&Numbers<'_>) -> Result<Made, WorldError> + Send + Sync;

/// A function that copies share.
pub(super) struct Shared<F: ?Sized>(pub(super) Arc<F>);

impl<F: ?Sized> Clone for Shared<F> {
    fn clone(&self) -> Self {
        Self(Arc::clone(&self.0))
    }
}

impl<F: ?Sized> fmt::Debug for Shared<F> {
    fn fmt(&self, to: &mut fmt::Formatter<'_>) -> fmt::Result {
        to.write_str("a function")
    }
}

/// In what way a shape is round.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::custom) enum Round {
    /// In none.
    Not,
    /// No axis of it is told from another.
    Ball,
    /// About its z axis, and half a turn about a level axis maps it to itself.
    Rod,
    /// In another way.
    Partly,
    /// As a solid of revolution, which is not made of convex pieces.
    Turned,
}

/// A shape with its numbers as values.
#[derive(Debug, Clone)]
pub(in crate::custom) struct Form {
    pub(super) make: Shared<Make>,
    /// Whether no draw changes it.
    pub(in crate::custom) is_fixed: bool,
    pub(in crate::custom) round: Round,
    /// What is simulated otherwise than said or drawn, in words.
    pub(in crate::custom) note: Option<String>,
    /// Radii of its edges, other than a capsule's.
    pub(in crate::custom) roundings: Vec<Value>,
    /// Whether its drawn triangles are all of its surface, and look the same way in every draw.
    pub(in crate::custom) is_angular: bool,
    /// Edges and rounding, if it is a box.
    pub(in crate::custom) cuboid: Option<(Values, Value)>,
    /// The directions that point up where each of its numbers is read, if it is a die.
    pub(in crate::custom) marks: Vec<DVec3>,
}

impl Form {
    /// Whether edges of it are rounded, other than a capsule's.
    pub(in crate::custom) fn is_rounded(&self, numbers: &Numbers<'_>) -> bool {
        self.roundings.iter().any(|rounding| rounding.of(numbers) > 0.0)
    }

    /// Edges in m of a box that is sharp.
    pub(in crate::custom) fn sharp_box(&self, numbers: &Numbers<'_>) -> Option<DVec3> {
        let (size, _) = self.cuboid.as_ref().filter(|(_, rounding)| rounding.of(numbers) == 0.0)?;
        Some(super::vector(size, numbers) * super::MM)
    }

    /// The shape of a draw.
    pub(in crate::custom) fn make(&self, numbers: &Numbers<'_>) -> Result<Made, WorldError> {
        (self.make.0)(numbers)
    }
}

/// Reads the numbers of a table of `owner`.
#[derive(Debug)]
pub(in crate::custom) struct Reader<'a> {
    pub(super) collector: &'a mut Collector,
    pub(super) owner: &'a Owner<'a>,
    /// The table's key and a dot; nothing for that of the owner.
    pub(super) key: String,
    /// Names of variables begin with this.
    prefix: String,
    /// Whether no draw changes what was read.
    pub(super) is_fixed: bool,
}

impl<'a> Reader<'a> {
    /// Of the owner's own table.
    pub(in crate::custom) fn new(collector: &'a mut Collector, owner: &'a Owner<'a>) -> Self {
        Self { collector, owner, key: String::new(), prefix: String::new(), is_fixed: true }
    }

    /// Of a table in this one. Whether draws change what it reads is its own `is_fixed`.
    pub(super) fn within(&mut self, name: &str, prefix: &str) -> Reader<'_> {
        let (key, prefix) = (format!("{}{name}.", self.key), format!("{}{prefix}", self.prefix));
        Reader { collector: self.collector, owner: self.owner, key, prefix, is_fixed: true }
    }

    /// The number at the key `name`, whose variable is called after `short`.
    pub(super) fn number<M: Measure>(
        &mut self,
        name: &str,
        short: &str,
        amount: &Amount<M>,
    ) -> Result<Value, ConfigError> {
        let (key, short) = (format!("{}{name}", self.key), format!("{}{short}", self.prefix));
        let value = self.collector.number(self.owner, &key, &short, amount)?;
        self.is_fixed &= value.is_fixed();
        Ok(value)
    }

    /// Three numbers, whose variables are called after `short` and an axis.
    pub(super) fn three<M: Measure>(
        &mut self,
        name: &str,
        short: &str,
        amounts: &[Amount<M>; 3],
    ) -> Result<Values, ConfigError> {
        let mut one = |axis: usize, letter: &str| {
            self.number(&format!("{name}[{axis}]"), &format!("{short}{letter}"), &amounts[axis])
        };
        Ok([one(0, "x")?, one(1, "y")?, one(2, "z")?])
    }

    /// What is wrong at the key `name`.
    pub(super) fn wrong(&self, name: &str, message: impl fmt::Display) -> ConfigError {
        self.owner.wrong(&format!("{}{name}", self.key), message)
    }

    /// The shape of the numbers that were read, if nothing else is special about it.
    pub(super) fn form(
        &self,
        round: Round,
        make: impl Fn(&Numbers<'_>) -> Result<Made, WorldError> + Send + Sync + 'static,
    ) -> Form {
        Form {
            make: Shared(Arc::new(make)),
            is_fixed: self.is_fixed,
            round,
            note: None,
            roundings: Vec::new(),
            is_angular: false,
            cuboid: None,
            marks: Vec::new(),
        }
    }
}

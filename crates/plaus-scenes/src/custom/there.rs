//! Which bodies are there: most in every draw, optional ones in some.

use super::amount::{Amount, Chance};
use super::laws::{LawOf, Several};
use super::values::{Collector, Numbers, Owner, Value};
use crate::scene::ConfigError;

/// A body is there from this value on.
const ENOUGH: f64 = 0.5;

/// Whether a body is there, once a draw is known.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum There {
    Always,
    /// Where this value is large enough.
    Where(Value),
}

impl There {
    /// What the key `present` says. A known number is a probability: whether the body is there becomes a variable that
    /// is 1 or 0.
    pub(super) fn new(
        collector: &mut Collector,
        owner: &Owner<'_>,
        said: Option<&Amount<Chance>>,
    ) -> Result<Self, ConfigError> {
        let Some(said) = said else { return Ok(Self::Always) };
        let value = collector.number(owner, "present", "present", said)?;
        let (low, high) = collector.ends(value);
        match value {
            Value::Fixed(chance) if chance > 0.0 && chance < 1.0 => {
                // The first value stands for the middle of the law: what is shown without a draw has all bodies.
                let law = LawOf::Choice(Several { of: vec![1.0, 0.0], weights: vec![chance, 1.0 - chance] });
                let drawn = Amount::<Chance>::of(law);
                collector.number(owner, "present", "present", &drawn).map(Self::Where)
            }
            _ if matches!(said, Amount::Law(..)) && (low >= ENOUGH || high < ENOUGH) => {
                let always = if low >= ENOUGH { "always" } else { "never" };
                let message = format!(
                    "a body is there where this value is at least {ENOUGH}, so with values from {low} to {high} it \
                     {always} is: give the probability itself, such as 0.7"
                );
                Err(owner.wrong("present", message))
            }
            _ if low >= ENOUGH => Ok(Self::Always),
            _ => Ok(Self::Where(value)),
        }
    }

    pub(super) fn of(self, numbers: &Numbers<'_>) -> bool {
        match self {
            Self::Always => true,
            Self::Where(value) => value.of(numbers) >= ENOUGH,
        }
    }
}

/// The place of a body of the plan among those that are there, of which it is one.
pub(super) fn place(there: &[usize], body: usize) -> usize {
    there.partition_point(|&one| one < body)
}

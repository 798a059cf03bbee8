//! A number with a name.

use super::amount::{self, Amount};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A number with a name, which other numbers can refer to.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Quantity {
    /// Its name.
    pub name: String,
    /// Its value, in the unit of the keys that name it: a number, a law, or arithmetic with other quantities.
    pub value: Amount<amount::Plain>,
}

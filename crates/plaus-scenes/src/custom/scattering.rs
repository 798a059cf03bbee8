//! Impacts of real, imperfect surfaces: how much those of a material differ.

use super::amount::{self, Amount};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// How much impacts of a material differ from each other: each has a normal and a restitution of its own. Between two
/// materials, these standard deviations are the roots of the sums of their squares. Contacts that last do not scatter,
/// nor do impacts after which a contact lasts (all, where the restitution is 0), at the ends of joints, and within
/// large heaps, whose steps take them up.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Scattering {
    /// Standard deviation of the tilt of an impact's normal, in each of two directions.
    pub normal_deg: Amount<amount::Tilt>,
    /// Standard deviation of an impact's restitution, over the restitution. It is cut off at 0 and 1.
    pub restitution: Amount<amount::Spread>,
}

impl Scattering {
    pub(super) fn is_unset(&self) -> bool {
        *self == Self::default()
    }
}

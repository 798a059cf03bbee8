//! What bodies are simulated as.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// What bodies are simulated as.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Mechanics {
    /// Bodies of any shape, which turn.
    #[default]
    Turning,
    /// Balls whose orientation does not matter, several times faster. They meet planes, boxes, hulls, meshes and ground
    /// by its heights.
    Marbles,
}

impl Mechanics {
    pub(super) fn is_default(&self) -> bool {
        *self == Self::default()
    }
}

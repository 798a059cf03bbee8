//! Scenario keys of the dice's moves.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Which moves the chain makes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Moves {
    /// All moves, by `weights`.
    #[default]
    Mixed,
    /// The paper's three: one control point of the table, one initial component, everything; by their `weights`.
    Paper,
}

/// Relative weights of the moves.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Weights {
    /// The paper's: everything is drawn anew.
    #[schemars(range(min = 0.0, max = 1e6))]
    pub everything: f64,
    /// The paper's: one number of one die's initial conditions, or its orientation, is changed.
    #[schemars(range(min = 0.0, max = 1e6))]
    pub component: f64,
    /// The paper's: one control point of the table, wherever it is, is changed.
    #[schemars(range(min = 0.0, max = 1e6))]
    pub point: f64,
    /// A control point near one of the collisions of the current animation is changed.
    #[schemars(range(min = 0.0, max = 1e6))]
    pub near: f64,
    /// One die's throw is drawn anew, and so is its table where it has one of its own.
    #[schemars(range(min = 0.0, max = 1e6))]
    pub rethrow: f64,
    /// A die gets a fresh throw, and a fresh table where it has one of its own, from the place from where, tried out,
    /// it comes to rest near its target with a demanded face up.
    #[schemars(range(min = 0.0, max = 1e6))]
    pub recast: f64,
    /// Like recast, with throws that are tried until one is likely under the prior and comes to rest near its target;
    /// for dice thrown onto one table.
    #[schemars(range(min = 0.0, max = 1e6))]
    pub pick: f64,
    /// A die's throw begins in another of the orientations that its symmetry makes equal: another face comes up, and
    /// nothing else changes.
    #[schemars(range(min = 0.0, max = 1e6))]
    pub turn: f64,
    /// A die's throw is shifted so that it comes to rest near its target, and so is its table where it has one of its
    /// own.
    #[schemars(range(min = 0.0, max = 1e6))]
    pub shift: f64,
}

impl Weights {
    /// What is left of them where only the paper's moves are made.
    #[must_use]
    pub fn paper(self) -> Self {
        Self { near: 0.0, rethrow: 0.0, recast: 0.0, pick: 0.0, turn: 0.0, shift: 0.0, ..self }
    }
}

impl Default for Weights {
    fn default() -> Self {
        Self {
            everything: 0.01,
            component: 0.2,
            point: 0.04,
            near: 0.2,
            rethrow: 0.05,
            recast: 0.2,
            pick: 0.1,
            turn: 0.15,
            shift: 0.15,
        }
    }
}

/// Sizes of the moves' steps. A change leaves the prior as it is: a number at z standard deviations from its mean goes
/// to `√(1 − s²) z + s ξ`, with ξ a standard normal number, and s drawn anew for each change between the two ends given
/// here, uniformly in its logarithm.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Steps {
    /// The smallest s for initial conditions.
    #[schemars(range(min = 1e-9, max = 1.0))]
    pub component_least: f64,
    /// The largest.
    #[schemars(range(min = 1e-9, max = 1.0))]
    pub component_most: f64,
    /// The smallest s for control points.
    #[schemars(range(min = 1e-9, max = 1.0))]
    pub point_least: f64,
    /// The largest. 1 draws a value anew.
    #[schemars(range(min = 1e-9, max = 1.0))]
    pub point_most: f64,
    /// Standard deviation, about the target, of the place that a shift aims at.
    #[schemars(extend("minimum" = 0.001, "maximum" = 1000.0, "x-unit" = "mm"))]
    pub shift_sd_mm: f64,
    /// The same for a recast. Where dice meet, or bumps are large, it should be about as large as what these make of
    /// where a die comes to rest.
    #[schemars(extend("minimum" = 0.001, "maximum" = 1000.0, "x-unit" = "mm"))]
    pub recast_sd_mm: f64,
    /// How near its target a die must come to rest, alone on its table, for a throw to be picked: the standard
    /// deviation of the chance that it is.
    #[schemars(extend("minimum" = 0.001, "maximum" = 1000.0, "x-unit" = "mm"))]
    pub pick_sd_mm: f64,
}

impl Default for Steps {
    fn default() -> Self {
        Self {
            component_least: 0.001,
            component_most: 1.0,
            point_least: 0.01,
            point_most: 1.0,
            shift_sd_mm: 5.0,
            recast_sd_mm: 5.0,
            pick_sd_mm: 5.0,
        }
    }
}

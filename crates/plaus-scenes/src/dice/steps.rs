//! Scenario keys of the dice's moves.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Sizes of the moves' steps. A step preserves the prior: a number at z standard deviations from its mean goes to `√(1
/// − s²) z + s ξ`, where ξ is a standard normal number. For each step, s is drawn between the two ends given here,
/// uniformly in its logarithm.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Steps {
    /// The smallest s for initial conditions.
    #[schemars(range(min = 1e-9, max = 1.0))]
    pub component_least: f64,
    /// The largest s for initial conditions.
    #[schemars(range(min = 1e-9, max = 1.0))]
    pub component_most: f64,
    /// The smallest s for control points.
    #[schemars(range(min = 1e-9, max = 1.0))]
    pub point_least: f64,
    /// The largest s for control points. 1 draws a value anew.
    #[schemars(range(min = 1e-9, max = 1.0))]
    pub point_most: f64,
    /// Standard deviation, around the target, of the place that a shift aims at.
    #[schemars(extend("minimum" = 0.001, "maximum" = 1000.0, "x-unit" = "mm"))]
    pub shift_sd_mm: f64,
    /// The same for a recast. If dice meet, or bumps are large, it should be about as large as their effect on where a
    /// die comes to rest.
    #[schemars(extend("minimum" = 0.001, "maximum" = 1000.0, "x-unit" = "mm"))]
    pub recast_sd_mm: f64,
    /// How near its target a die must come to rest, alone on its table, for a throw to be picked: the standard
    /// deviation of the probability that it is picked.
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

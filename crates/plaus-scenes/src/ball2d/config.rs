//! Scenario keys of the 2D ball.

use super::moves::Ball2dMoves;
use crate::model::{Moves, Weights};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Most collisions a draw can hold.
pub const MAX_COLLISIONS: u32 = 64;

/// A ball bounces on a table whose surface normal is uncertain at every bounce (Chenney & Forsyth 2000, sections 3 and
/// 5.1).
///
/// Lengths are in ball diameters D. The ball is a point for its collisions with the plane, as in the paper.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Config {
    /// How far the ball falls before its first bounce, in D. The paper's "height of 4.5 D" means 4.5 if it is the
    /// height of the ball's lowest point, or if the ball is a point, and 4 if it is that of the centre.
    #[schemars(extend("minimum" = 1e-9, "maximum" = 1e6, "x-unit" = "D"))]
    pub drop_height: f64,
    /// Number of bounces before the ball rests; each has a random normal.
    #[schemars(range(min = 1, max = 64))]
    pub collisions: u32,
    /// Factor on the normal component of the velocity at a bounce; 1/√2 in the paper.
    #[schemars(range(min = 0.0, max = 1.0))]
    pub restitution: f64,
    /// Standard deviation of each normal's angle from the vertical, in degrees.
    #[schemars(extend("minimum" = 1e-9, "maximum" = 90.0, "x-unit" = "degree"))]
    pub sigma_theta_deg: f64,
    /// Where the ball should come to rest, in D from where it is dropped.
    #[schemars(extend("minimum" = -1e6, "maximum" = 1e6, "x-unit" = "D"))]
    pub target: f64,
    /// Whether `target` is asked for. If not, only `[[require]]` says what must happen. Unset: yes.
    #[schemars(extend("x-example" = false))]
    pub constrained: Option<bool>,
    /// Standard deviation of the constraint on where the ball rests, in D: smaller is stricter.
    #[schemars(extend("minimum" = 1e-9, "maximum" = 1e6, "x-unit" = "D"))]
    pub sigma_d: f64,
    /// A ball that rests closer to the target than this satisfies the constraint, in D.
    #[schemars(extend("minimum" = 1e-9, "maximum" = 1e6, "x-unit" = "D"))]
    pub tolerance: f64,
    /// What happens if a bounce would leave the ball moving into the table.
    pub downward: Downward,
    /// Which moves: "mixed", or "paper" for the paper's only one.
    pub moves: Moves,
    /// Relative weights of the moves in "mixed".
    pub weights: Weights<Ball2dMoves>,
    /// Half width of the paper's random step in an angle, in degrees.
    #[schemars(extend("minimum" = 1e-9, "maximum" = 180.0, "x-unit" = "degree"))]
    pub step_deg: f64,
    /// Two solutions are the same if all their bounces fall into the same cells of this width, in D.
    #[schemars(extend("minimum" = 1e-9, "maximum" = 1e6, "x-unit" = "D"))]
    pub distinct_cell: f64,
    /// The ball's diameter in metres. It sets the size and, with gravity, the duration of exported animations. It has
    /// no influence on what is sampled.
    #[schemars(extend("minimum" = 1e-9, "maximum" = 1000.0, "x-unit" = "m"))]
    pub diameter_m: f64,
}

impl Config {
    /// Whether the scene asks for something itself.
    pub(super) fn is_constrained(&self) -> bool {
        self.constrained != Some(false)
    }
}

impl Default for Config {
    fn default() -> Self {
        Self {
            drop_height: 4.5,
            collisions: 5,
            restitution: std::f64::consts::FRAC_1_SQRT_2,
            sigma_theta_deg: 10.0,
            target: 1.0,
            constrained: None,
            sigma_d: 0.1,
            tolerance: 0.1,
            downward: Downward::default(),
            moves: Moves::default(),
            weights: Weights::default(),
            step_deg: 5.0,
            distinct_cell: 0.5,
            diameter_m: 0.1,
        }
    }
}

/// What happens if the reflected velocity still points into the table, or along it, because the normal leans so far
/// that the reflection does not lift the ball.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Downward {
    /// The remaining downward component is turned upwards.
    Mirror,
    /// The draw has density 0.
    Reject,
    /// The vertical component is lost: the ball slides through its remaining bounces in place.
    Zero,
    /// The ball bounces as if the table were level.
    Level,
    /// The ball goes back the way it came, slowed by the restitution.
    #[default]
    Back,
}

//! Scenario keys of the 2D ball.

use super::moves::Ball2dMoves;
use crate::model::{Moves, Weights};
use crate::settings::settings;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Most collisions a draw can hold.
pub const MAX_COLLISIONS: u32 = 64;

settings! {
    /// A ball bounces on a table whose surface normal is uncertain at every bounce (Chenney & Forsyth 2000, sections 3
    /// and 5.1).
    ///
    /// Lengths are in ball diameters D. The ball is a point for its collisions with the plane, as in the paper.
    pub struct Config {
        /// How far the ball falls before its first bounce, in D. The paper's "height of 4.5 D" means 4.5 if it is the
        /// height of the ball's lowest point, or if the ball is a point, and 4 if it is that of the centre.
        drop_height: f64 = 4.5, 1e-9..=1e6, "D";
        /// Number of bounces before the ball rests; each has a random normal.
        collisions: u32 = 5, 1..=64;
        /// Factor on the normal component of the velocity at a bounce; 1/√2 in the paper.
        restitution: f64 = std::f64::consts::FRAC_1_SQRT_2, 0.0..=1.0;
        /// Standard deviation of each normal's angle from the vertical, in degrees.
        sigma_theta_deg: f64 = 10.0, 1e-9..=90.0, "degree";
        /// Where the ball should come to rest, in D from where it is dropped.
        #[schemars(extend("x-goal" = true))]
        target: f64 = 1.0, -1e6..=1e6, "D";
        /// Whether `target` is asked for. If not, only `[[require]]` says what must happen. Unset: yes.
        #[schemars(extend("x-example" = false))]
        constrained: Option<bool>;
        /// Standard deviation of the constraint on where the ball rests, in D: smaller is stricter.
        sigma_d: f64 = 0.1, 1e-9..=1e6, "D";
        /// A ball that rests closer to the target than this satisfies the constraint, in D.
        tolerance: f64 = 0.1, 1e-9..=1e6, "D";
        /// What happens if a bounce would leave the ball moving into the table.
        downward: Downward;
        /// Which moves: "mixed", or "paper" for the paper's only one.
        moves: Moves;
        /// Relative weights of the moves in "mixed".
        weights: Weights<Ball2dMoves>;
        /// Half width of the paper's random step in an angle, in degrees.
        step_deg: f64 = 5.0, 1e-9..=180.0, "degree";
        /// Two solutions are the same if all their bounces fall into the same cells of this width, in D.
        distinct_cell: f64 = 0.5, 1e-9..=1e6, "D";
        /// The ball's diameter in metres. It sets the size and, with gravity, the duration of exported animations. It
        /// has no influence on what is sampled.
        diameter_m: f64 = 0.1, 1e-9..=1000.0, "m";
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

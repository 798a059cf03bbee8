//! Scenario keys of the dice.

use super::constraint::Constraint;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::moves::DiceMoves;
pub use super::steps::Steps;
use crate::accuracy::AccuracyPreset;
use crate::model::{Moves, Weights};

/// Most dice.
pub const MOST_DICE: u32 = 24;

/// Dice are thrown onto a table whose height, restitution and friction are random, and should end as `constraints` ask
/// (Chenney & Forsyth 2000, section 5.4).
///
/// The table lies at z = 0 with its middle at x = y = 0; z points up. Lengths are in millimetres, speeds in metres per
/// second.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Config {
    /// How many dice are thrown.
    #[schemars(range(min = 1, max = 24))]
    pub dice: u32,
    /// Whether the dice are thrown onto one table, where they can meet. If not, each is thrown alone onto a random
    /// table of its own, and the animations are overlaid, as in the paper's figure 9.
    pub together: bool,
    /// What should happen: a list of tables, each with one of `rest_at`, `face_up`, `pose_at`, `passes` and
    /// `first_impact`. Their log densities add up. An animation that meets all of them is a solution.
    #[schemars(length(max = 256))]
    pub constraints: Vec<Constraint>,
    /// Two solutions are the same if every die, observed every `distinct_every_s` until it is at rest, lies in the same
    /// cell of this width with the same face uppermost.
    #[schemars(extend("minimum" = 0.001, "maximum" = 1e6, "x-unit" = "mm"))]
    pub distinct_cell_mm: f64,
    /// Time between two observations of the dice, for telling solutions apart.
    #[schemars(extend("minimum" = 0.001, "maximum" = 60.0, "x-unit" = "s"))]
    pub distinct_every_s: f64,
    /// Time by which every die must be at rest: a throw that takes longer has density 0.
    #[schemars(extend("minimum" = 0.1, "maximum" = 60.0, "x-unit" = "s"))]
    pub longest_s: f64,
    /// How exact the simulation is.
    pub accuracy: AccuracyPreset,
    /// The dice.
    pub die: Die,
    /// How they are thrown.
    pub throw: Throwing,
    /// The table.
    pub table: Table,
    /// A part of the table that differs from the rest, such as a puddle.
    pub spilt: Spilt,
    /// Which moves: "mixed", or "paper" for the paper's three.
    pub moves: Moves,
    /// Relative weights of the moves.
    pub weights: Weights<DiceMoves>,
    /// Sizes of the moves' steps.
    pub steps: Steps,
}

impl Default for Config {
    fn default() -> Self {
        Self {
            dice: 1,
            together: false,
            constraints: Constraint::examples(),
            distinct_cell_mm: 20.0,
            distinct_every_s: 0.1,
            longest_s: 10.0,
            accuracy: AccuracyPreset::default(),
            die: Die::default(),
            throw: Throwing::default(),
            table: Table::default(),
            spilt: Spilt::default(),
            moves: Moves::default(),
            weights: Weights::default(),
            steps: Steps::default(),
        }
    }
}

/// A die. Its faces 1, 2 and 3 lie along its third, second and first axis, and opposite faces add up to seven. With
/// different edges it is a cuboid.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Die {
    /// Length along its first axis, from face 4 to face 3.
    #[schemars(extend("minimum" = 0.5, "maximum" = 500.0, "x-unit" = "mm"))]
    pub edge_x_mm: f64,
    /// Length along its second axis, from face 5 to face 2.
    #[schemars(extend("minimum" = 0.5, "maximum" = 500.0, "x-unit" = "mm"))]
    pub edge_y_mm: f64,
    /// Length along its third axis, from face 6 to face 1.
    #[schemars(extend("minimum" = 0.5, "maximum" = 500.0, "x-unit" = "mm"))]
    pub edge_z_mm: f64,
    /// Radius of its edges and corners, less than half its shortest edge; 0 for sharp ones.
    #[schemars(extend("minimum" = 0.0, "maximum" = 250.0, "x-unit" = "mm"))]
    pub rounding_mm: f64,
    /// Density; celluloid has about 1400, acrylic glass 1180. It has no influence if dice do not meet.
    #[schemars(extend("minimum" = 1.0, "maximum" = 25000.0, "x-unit" = "kg/m³"))]
    pub density: f64,
}

impl Default for Die {
    fn default() -> Self {
        Self { edge_x_mm: 16.0, edge_y_mm: 16.0, edge_z_mm: 16.0, rounding_mm: 1.0, density: 1200.0 }
    }
}

/// The law of the initial conditions: each number is Gaussian and independent of the others, the orientation uniform.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Throwing {
    /// Mean place of release along x.
    #[schemars(extend("minimum" = -1e4, "maximum" = 1e4, "x-unit" = "mm"))]
    pub x_mm: f64,
    /// Mean place of release along y.
    #[schemars(extend("minimum" = -1e4, "maximum" = 1e4, "x-unit" = "mm"))]
    pub y_mm: f64,
    /// Mean height of the die's middle at its release. The law is cut off where the die would reach into the table.
    #[schemars(extend("minimum" = 0.0, "maximum" = 1e4, "x-unit" = "mm"))]
    pub z_mm: f64,
    /// Standard deviation of the place of release, along x and along y.
    #[schemars(extend("minimum" = 1e-6, "maximum" = 1000.0, "x-unit" = "mm"))]
    pub place_sd_mm: f64,
    /// Standard deviation of the height.
    #[schemars(extend("minimum" = 1e-6, "maximum" = 1000.0, "x-unit" = "mm"))]
    pub height_sd_mm: f64,
    /// Mean velocity along x.
    #[schemars(extend("minimum" = -20.0, "maximum" = 20.0, "x-unit" = "m/s"))]
    pub vx: f64,
    /// Mean velocity along y.
    #[schemars(extend("minimum" = -20.0, "maximum" = 20.0, "x-unit" = "m/s"))]
    pub vy: f64,
    /// Mean velocity upwards.
    #[schemars(extend("minimum" = -20.0, "maximum" = 20.0, "x-unit" = "m/s"))]
    pub vz: f64,
    /// Standard deviation of each component of the velocity.
    #[schemars(extend("minimum" = 1e-6, "maximum" = 20.0, "x-unit" = "m/s"))]
    pub velocity_sd: f64,
    /// Standard deviation of each component of the angular velocity; its mean is 0.
    #[schemars(extend("minimum" = 1e-6, "maximum" = 500.0, "x-unit" = "rad/s"))]
    pub spin_sd: f64,
    /// Distance along y between the mean places of release of neighbouring dice; the middle of the row is at `y_mm`.
    #[schemars(extend("minimum" = 0.0, "maximum" = 1000.0, "x-unit" = "mm"))]
    pub apart_mm: f64,
}

impl Default for Throwing {
    fn default() -> Self {
        Self {
            x_mm: -150.0,
            y_mm: 0.0,
            z_mm: 100.0,
            place_sd_mm: 30.0,
            height_sd_mm: 15.0,
            vx: 0.9,
            vy: 0.0,
            vz: -0.2,
            velocity_sd: 0.2,
            spin_sd: 15.0,
            apart_mm: 40.0,
        }
    }
}

/// The table. Its height, restitution and friction are uniform cubic b-splines over control points on a square grid;
/// each control point is random and independent of the others. A draw in which a die leaves the table is impossible.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Table {
    /// Length along x.
    #[schemars(extend("minimum" = 10.0, "maximum" = 1e5, "x-unit" = "mm"))]
    pub length_mm: f64,
    /// Width along y.
    #[schemars(extend("minimum" = 10.0, "maximum" = 1e5, "x-unit" = "mm"))]
    pub width_mm: f64,
    /// Distance between neighbouring control points; the paper does not give one. The default is half a die's edge.
    #[schemars(extend("minimum" = 0.1, "maximum" = 1e4, "x-unit" = "mm"))]
    pub grid_mm: f64,
    /// Standard deviation of the height of a control point about 0; 0 for a flat table. Heights beyond six standard
    /// deviations have density 0.
    #[schemars(extend("minimum" = 0.0, "maximum" = 100.0, "x-unit" = "mm"))]
    pub bumps_mm: f64,
    /// Mean restitution of a control point (Stronge's, of energy), before the law is cut off at 0 and 1.
    #[schemars(range(min = 0.0, max = 1.0))]
    pub bounce: f64,
    /// Its standard deviation; 0 if restitution is not random. At most a twentieth of the law may be cut off.
    #[schemars(range(min = 0.0, max = 1.0))]
    pub bounce_sd: f64,
    /// Mean coefficient of friction of a control point, before the law is cut off at 0.
    #[schemars(range(min = 0.0, max = 10.0))]
    pub grip: f64,
    /// Its standard deviation; 0 if friction is not random. At most a twentieth of the law may be cut off.
    #[schemars(range(min = 0.0, max = 10.0))]
    pub grip_sd: f64,
}

impl Default for Table {
    fn default() -> Self {
        Self {
            length_mm: 600.0,
            width_mm: 400.0,
            grid_mm: 8.0,
            bumps_mm: 0.1,
            bounce: 0.5,
            bounce_sd: 0.05,
            grip: 0.35,
            grip_sd: 0.05,
        }
    }
}

/// A round part of the table with other means of restitution and friction: beer was spilt there.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Spilt {
    /// Its middle along x.
    #[schemars(extend("minimum" = -1e5, "maximum" = 1e5, "x-unit" = "mm"))]
    pub x_mm: f64,
    /// Its middle along y.
    #[schemars(extend("minimum" = -1e5, "maximum" = 1e5, "x-unit" = "mm"))]
    pub y_mm: f64,
    /// Its radius; 0 if nothing was spilt.
    #[schemars(extend("minimum" = 0.0, "maximum" = 1e5, "x-unit" = "mm"))]
    pub radius_mm: f64,
    /// Mean restitution of the control points in it; the spread is the table's.
    #[schemars(range(min = 0.0, max = 1.0))]
    pub bounce: f64,
    /// Mean coefficient of friction of the control points in it; the spread is the table's.
    #[schemars(range(min = 0.0, max = 10.0))]
    pub grip: f64,
}

impl Default for Spilt {
    fn default() -> Self {
        Self { x_mm: -50.0, y_mm: 0.0, radius_mm: 0.0, bounce: 0.3, grip: 0.15 }
    }
}

//! Scenario keys of the dice.

use super::constraint::Constraint;
use super::moves::DiceMoves;
use crate::accuracy::AccuracyPreset;
use crate::model::{Moves, Weights};
use crate::settings::settings;

/// Most dice.
pub const MOST_DICE: u32 = 24;

settings! {
    /// Dice are thrown onto a table whose height, restitution and friction are random, and should end as `constraints`
    /// ask (Chenney & Forsyth 2000, section 5.4).
    ///
    /// The table lies at z = 0 with its middle at x = y = 0; z points up. Lengths are in millimetres, speeds in metres
    /// per second.
    pub struct Config {
        /// How many dice are thrown.
        dice: u32 = 1, 1..=24;
        /// Whether the dice are thrown onto one table, where they can meet. If not, each is thrown alone onto a random
        /// table of its own, and the animations are overlaid, as in the paper's figure 9.
        together: bool;
        /// What should happen: a list of tables, each with one of `rest_at`, `face_up`, `pose_at`, `passes` and
        /// `first_impact`. Their log densities add up. An animation that meets all of them is a solution.
        #[schemars(length(max = 256))]
        #[schemars(extend("x-goal" = true))]
        constraints: Vec<Constraint> = Constraint::examples();
        /// Two solutions are the same if every die, observed every `distinct_every_s` until it is at rest, lies in the
        /// same cell of this width with the same face uppermost.
        distinct_cell_mm: f64 = 20.0, 0.001..=1e6, "mm";
        /// Time between two observations of the dice, for telling solutions apart.
        distinct_every_s: f64 = 0.1, 0.001..=60.0, "s";
        /// Time by which every die must be at rest: a throw that takes longer has density 0.
        longest_s: f64 = 10.0, 0.1..=60.0, "s";
        /// How exact the simulation is.
        accuracy: AccuracyPreset;
        /// The dice.
        die: Die;
        /// How they are thrown.
        throw: Throwing;
        /// The table.
        table: Table;
        /// A part of the table that differs from the rest, such as a puddle.
        spilt: Spilt;
        /// Which moves: "mixed", or "paper" for the paper's three.
        moves: Moves;
        /// Relative weights of the moves.
        weights: Weights<DiceMoves>;
        /// Sizes of the moves' steps.
        steps: Steps;
    }

    /// A die. Its faces 1, 2 and 3 lie along its third, second and first axis, and opposite faces add up to seven. With
    /// different edges it is a cuboid.
    #[derive(Copy)]
    pub struct Die {
        /// Length along its first axis, from face 4 to face 3.
        edge_x_mm: f64 = 16.0, 0.5..=500.0, "mm";
        /// Length along its second axis, from face 5 to face 2.
        edge_y_mm: f64 = 16.0, 0.5..=500.0, "mm";
        /// Length along its third axis, from face 6 to face 1.
        edge_z_mm: f64 = 16.0, 0.5..=500.0, "mm";
        /// Radius of its edges and corners, less than half its shortest edge; 0 for sharp ones.
        rounding_mm: f64 = 1.0, 0.0..=250.0, "mm";
        /// Density; celluloid has about 1400, acrylic glass 1180. It has no influence if dice do not meet.
        density: f64 = 1200.0, 1.0..=25000.0, "kg/m³";
    }

    /// The law of the initial conditions: each number is Gaussian and independent of the others, the orientation
    /// uniform.
    #[derive(Copy)]
    pub struct Throwing {
        /// Mean place of release along x.
        x_mm: f64 = -150.0, -1e4..=1e4, "mm";
        /// Mean place of release along y.
        y_mm: f64 = 0.0, -1e4..=1e4, "mm";
        /// Mean height of the die's middle at its release. The law is cut off where the die would reach into the table.
        z_mm: f64 = 100.0, 0.0..=1e4, "mm";
        /// Standard deviation of the place of release, along x and along y.
        place_sd_mm: f64 = 30.0, 1e-6..=1000.0, "mm";
        /// Standard deviation of the height.
        height_sd_mm: f64 = 15.0, 1e-6..=1000.0, "mm";
        /// Mean velocity along x.
        vx: f64 = 0.9, -20.0..=20.0, "m/s";
        /// Mean velocity along y.
        vy: f64 = 0.0, -20.0..=20.0, "m/s";
        /// Mean velocity upwards.
        vz: f64 = -0.2, -20.0..=20.0, "m/s";
        /// Standard deviation of each component of the velocity.
        velocity_sd: f64 = 0.2, 1e-6..=20.0, "m/s";
        /// Standard deviation of each component of the angular velocity; its mean is 0.
        spin_sd: f64 = 15.0, 1e-6..=500.0, "rad/s";
        /// Distance along y between the mean places of release of neighbouring dice; the middle of the row is at
        /// `y_mm`.
        apart_mm: f64 = 40.0, 0.0..=1000.0, "mm";
    }

    /// The table. Its height, restitution and friction are uniform cubic b-splines over control points on a square
    /// grid; each control point is random and independent of the others. A draw in which a die leaves the table is
    /// impossible.
    #[derive(Copy)]
    pub struct Table {
        /// Length along x.
        length_mm: f64 = 600.0, 10.0..=1e5, "mm";
        /// Width along y.
        width_mm: f64 = 400.0, 10.0..=1e5, "mm";
        /// Distance between neighbouring control points; the paper does not give one. The default is half a die's edge.
        grid_mm: f64 = 8.0, 0.1..=1e4, "mm";
        /// Standard deviation of the height of a control point about 0; 0 for a flat table. Heights beyond six standard
        /// deviations have density 0.
        bumps_mm: f64 = 0.1, 0.0..=100.0, "mm";
        /// Mean restitution of a control point (Stronge's, of energy), before the law is cut off at 0 and 1.
        bounce: f64 = 0.5, 0.0..=1.0;
        /// Its standard deviation; 0 if restitution is not random. At most a twentieth of the law may be cut off.
        bounce_sd: f64 = 0.05, 0.0..=1.0;
        /// Mean coefficient of friction of a control point, before the law is cut off at 0.
        grip: f64 = 0.35, 0.0..=10.0;
        /// Its standard deviation; 0 if friction is not random. At most a twentieth of the law may be cut off.
        grip_sd: f64 = 0.05, 0.0..=10.0;
    }

    /// A round part of the table with other means of restitution and friction: beer was spilt there.
    #[derive(Copy)]
    pub struct Spilt {
        /// Its middle along x.
        x_mm: f64 = -50.0, -1e5..=1e5, "mm";
        /// Its middle along y.
        y_mm: f64 = 0.0, -1e5..=1e5, "mm";
        /// Its radius; 0 if nothing was spilt.
        radius_mm: f64 = 0.0, 0.0..=1e5, "mm";
        /// Mean restitution of the control points in it; the spread is the table's.
        bounce: f64 = 0.3, 0.0..=1.0;
        /// Mean coefficient of friction of the control points in it; the spread is the table's.
        grip: f64 = 0.15, 0.0..=10.0;
    }

    /// Sizes of the moves' steps. A step preserves the prior: a number at z standard deviations from its mean goes to
    /// `√(1 − s²) z + s ξ`, where ξ is a standard normal number. For each step, s is drawn between the two ends given
    /// here, uniformly in its logarithm.
    #[derive(Copy)]
    pub struct Steps {
        /// The smallest s for initial conditions.
        component_least: f64 = 0.001, 1e-9..=1.0;
        /// The largest s for initial conditions.
        component_most: f64 = 1.0, 1e-9..=1.0;
        /// The smallest s for control points.
        point_least: f64 = 0.01, 1e-9..=1.0;
        /// The largest s for control points. 1 draws a value anew.
        point_most: f64 = 1.0, 1e-9..=1.0;
        /// Standard deviation, around the target, of the place that a shift aims at.
        shift_sd_mm: f64 = 5.0, 0.001..=1000.0, "mm";
        /// The same for a recast. If dice meet, or bumps are large, it should be about as large as their effect on
        /// where a die comes to rest.
        recast_sd_mm: f64 = 5.0, 0.001..=1000.0, "mm";
        /// How near its target a die must come to rest, alone on its table, for a throw to be picked: the standard
        /// deviation of the probability that it is picked.
        pick_sd_mm: f64 = 5.0, 0.001..=1000.0, "mm";
    }
}

//! Scenario keys of the balls that spell.

use super::font::Letters;
use super::moves::SpellingMoves;
use crate::accuracy::AccuracyPreset;
use crate::model::{Moves, Weights};
use crate::settings::settings;
use plaus_dist::math;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Most bins along a side of the box.
pub const MOST_COLUMNS: u32 = 64;
/// Most bins along the other side.
pub const MOST_ROWS: u32 = 16;

settings! {
    /// Balls are dropped one after the other into a box of bins, and should come to rest in bins that spell a word
    /// (Chenney & Forsyth 2000, section 5.3 and appendix B).
    ///
    /// The box is seen from above: x along the word, y from its last row of bins to its first. Lengths are in
    /// millimetres.
    pub struct Config {
        /// The word: letters A to Z, digits, spaces and `.-+!?=*` of a small built-in font. Case does not matter.
        /// Unset: HI, unless there is a `bitmap`. Giving both is an error.
        #[schemars(extend("x-example" = "HI"))]
        #[schemars(extend("x-goal" = true))]
        text: Option<String>;
        /// A picture in place of a word: one line for each row of bins. `#`, `X`, `x`, `1` or `*` is a bin to fill;
        /// `.`, `_`, `0`, `-` or a space is a bin to leave empty. Empty: no picture.
        bitmap: String;
        /// Whether the word is asked for. If not, it only sets the size of the box and the number of balls, and
        /// `[[require]]` says what must happen. Unset: yes.
        #[schemars(extend("x-example" = false))]
        constrained: Option<bool>;
        /// Which font.
        letters: Letters;
        /// Bins along the word. 0: as many as the word needs, with one empty bin on either side.
        columns: u32 = 0, 0..=64;
        /// Rows of bins. 0: as many as the word needs, with an empty one above and below.
        rows: u32 = 0, 0..=16;
        /// The most balls that can be dropped; each of them may be dropped or not. 0: as many as there are bins to
        /// fill, as in the paper; fewer cannot spell the word.
        balls: u32 = 0, 0..=1024;
        /// ln λ, the reward in nats for each filled bin. It must be larger the more bins there are, because there are
        /// then more ways to fill a few bins less. Unset: 5 + 2.25 ln(N/10) / ln 3 for N bins to fill, which gives the
        /// paper's 5 for HI and 7.25 for ACM.
        #[schemars(extend("x-example" = 5.0))]
        ln_lambda: Option<f64>, 0.0..=700.0, "nat";
        /// What the reward counts.
        count: Count;
        /// Standard deviation of each coordinate of a partition vertex's offset. Offsets beyond 8 standard deviations,
        /// or beyond 9/20 of the partitions' thickness, have density 0, so that the partitions stay whole.
        sigma_mm: f64 = 0.1, 1e-6..=0.5, "mm";
        /// Which vertices of the partitions are random.
        vertices: Vertices;
        /// Radius of a ball. Toy marbles measure 12 to 16 mm across; smaller ones have room to land in a bin of 20 mm.
        ball_radius_mm: f64 = 6.0, 0.5..=50.0, "mm";
        /// Density of a ball; glass has 2500. All balls are alike, so it has no influence on their motion.
        density: f64 = 2500.0, 1.0..=25000.0, "kg/m³";
        /// Height above the bottom of the box from which a ball's centre falls.
        drop_height_mm: f64 = 72.0, 1.0..=1000.0, "mm";
        /// Distance of the drop rectangle from the box's walls, on each side. 0: a ball at its edge just touches the
        /// wall.
        drop_inset_mm: f64 = 0.0, 0.0..=1000.0, "mm";
        /// Time between two drops. With the default, a ball bounces once or twice before the next one falls; a shorter
        /// time makes balls meet more often.
        drop_interval_s: f64 = 0.1, 0.01..=10.0, "s";
        /// When each ball falls.
        order: Order;
        /// Whether balls touch each other. If not, each falls as if alone, and two may lie in one place.
        balls_touch: bool = true;
        /// Time after the last drop by which everything must be at rest.
        settle_s: f64 = 3.0, 0.1..=60.0, "s";
        /// The box.
        #[serde(rename = "box")]
        dimensions: Dimensions;
        /// What happens when things touch.
        contact: Coefficients;
        /// How exact the simulation is.
        accuracy: AccuracyPreset;
        /// Which moves: "mixed", or "paper" for the paper's five.
        moves: Moves;
        /// Relative weights of the moves.
        weights: Weights<SpellingMoves>;
        /// Sizes of the moves' steps.
        steps: Steps;
    }
}

/// ln λ for a scenario that gives none: the power law through the paper's two choices, λ = e⁵ for 10 bins and e^7.25
/// for 30; never below 0.
#[must_use]
pub fn usual_ln_lambda(bins: usize) -> f64 {
    (5.0 + 2.25 * math::ln(bins as f64 / 10.0) / math::ln(3.0)).max(0.0)
}

/// What k, the number that λ rewards, counts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Count {
    /// Bins to fill in which at least one ball lies at rest (the paper's appendix B.1).
    #[default]
    Bins,
    /// Balls at rest in bins to fill (the paper's section 5.3): two in one bin count twice.
    Balls,
}

/// Which vertices have random offsets.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Vertices {
    /// The tops of all crossings of partitions, including those along the walls: 48 for 7 × 5 bins. No ball reaches
    /// those along the walls.
    #[default]
    Crossings,
    /// The tops of the crossings that are not along a wall: 24 for 7 × 5 bins.
    Interior,
}

/// When each ball falls.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Order {
    /// Ball i falls in the i-th time slot. If it is not dropped, its slot stays empty, so that adding a ball does not
    /// change when the others fall.
    #[default]
    Slots,
    /// The balls that are dropped fall one after the other, without gaps.
    Queue,
}

settings! {
    /// The box (the paper's figure 10).
    #[derive(Copy)]
    pub struct Dimensions {
        /// Side of a bin, from the middle of one partition to the middle of the next.
        bin_mm: f64 = 20.0, 2.0..=200.0, "mm";
        /// Thickness of a partition.
        partition_mm: f64 = 2.0, 0.4..=100.0, "mm";
        /// Height of the partitions above the bottom.
        partition_height_mm: f64 = 12.0, 0.5..=200.0, "mm";
        /// Radius of curvature of each bin's floor, which is a bowl: larger is flatter.
        floor_radius_mm: f64 = 40.0, 1.0..=100000.0, "mm";
        /// Depth of the box, for pictures. Balls meet its walls at any height, so none bounces out.
        depth_mm: f64 = 36.0, 0.5..=1000.0, "mm";
    }

    /// What happens when things touch.
    #[derive(Copy)]
    pub struct Coefficients {
        /// Restitution between a ball and the box: rebound speed over approach speed.
        box_restitution: f64 = 0.5, 0.0..=0.95;
        /// Coulomb's coefficient of friction between a ball and the box.
        box_friction: f64 = 0.3, 0.0..=10.0;
        /// Rolling resistance on the box: torque over load times radius. Without any, balls roll in their bowls for
        /// ever.
        rolling_resistance: f64 = 0.02, 0.0001..=1.0;
        /// Restitution between two balls.
        ball_restitution: f64 = 0.8, 0.0..=0.95;
        /// Coulomb's coefficient of friction between two balls.
        ball_friction: f64 = 0.1, 0.0..=10.0;
    }

    /// Sizes of the moves' steps.
    #[derive(Copy)]
    pub struct Steps {
        /// Probability that `change_vertices` shifts a vertex.
        vertex_chance: f64 = 0.02, 0.000001..=1.0;
        /// Standard deviation of the length of that shift, which has a random direction.
        vertex_mm: f64 = 0.05, 1e-6..=1.0, "mm";
        /// Probability that `redraw_vertices` draws a vertex anew.
        redraw_chance: f64 = 0.05, 0.000001..=1.0;
        /// Standard deviation of the length of `change_ball`'s shift, which has a random direction; in the paper it is
        /// the side of a bin.
        ball_mm: f64 = 20.0, 1e-6..=1000.0, "mm";
        /// Probability that `toggle` toggles a ball.
        toggle_chance: f64 = 0.25, 0.000001..=0.999999;
        /// Share of `redrop` and `birth_death` moves that aim at an empty bin to fill; the others drop a ball anywhere.
        aimed: f64 = 0.8, 0.0..=0.99;
    }
}

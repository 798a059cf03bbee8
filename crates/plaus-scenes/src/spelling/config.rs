//! Scenario keys of the balls that spell.

use super::font::Letters;
use super::moves::SpellingMoves;
use crate::accuracy::AccuracyPreset;
use crate::model::{Moves, Weights};
use plaus_dist::math;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Most bins along a side of the box.
pub const MOST_COLUMNS: u32 = 64;
/// Most bins along the other side.
pub const MOST_ROWS: u32 = 16;

/// Balls are dropped one after the other into a box of bins, and should come to rest in bins that spell a word (Chenney
/// & Forsyth 2000, section 5.3 and appendix B).
///
/// The box is seen from above: x along the word, y from its last row of bins to its first. Lengths are in millimetres.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Config {
    /// The word: letters A to Z, digits, spaces and `.-+!?=*` of a small built-in font. Case does not matter. Unset:
    /// HI, unless there is a `bitmap`. Giving both is an error.
    #[schemars(extend("x-example" = "HI"))]
    pub text: Option<String>,
    /// A picture in place of a word: one line for each row of bins. `#`, `X`, `x`, `1` or `*` is a bin to fill; `.`,
    /// `_`, `0`, `-` or a space is a bin to leave empty. Empty: no picture.
    pub bitmap: String,
    /// Whether the word is asked for. If not, it only sets the size of the box and the number of balls, and
    /// `[[require]]` says what must happen. Unset: yes.
    #[schemars(extend("x-example" = false))]
    pub constrained: Option<bool>,
    /// Which font.
    pub letters: Letters,
    /// Bins along the word. 0: as many as the word needs, with one empty bin on either side.
    #[schemars(range(min = 0, max = 64))]
    pub columns: u32,
    /// Rows of bins. 0: as many as the word needs, with an empty one above and below.
    #[schemars(range(min = 0, max = 16))]
    pub rows: u32,
    /// The most balls that can be dropped; each of them may be dropped or not. 0: as many as there are bins to fill, as
    /// in the paper; fewer cannot spell the word.
    #[schemars(range(min = 0, max = 1024))]
    pub balls: u32,
    /// ln λ, the reward in nats for each filled bin. It must be larger the more bins there are, because there are then
    /// more ways to fill a few bins less. Unset: 5 + 2.25 ln(N/10) / ln 3 for N bins to fill, which gives the paper's 5
    /// for HI and 7.25 for ACM.
    #[schemars(extend("minimum" = 0.0, "maximum" = 700.0, "x-unit" = "nat", "x-example" = 5.0))]
    pub ln_lambda: Option<f64>,
    /// What the reward counts.
    pub count: Count,
    /// Standard deviation of each coordinate of a partition vertex's offset. Offsets beyond 8 standard deviations, or
    /// beyond 9/20 of the partitions' thickness, have density 0, so that the partitions stay whole.
    #[schemars(extend("minimum" = 1e-6, "maximum" = 0.5, "x-unit" = "mm"))]
    pub sigma_mm: f64,
    /// Which vertices of the partitions are random.
    pub vertices: Vertices,
    /// Radius of a ball. Toy marbles measure 12 to 16 mm across; smaller ones have room to land in a bin of 20 mm.
    #[schemars(extend("minimum" = 0.5, "maximum" = 50.0, "x-unit" = "mm"))]
    pub ball_radius_mm: f64,
    /// Density of a ball; glass has 2500. All balls are alike, so it has no influence on their motion.
    #[schemars(extend("minimum" = 1.0, "maximum" = 25000.0, "x-unit" = "kg/m³"))]
    pub density: f64,
    /// Height above the bottom of the box from which a ball's centre falls.
    #[schemars(extend("minimum" = 1.0, "maximum" = 1000.0, "x-unit" = "mm"))]
    pub drop_height_mm: f64,
    /// Distance of the drop rectangle from the box's walls, on each side. 0: a ball at its edge just touches the wall.
    #[schemars(extend("minimum" = 0.0, "maximum" = 1000.0, "x-unit" = "mm"))]
    pub drop_inset_mm: f64,
    /// Time between two drops. With the default, a ball bounces once or twice before the next one falls; a shorter time
    /// makes balls meet more often.
    #[schemars(extend("minimum" = 0.01, "maximum" = 10.0, "x-unit" = "s"))]
    pub drop_interval_s: f64,
    /// When each ball falls.
    pub order: Order,
    /// Whether balls touch each other. If not, each falls as if alone, and two may lie in one place.
    pub balls_touch: bool,
    /// Time after the last drop by which everything must be at rest.
    #[schemars(extend("minimum" = 0.1, "maximum" = 60.0, "x-unit" = "s"))]
    pub settle_s: f64,
    /// The box.
    #[serde(rename = "box")]
    pub dimensions: Dimensions,
    /// What happens when things touch.
    pub contact: Coefficients,
    /// How exact the simulation is.
    pub accuracy: AccuracyPreset,
    /// Which moves: "mixed", or "paper" for the paper's five.
    pub moves: Moves,
    /// Relative weights of the moves.
    pub weights: Weights<SpellingMoves>,
    /// Sizes of the moves' steps.
    pub steps: Steps,
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
            text: None,
            bitmap: String::new(),
            constrained: None,
            letters: Letters::default(),
            columns: 0,
            rows: 0,
            balls: 0,
            ln_lambda: None,
            count: Count::default(),
            sigma_mm: 0.1,
            vertices: Vertices::default(),
            ball_radius_mm: 6.0,
            density: 2500.0,
            drop_height_mm: 72.0,
            drop_inset_mm: 0.0,
            drop_interval_s: 0.1,
            order: Order::default(),
            balls_touch: true,
            settle_s: 3.0,
            dimensions: Dimensions::default(),
            contact: Coefficients::default(),
            accuracy: AccuracyPreset::default(),
            moves: Moves::default(),
            weights: Weights::default(),
            steps: Steps::default(),
        }
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

/// The box (the paper's figure 10).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Dimensions {
    /// Side of a bin, from the middle of one partition to the middle of the next.
    #[schemars(extend("minimum" = 2.0, "maximum" = 200.0, "x-unit" = "mm"))]
    pub bin_mm: f64,
    /// Thickness of a partition.
    #[schemars(extend("minimum" = 0.4, "maximum" = 100.0, "x-unit" = "mm"))]
    pub partition_mm: f64,
    /// Height of the partitions above the bottom.
    #[schemars(extend("minimum" = 0.5, "maximum" = 200.0, "x-unit" = "mm"))]
    pub partition_height_mm: f64,
    /// Radius of curvature of each bin's floor, which is a bowl: larger is flatter.
    #[schemars(extend("minimum" = 1.0, "maximum" = 100000.0, "x-unit" = "mm"))]
    pub floor_radius_mm: f64,
    /// Depth of the box, for pictures. Balls meet its walls at any height, so none bounces out.
    #[schemars(extend("minimum" = 0.5, "maximum" = 1000.0, "x-unit" = "mm"))]
    pub depth_mm: f64,
}

impl Default for Dimensions {
    fn default() -> Self {
        Self { bin_mm: 20.0, partition_mm: 2.0, partition_height_mm: 12.0, floor_radius_mm: 40.0, depth_mm: 36.0 }
    }
}

/// What happens when things touch.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Coefficients {
    /// Restitution between a ball and the box: rebound speed over approach speed.
    #[schemars(range(min = 0.0, max = 0.95))]
    pub box_restitution: f64,
    /// Coulomb's coefficient of friction between a ball and the box.
    #[schemars(range(min = 0.0, max = 10.0))]
    pub box_friction: f64,
    /// Rolling resistance on the box: torque over load times radius. Without any, balls roll in their bowls for ever.
    #[schemars(range(min = 0.0001, max = 1.0))]
    pub rolling_resistance: f64,
    /// Restitution between two balls.
    #[schemars(range(min = 0.0, max = 0.95))]
    pub ball_restitution: f64,
    /// Coulomb's coefficient of friction between two balls.
    #[schemars(range(min = 0.0, max = 10.0))]
    pub ball_friction: f64,
}

impl Default for Coefficients {
    fn default() -> Self {
        Self {
            box_restitution: 0.5,
            box_friction: 0.3,
            rolling_resistance: 0.02,
            ball_restitution: 0.8,
            ball_friction: 0.1,
        }
    }
}

/// Sizes of the moves' steps.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Steps {
    /// Probability that `change_vertices` shifts a vertex.
    #[schemars(range(min = 0.000001, max = 1.0))]
    pub vertex_chance: f64,
    /// Standard deviation of the length of that shift, which has a random direction.
    #[schemars(extend("minimum" = 1e-6, "maximum" = 1.0, "x-unit" = "mm"))]
    pub vertex_mm: f64,
    /// Probability that `redraw_vertices` draws a vertex anew.
    #[schemars(range(min = 0.000001, max = 1.0))]
    pub redraw_chance: f64,
    /// Standard deviation of the length of `change_ball`'s shift, which has a random direction; in the paper it is the
    /// side of a bin.
    #[schemars(extend("minimum" = 1e-6, "maximum" = 1000.0, "x-unit" = "mm"))]
    pub ball_mm: f64,
    /// Probability that `toggle` toggles a ball.
    #[schemars(range(min = 0.000001, max = 0.999999))]
    pub toggle_chance: f64,
    /// Share of `redrop` and `birth_death` moves that aim at an empty bin to fill; the others drop a ball anywhere.
    #[schemars(range(min = 0.0, max = 0.99))]
    pub aimed: f64,
}

impl Default for Steps {
    fn default() -> Self {
        Self {
            vertex_chance: 0.02,
            vertex_mm: 0.05,
            redraw_chance: 0.05,
            ball_mm: 20.0,
            toggle_chance: 0.25,
            aimed: 0.8,
        }
    }
}

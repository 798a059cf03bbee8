//! Scenario keys of bowling.

use super::moves::BowlingMoves;
use super::release::{Delivery, Release};
use crate::accuracy::AccuracyPreset;
use crate::model::{Moves, Weights};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A ball is bowled at ten-pins, and the chosen pins should be left standing (Chenney & Forsyth 2000, section 5.2 and
/// appendix A).
///
/// Pins have their usual numbers: 1 is the head pin, 7 to 10 the last row from the bowler's left. x runs across the
/// lane to the bowler's right, y along it; the head pin's spot is the origin.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Config {
    /// Pins that stand at the start.
    #[schemars(length(min = 1, max = 10), inner(range(min = 1, max = 10)))]
    pub pins: Vec<u32>,
    /// Those of `pins` that should stand at the end; none for a strike or a spare.
    #[schemars(length(min = 0, max = 10), inner(range(min = 1, max = 10)))]
    pub leave: Vec<u32>,
    /// Whether `leave` is asked for. If not, only `[[require]]` says what must happen. Unset: yes.
    #[schemars(extend("x-example" = false))]
    pub constrained: Option<bool>,
    /// ln λ, the reward in nats for each pin that ends as it should, and again for each rewarded pin that stands as it
    /// should and has not moved far.
    #[schemars(extend("minimum" = 0.0, "maximum" = 700.0, "x-unit" = "nat"))]
    pub ln_lambda: f64,
    /// How far a pin may end from its starting place and still count as not moved far. The default is the radius of a
    /// pin's base.
    #[schemars(extend("minimum" = 0.0, "maximum" = 2000.0, "x-unit" = "mm"))]
    pub moved_far_mm: f64,
    /// Which pins are rewarded for not having moved far.
    pub rewarded: Rewarded,
    /// Which laws the ball's delivery follows: the paper's, or those of the real game.
    pub delivery: Delivery,
    /// Changes to these laws.
    pub release: Release,
    /// Standard deviation of each coordinate of a pin's place from its spot.
    #[schemars(extend("minimum" = 1e-6, "maximum" = 20.0, "x-unit" = "mm"))]
    pub pin_sigma_mm: f64,
    /// Mass of a pin. Regulation: 1.53 to 1.64.
    #[schemars(extend("minimum" = 0.1, "maximum" = 20.0, "x-unit" = "kg"))]
    pub pin_kg: f64,
    /// What happens when things touch.
    pub contact: Coefficients,
    /// Time after the ball's release at which the simulation ends, even if things still move.
    #[schemars(extend("minimum" = 1.0, "maximum" = 60.0, "x-unit" = "s"))]
    pub duration_s: f64,
    /// Length of the ball's path before the head pin that an animation shows; the animation begins there.
    #[schemars(extend("minimum" = 0.5, "maximum" = 18.3, "x-unit" = "m"))]
    pub shown_m: f64,
    /// How exact the simulation is.
    pub accuracy: AccuracyPreset,
    /// Which moves: "mixed", or "paper" for the paper's.
    pub moves: Moves,
    /// Relative weights of the moves.
    pub weights: Weights<BowlingMoves>,
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
            pins: (1..=10).collect(),
            leave: Vec::new(),
            constrained: None,
            ln_lambda: 2.5,
            moved_far_mm: 25.8,
            rewarded: Rewarded::default(),
            delivery: Delivery::default(),
            release: Release::default(),
            pin_sigma_mm: 1.0,
            pin_kg: 1.59,
            contact: Coefficients::default(),
            duration_s: 8.0,
            shown_m: 4.0,
            accuracy: AccuracyPreset::default(),
            moves: Moves::default(),
            weights: Weights::default(),
            steps: Steps::default(),
        }
    }
}

/// Which pins are rewarded for not having moved far.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Rewarded {
    /// Pins that should stand.
    #[default]
    MeantToStand,
    /// Any standing pin, which is one reading of the paper's text. This rewards a gutter ball, which moves no pin, as
    /// much as a strike.
    AnyStanding,
}

/// What happens when things touch. There are no published coefficients for contact between pins.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Coefficients {
    /// Coulomb's coefficient of friction between the ball and the lane, beyond the oil. Unset: 0.12 for the paper's
    /// delivery, 0.2 for regulation.
    #[schemars(range(min = 0.0, max = 10.0))]
    pub lane_friction: Option<f64>,
    /// Length of the oiled part of the lane, from the foul line. Unset: 0 for the paper's delivery, 12 for regulation.
    #[schemars(extend("minimum" = 0.0, "maximum" = 18.2, "x-unit" = "m"))]
    pub oil_m: Option<f64>,
    /// Coefficient of friction between the ball and the oiled lane.
    #[schemars(range(min = 0.0, max = 10.0))]
    pub oil_friction: f64,
    /// Restitution between the ball and the lane: rebound speed over approach speed.
    #[schemars(range(min = 0.0, max = 0.95))]
    pub lane_restitution: f64,
    /// Friction between the ball and a pin.
    #[schemars(range(min = 0.0, max = 10.0))]
    pub ball_pin_friction: f64,
    /// Restitution between the ball and a pin; the rules ask for 0.65 to 0.78.
    #[schemars(range(min = 0.0, max = 0.95))]
    pub ball_pin_restitution: f64,
    /// Friction between pins.
    #[schemars(range(min = 0.0, max = 10.0))]
    pub pin_pin_friction: f64,
    /// Restitution between pins.
    #[schemars(range(min = 0.0, max = 0.95))]
    pub pin_pin_restitution: f64,
    /// Friction between a pin and the lane, gutters and walls.
    #[schemars(range(min = 0.0, max = 10.0))]
    pub pin_lane_friction: f64,
    /// Restitution between a pin and the lane, gutters and walls.
    #[schemars(range(min = 0.0, max = 0.95))]
    pub pin_lane_restitution: f64,
    /// Rolling resistance of a pin: torque over load times the distance from its centre of gravity to the point of
    /// contact. Without any, a nudged pin circles on the rim of its foot for ever.
    #[schemars(range(min = 0.0, max = 1.0))]
    pub pin_rolling: f64,
    /// Resistance of a pin to spinning about the vertical, defined likewise.
    #[schemars(range(min = 0.0, max = 1.0))]
    pub pin_spinning: f64,
}

impl Default for Coefficients {
    fn default() -> Self {
        Self {
            lane_friction: None,
            oil_m: None,
            oil_friction: 0.04,
            lane_restitution: 0.2,
            ball_pin_friction: 0.15,
            ball_pin_restitution: 0.7,
            pin_pin_friction: 0.2,
            pin_pin_restitution: 0.6,
            pin_lane_friction: 0.25,
            pin_lane_restitution: 0.4,
            pin_rolling: 0.02,
            pin_spinning: 0.01,
        }
    }
}

/// Sizes of the moves' steps. The defaults are the paper's: each step is half the standard deviation, or a fifth of the
/// interval, of the quantity that it shifts.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Steps {
    /// Standard deviation of the shift of a quantity with a Gaussian law, relative to that law's.
    #[schemars(range(min = 1e-9, max = 10.0))]
    pub gaussian: f64,
    /// Standard deviation of the shift of a quantity with a uniform law, relative to its interval's width.
    #[schemars(range(min = 1e-9, max = 10.0))]
    pub uniform: f64,
    /// Probability that `change_pins` shifts a pin.
    #[schemars(range(min = 0.000001, max = 1.0))]
    pub pin_chance: f64,
    /// Standard deviation of the length of that shift, which has a random direction.
    #[schemars(extend("minimum" = 1e-9, "maximum" = 100.0, "x-unit" = "mm"))]
    pub pin_mm: f64,
    /// Probability that `redraw_pins` draws a pin's place anew.
    #[schemars(range(min = 0.000001, max = 1.0))]
    pub redraw_chance: f64,
    /// Probability that `aim` draws everything else anew.
    #[schemars(range(min = 0.0, max = 1.0))]
    pub aim_anew: f64,
    /// The least factor on the steps of `refine`; the logarithm of the factor is uniform between the logarithm of this
    /// one and 0.
    #[schemars(range(min = 1e-12, max = 0.99))]
    pub finest: f64,
}

impl Default for Steps {
    fn default() -> Self {
        Self {
            gaussian: 0.5,
            uniform: 0.2,
            pin_chance: 0.5,
            pin_mm: 0.5,
            redraw_chance: 0.3,
            aim_anew: 0.9,
            finest: 1e-4,
        }
    }
}

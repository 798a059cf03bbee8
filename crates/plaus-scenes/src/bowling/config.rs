//! Scenario keys of bowling.

use super::moves::BowlingMoves;
use super::release::{Delivery, Release};
use crate::accuracy::AccuracyPreset;
use crate::model::{Moves, Weights};
use crate::settings::settings;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

settings! {
    /// A ball is bowled at ten-pins, and the chosen pins should be left standing (Chenney & Forsyth 2000, section 5.2
    /// and appendix A).
    ///
    /// Pins have their usual numbers: 1 is the head pin, 7 to 10 the last row from the bowler's left. x runs across the
    /// lane to the bowler's right, y along it; the head pin's spot is the origin.
    pub struct Config {
        /// Pins that stand at the start.
        #[schemars(length(min = 1, max = 10), inner(range(min = 1, max = 10)))]
        pins: Vec<u32> = (1..=10).collect();
        /// Those of `pins` that should stand at the end; none for a strike or a spare.
        #[schemars(length(min = 0, max = 10), inner(range(min = 1, max = 10)))]
        #[schemars(extend("x-goal" = true))]
        leave: Vec<u32>;
        /// Whether `leave` is asked for. If not, only `[[require]]` says what must happen. Unset: yes.
        #[schemars(extend("x-example" = false))]
        constrained: Option<bool>;
        /// ln λ, the reward in nats for each pin that ends as it should, and again for each rewarded pin that stands as
        /// it should and has not moved far.
        ln_lambda: f64 = 2.5, 0.0..=700.0, "nat";
        /// How far a pin may end from its starting place and still count as not moved far. The default is the radius of
        /// a pin's base.
        moved_far_mm: f64 = 25.8, 0.0..=2000.0, "mm";
        /// Which pins are rewarded for not having moved far.
        rewarded: Rewarded;
        /// Which laws the ball's delivery follows: the paper's, or those of the real game.
        delivery: Delivery;
        /// Changes to these laws.
        release: Release;
        /// Standard deviation of each coordinate of a pin's place from its spot.
        pin_sigma_mm: f64 = 1.0, 1e-6..=20.0, "mm";
        /// Mass of a pin. Regulation: 1.53 to 1.64.
        pin_kg: f64 = 1.59, 0.1..=20.0, "kg";
        /// What happens when things touch.
        contact: Coefficients;
        /// Time after the ball's release at which the simulation ends, even if things still move.
        duration_s: f64 = 8.0, 1.0..=60.0, "s";
        /// Length of the ball's path before the head pin that an animation shows; the animation begins there.
        shown_m: f64 = 4.0, 0.5..=18.3, "m";
        /// How exact the simulation is.
        accuracy: AccuracyPreset;
        /// Which moves: "mixed", or "paper" for the paper's.
        moves: Moves;
        /// Relative weights of the moves.
        weights: Weights<BowlingMoves>;
        /// Sizes of the moves' steps.
        steps: Steps;
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

settings! {
    /// What happens when things touch. There are no published coefficients for contact between pins.
    #[derive(Copy)]
    pub struct Coefficients {
        /// Coulomb's coefficient of friction between the ball and the lane, beyond the oil. Unset: 0.12 for the paper's
        /// delivery, 0.2 for regulation.
        lane_friction: Option<f64>, 0.0..=10.0;
        /// Length of the oiled part of the lane, from the foul line. Unset: 0 for the paper's delivery, 12 for
        /// regulation.
        oil_m: Option<f64>, 0.0..=18.2, "m";
        /// Coefficient of friction between the ball and the oiled lane.
        oil_friction: f64 = 0.04, 0.0..=10.0;
        /// Restitution between the ball and the lane: rebound speed over approach speed.
        lane_restitution: f64 = 0.2, 0.0..=0.95;
        /// Friction between the ball and a pin.
        ball_pin_friction: f64 = 0.15, 0.0..=10.0;
        /// Restitution between the ball and a pin; the rules ask for 0.65 to 0.78.
        ball_pin_restitution: f64 = 0.7, 0.0..=0.95;
        /// Friction between pins.
        pin_pin_friction: f64 = 0.2, 0.0..=10.0;
        /// Restitution between pins.
        pin_pin_restitution: f64 = 0.6, 0.0..=0.95;
        /// Friction between a pin and the lane, gutters and walls.
        pin_lane_friction: f64 = 0.25, 0.0..=10.0;
        /// Restitution between a pin and the lane, gutters and walls.
        pin_lane_restitution: f64 = 0.4, 0.0..=0.95;
        /// Rolling resistance of a pin: torque over load times the distance from its centre of gravity to the point of
        /// contact. Without any, a nudged pin circles on the rim of its foot for ever.
        pin_rolling: f64 = 0.02, 0.0..=1.0;
        /// Resistance of a pin to spinning about the vertical, defined likewise.
        pin_spinning: f64 = 0.01, 0.0..=1.0;
    }

    /// Sizes of the moves' steps. The defaults are the paper's: each step is half the standard deviation, or a fifth of
    /// the interval, of the quantity that it shifts.
    #[derive(Copy)]
    pub struct Steps {
        /// Standard deviation of the shift of a quantity with a Gaussian law, relative to that law's.
        gaussian: f64 = 0.5, 1e-9..=10.0;
        /// Standard deviation of the shift of a quantity with a uniform law, relative to its interval's width.
        uniform: f64 = 0.2, 1e-9..=10.0;
        /// Probability that `change_pins` shifts a pin.
        pin_chance: f64 = 0.5, 0.000001..=1.0;
        /// Standard deviation of the length of that shift, which has a random direction.
        pin_mm: f64 = 0.5, 1e-9..=100.0, "mm";
        /// Probability that `redraw_pins` draws a pin's place anew.
        redraw_chance: f64 = 0.3, 0.000001..=1.0;
        /// Probability that `aim` draws everything else anew.
        aim_anew: f64 = 0.9, 0.0..=1.0;
        /// The least factor on the steps of `refine`; the logarithm of the factor is uniform between the logarithm of
        /// this one and 0.
        finest: f64 = 1e-4, 1e-12..=0.99;
    }
}

//! The moves of the 2D ball: its own, one in each file, and the moves of the library that it uses.

mod aim;
mod landing;
mod roots;

pub use aim::Aim;
pub(super) use aim::reach;

use super::Ball2d;
use crate::model::{Menu, Printed, Row};
use crate::rules::Rules;
use plaus_mcmc::Move;
use plaus_mcmc::library::{RedrawOne, ShiftHalf};

/// The moves of the 2D ball.
#[derive(Debug, Clone, PartialEq)]
pub enum Ball2dMoves {}

impl Menu for Ball2dMoves {
    type Scene = Ball2d;
    const SCENE: &'static str = "ball2d";
    const ROWS: &'static [Row] = &[
        Row::paper(
            "perturb",
            0.3,
            Printed::Weight(1.0),
            "The paper's move: each angle gets a uniform step with probability ½.",
        ),
        Row::own("redraw", 0.1, "One angle is drawn anew from its prior."),
        Row::own(
            "aim",
            0.5,
            "Some angles are drawn anew and another is solved for, so that the ball still lands near the target.",
        ),
    ];
}

/// All moves.
pub(super) fn all(scene: &Ball2d, rules: &Rules) -> Vec<Box<dyn Move<Ball2d>>> {
    let angles = || (0..scene.config.collisions as usize).collect();
    vec![
        Box::new(ShiftHalf { name: "perturb", among: angles(), half_width: scene.config.step_deg }),
        Box::new(RedrawOne { name: "redraw", among: angles(), symmetric: rules.symmetric_redraws() }),
        Box::new(Aim),
    ]
}

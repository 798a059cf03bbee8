//! The moves of the balls that spell: its own, one in each file, and the moves of the library that it uses. The first
//! four are the paper's (its appendix B.2); activate and deactivate are one move here.

mod aim;
mod birth_death;
mod redrop;

pub use birth_death::BirthDeath;
pub use redrop::Redrop;

use super::Spelling;
use crate::model::{Menu, Printed, Row};
use crate::rules::Rules;
use plaus_mcmc::Move;
use plaus_mcmc::library::{RedrawAll, RedrawSome, ShiftOne, ShiftSome, Swap, Toggle};

/// The moves of the balls that spell.
#[derive(Debug, Clone, PartialEq)]
pub enum SpellingMoves {}

impl Menu for SpellingMoves {
    type Scene = Spelling;
    const SCENE: &'static str = "spelling";
    const ROWS: &'static [Row] = &[
        Row::paper("change_all", 0.01, Printed::Weight(0.04), "The paper's: draw everything anew."),
        Row::paper("change_vertices", 0.03, Printed::Weight(0.32), "The paper's: shift some partition vertices."),
        Row::own("redraw_vertices", 0.12, "Draw some partition vertices anew."),
        Row::paper("change_ball", 0.19, Printed::Weight(0.32), "The paper's: shift one ball's drop position."),
        Row::paper(
            "toggle",
            0.05,
            Printed::Weight(0.32),
            "The paper's: add some balls or remove some, each half of the time.",
        ),
        Row::own("redrop", 0.2, "Drop a ball elsewhere, preferably over an empty bin to fill."),
        Row::own("birth_death", 0.3, "Add a ball, preferably over an empty bin to fill, or remove one."),
        Row::own("swap", 0.1, "Let two balls exchange their drop positions, and so their turns to fall."),
    ];
}

/// All moves.
pub(super) fn all(scene: &Spelling, rules: &Rules) -> Vec<Box<dyn Move<Spelling>>> {
    let steps = &scene.config.steps;
    let (vertices, balls) = (|| scene.vars.named(&["offset"]), || scene.vars.named(&["drop"]));
    let (symmetric, recipe, incomplete) = (rules.symmetric_redraws(), rules.recipe(), rules.incomplete_toggles());
    let (chance, sd) = (steps.vertex_chance, steps.vertex_mm);
    vec![
        Box::new(RedrawAll { name: "change_all", symmetric, recipe }),
        Box::new(ShiftSome { name: "change_vertices", among: vertices(), chance, sd, adapts: false }),
        Box::new(RedrawSome { name: "redraw_vertices", among: vertices(), chance: steps.redraw_chance }),
        Box::new(ShiftOne { name: "change_ball", among: balls(), sd: steps.ball_mm }),
        Box::new(Toggle { name: "toggle", among: balls(), chance: steps.toggle_chance, incomplete }),
        Box::new(Redrop { aimed: steps.aimed }),
        Box::new(BirthDeath { aimed: steps.aimed }),
        Box::new(Swap { name: "swap", among: balls() }),
    ]
}

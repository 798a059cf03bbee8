//! The moves of worlds that users describe: from the library, as they follow from the variables, and one for tables.

use super::Custom;
use crate::model::unmet;
use crate::model::{Menu, Row};
use plaus_mcmc::Move;
use plaus_mcmc::library::{RedrawAll, RedrawGroup};

/// The moves.
#[derive(Debug, Clone, PartialEq)]
pub enum CustomMoves {}

impl Menu for CustomMoves {
    type Scene = Custom;
    const SCENE: &'static str = "custom";
    const ROWS: &'static [Row] = &[
        Row::own("redraw_all", 0.1, "Draw everything anew from its law."),
        Row::own("redraw_body", 0.15, "Draw all uncertain numbers of one body, material or quantity anew."),
        Row::own(
            "unmet",
            0.2,
            "Change one random variable, as `step_any` or `redraw_any` do: more often one of the bodies that unmet \
             requirements name, or of what they met.",
        ),
        Row::own(
            "bump",
            0.25,
            "Change one control point of random bumps, near the line from where a body starts to where it ends.",
        ),
    ];
    const OFFERED: &'static [(&'static str, f64)] = &[("redraw_any", 0.1), ("step_any", 0.2), ("step_all", 0.25)];
}

/// Those of its own that every world has.
pub(super) fn all(world: &Custom) -> Vec<Box<dyn Move<Custom>>> {
    vec![
        Box::new(RedrawAll::exact("redraw_all")),
        Box::new(RedrawGroup { name: "redraw_body" }),
        Box::new(unmet(world, |_, _| Vec::new())),
    ]
}

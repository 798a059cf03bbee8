//! The weights of moves of worlds that users describe.

use super::Custom;
use crate::model::{Menu, Row};

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
        Row::own(
            "redraw_impact",
            0.25,
            "Draw the normal and restitution of one impact of the motion anew, if they scatter.",
        ),
        Row::own("step_impact", 0.25, "Change these of one impact by a step that preserves their law."),
        Row::own(
            "recast",
            1.0,
            "Draw all of one body anew, from where a trial shows that it ends as `rests_at`, `inside`, `faces_up` or \
             `stands` ask; for bodies that meet only level planes.",
        ),
        Row::own("shift", 0.1, "Shift such a body's start so that it ends where it should."),
        Row::own("turn", 0.1, "Turn such a body's throw about the vertical through where it should end."),
        Row::own(
            "swap",
            0.02,
            "Two bodies of an array exchange their throws, where something is asked of the end of one.",
        ),
        Row::own("relabel", 0.1, "Begin such a body's throw in another orientation that its shape makes equivalent."),
    ];
    const OFFERED: &'static [(&'static str, f64)] = &[("redraw_any", 0.1), ("step_any", 0.2), ("step_all", 0.25)];
}

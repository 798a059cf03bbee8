//! The moves of bowling: its own, one in each file, and the moves of the library that it uses. Those named `change_…`
//! are the paper's seven (its appendix A.2).

mod aim;

pub use aim::Aim;

use super::{Bowling, Quantity, Shot};
use crate::model::{Menu, Printed, Row};
use crate::rules::Rules;
use plaus_dist::Stream;
use plaus_mcmc::library::{RedrawAll, RedrawOne, RedrawSome, ShiftAll, ShiftSome, Sizes, Stride, Symmetry};
use plaus_mcmc::{Law, Move, StateRefOf};

/// The moves of bowling.
#[derive(Debug, Clone, PartialEq)]
pub enum BowlingMoves {}

impl Menu for BowlingMoves {
    type Scene = Bowling;
    const SCENE: &'static str = "bowling";
    const ROWS: &'static [Row] = &[
        Row::paper("change_all", 0.05, Printed::Weight(0.05), "The paper's: draw everything anew."),
        Row::paper("change_radius", 0.04, Printed::Weight(0.075), "The paper's: shift the ball's radius."),
        Row::paper(
            "change_density",
            0.04,
            Printed::Weight(0.075),
            "The paper's: shift the ball's density, and its radius of gyration if that is uncertain.",
        ),
        Row::paper("change_position", 0.1, Printed::Weight(0.2), "The paper's: shift the ball's place of release."),
        Row::paper("change_velocity", 0.1, Printed::Weight(0.2), "The paper's: change the ball's velocity."),
        Row::paper("change_spin", 0.05, Printed::Weight(0.2), "The paper's: change the ball's spin."),
        Row::paper("change_pins", 0.1, Printed::Weight(0.2), "The paper's: shift some pins."),
        Row::own("redraw", 0.12, "Draw one quantity of the ball anew."),
        Row::own("redraw_pins", 0.1, "Draw the places of some pins anew."),
        Row::own(
            "aim",
            3.0,
            "Release the ball from where it should hit a pin that no other one stands before, preferably where the \
             warm-up learnt that it should.",
        ),
        Row::own(
            "refine",
            0.25,
            "Shift everything a little, by steps of any size down to a ten-thousandth of the paper's. Shots with many \
             collisions need such small steps.",
        ),
        Row::own("mirror", 0.05, "Exchange left and right. No effect if the pins that should stand are not symmetric."),
    ];
}

/// All moves.
pub(super) fn all(scene: &Bowling, rules: &Rules) -> Vec<Box<dyn Move<Bowling>>> {
    let steps = &scene.config.steps;
    let (ball, pins) = (scene.vars.which(|var| var.member.is_none()), scene.vars.named(&["offset"]));
    let strides = |vars: &[usize]| vars.iter().map(|&var| stride(scene, var)).collect();
    let shift = |name, quantities: &[&str]| Box::new(ShiftAll::by(name, strides(&scene.vars.named(quantities))));
    let (symmetric, recipe) = (rules.symmetric_redraws(), rules.recipe());
    let every = strides(&scene.vars.which(|_| true));
    let (chance, sd) = (steps.pin_chance, steps.pin_mm);
    vec![
        Box::new(RedrawAll { name: "change_all", symmetric, recipe }),
        shift("change_radius", &["radius"]),
        shift("change_density", &["density", "gyration"]),
        shift("change_position", &["across", "height"]),
        shift("change_velocity", &["speed", "drift"]),
        shift("change_spin", &["roll", "hook", "twist"]),
        Box::new(ShiftSome { name: "change_pins", among: pins.clone(), chance, sd, adapts: true }),
        Box::new(RedrawOne { name: "redraw", among: ball, symmetric }),
        Box::new(RedrawSome { name: "redraw_pins", among: pins, chance: steps.redraw_chance }),
        Box::new(Aim::new(scene, steps.aim_anew)),
        Box::new(ShiftAll::at_many_scales("refine", every, Sizes::down_to(steps.finest))),
        Box::new(Symmetry { name: "mirror", map: mirror }),
    ]
}

/// The usual step of a variable.
fn stride(scene: &Bowling, var: usize) -> Stride {
    let (steps, law) = (&scene.config.steps, &scene.vars.get(var).law);
    match law {
        Law::Uniform(_) => Stride { var, part: steps.uniform, of: law.width() },
        Law::Plane(_) => Stride { var, part: steps.pin_mm, of: 1.0 },
        _ => Stride { var, part: steps.gaussian, of: law.width() },
    }
}

/// The whole shot mirrored along the lane. If the delivery's laws are not symmetric, the prior accounts for that. If
/// the pins that are set up, or those to be left, are not symmetric, nothing changes: the mirrored shot would answer
/// another question.
pub fn mirror(target: &Bowling, current: StateRefOf<'_, Bowling>, candidate: &mut Shot, _: &mut Stream) -> bool {
    let Some(order) = target.rack().mirrored() else { return false };
    for quantity in Quantity::ALL {
        candidate.ball[quantity as usize] = quantity.mirrored(current.draw.get(quantity));
    }
    for (offset, &other) in candidate.pins.iter_mut().zip(order) {
        let [x, y] = current.draw.pins[other];
        *offset = [-x, y];
    }
    true
}

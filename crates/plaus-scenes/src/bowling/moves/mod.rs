//! The moves of bowling: its own, one a file, and which of the library it makes. Those named `change_…` are the paper's
//! seven (its appendix A.2).

mod aim;

pub use aim::Aim;

use super::{Bowling, Quantity, Shot};
use crate::model::{Menu, Printed, Row};
use crate::rules::Rules;
use plaus_dist::Stream;
use plaus_mcmc::library::{RedrawAll, RedrawOne, RedrawSome, ShiftAll, ShiftSome, Sizes, Stride, Symmetry};
use plaus_mcmc::{Law, Move, StateRefOf};

/// The moves of bowling.
#[derive(Debug)]
pub enum BowlingMoves {}

impl Menu for BowlingMoves {
    type Scene = Bowling;
    const SCENE: &'static str = "bowling";
    const ROWS: &'static [Row] = &[
        Row::paper("change_all", 0.05, Printed::Weight(0.05), "The paper's: everything is drawn anew."),
        Row::paper("change_radius", 0.04, Printed::Weight(0.075), "The paper's: the ball's radius is shifted."),
        Row::paper(
            "change_density",
            0.04,
            Printed::Weight(0.075),
            "The paper's: the ball's density is shifted, and with it its radius of gyration where that is uncertain.",
        ),
        Row::paper("change_position", 0.1, Printed::Weight(0.2), "The paper's: where the ball is released is shifted."),
        Row::paper("change_velocity", 0.1, Printed::Weight(0.2), "The paper's: the ball's velocity is changed."),
        Row::paper("change_spin", 0.05, Printed::Weight(0.2), "The paper's: the ball's spin is changed."),
        Row::paper("change_pins", 0.1, Printed::Weight(0.2), "The paper's: some pins are shifted."),
        Row::own("redraw", 0.12, "One quantity of the ball is drawn anew."),
        Row::own("redraw_pins", 0.1, "Some pins are set anew."),
        Row::own("aim", 0.25, "The ball is released from where it should meet a pin of the first row."),
        Row::own(
            "refine",
            0.25,
            "Everything is shifted a little, by steps of any size down to a ten-thousandth of the paper's: what a \
             shot that has many collisions hangs on.",
        ),
        Row::own(
            "mirror",
            0.05,
            "Left and right are exchanged. Without effect where the pins to stand are not the same from both sides.",
        ),
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
        Box::new(Aim { anew: steps.aim_anew }),
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

/// The whole shot as seen in a mirror along the lane. Where the delivery's laws are not the same from both sides, the
/// prior says so. Where the pins that are set up, or those to be left, are not the same in the mirror, nothing changes:
/// the mirrored shot is an answer to another question.
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

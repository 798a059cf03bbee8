//! The moves of bowling, one a file. Those named `change_…` are the paper's seven (its appendix A.2).

mod aim;
mod change_all;
mod change_ball;
mod change_pins;
mod mirror;
mod redraw;
mod redraw_pins;
mod refine;

pub use aim::Aim;
pub use change_all::ChangeAll;
pub use change_ball::ChangeBall;
pub use change_pins::ChangePins;
pub use mirror::Mirror;
pub use redraw::Redraw;
pub use redraw_pins::RedrawPins;
pub use refine::Refine;

use super::Bowling;
use super::config::{Config, Weights};
use super::draw::Shot;
use super::release::{Law, Quantity};
use crate::rules::Rules;
use plaus_dist::{Stream, standard_normal};
use plaus_mcmc::Move;

/// All moves with their weights.
pub(super) fn all(config: &Config, weights: &Weights, rules: &Rules) -> Vec<(f64, Box<dyn Move<Bowling>>)> {
    use Quantity::{Across, Density, Drift, Gyration, Height, Hook, Radius, Roll, Speed, Twist};
    let steps = config.steps;
    let ball = |name, quantities| Box::new(ChangeBall { name, quantities, steps, factor: 1.0 });
    let change_all = ChangeAll { symmetric: rules.symmetric_redraws(), radial_offsets: rules.radial_offsets() };
    vec![
        (weights.change_all, Box::new(change_all)),
        (weights.change_radius, ball("change_radius", &[Radius])),
        (weights.change_density, ball("change_density", &[Density, Gyration])),
        (weights.change_position, ball("change_position", &[Across, Height])),
        (weights.change_velocity, ball("change_velocity", &[Speed, Drift])),
        (weights.change_spin, ball("change_spin", &[Roll, Hook, Twist])),
        (weights.change_pins, Box::new(ChangePins { chance: steps.pin_chance, sd: steps.pin_mm })),
        (weights.redraw, Box::new(Redraw { symmetric: rules.symmetric_redraws() })),
        (weights.redraw_pins, Box::new(RedrawPins { chance: steps.redraw_chance })),
        (weights.aim, Box::new(Aim { anew: steps.aim_anew })),
        (weights.refine, Box::new(Refine { steps, about: None })),
        (weights.mirror, Box::new(Mirror)),
    ]
}

/// Shifts one quantity by a Gaussian step of `factor` times its usual size. As likely as its opposite.
fn shift(
    target: &Bowling,
    quantity: Quantity,
    steps: &super::Steps,
    factor: f64,
    draw: &mut Shot,
    stream: &mut Stream,
) {
    let value = &mut draw.ball[quantity as usize];
    match target.prior().laws().of(quantity) {
        Law::Fixed(_) => {}
        Law::Uniform(law) => {
            let step = factor * steps.uniform * (law.high() - law.low()) * standard_normal(stream);
            *value = law.wrap(*value + step);
        }
        Law::Gaussian(law) => *value += factor * steps.gaussian * law.sd() * standard_normal(stream),
        Law::AboveRadius(_, sd) => *value += factor * steps.gaussian * sd * standard_normal(stream),
    }
}

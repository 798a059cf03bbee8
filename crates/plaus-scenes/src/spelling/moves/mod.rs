//! The moves of the balls that spell, one a file. The first four are the paper's (its appendix B.2), activate and
//! deactivate being one.

mod aim;
mod birth_death;
mod change_all;
mod change_ball;
mod change_vertices;
mod redraw_vertices;
mod redrop;
mod swap;
mod toggle;

pub use birth_death::BirthDeath;
pub use change_all::ChangeAll;
pub use change_ball::ChangeBall;
pub use change_vertices::ChangeVertices;
pub use redraw_vertices::RedrawVertices;
pub use redrop::Redrop;
pub use swap::Swap;
pub use toggle::Toggle;

use super::Spelling;
use super::config::{Config, Weights};
use crate::rules::Rules;
use crate::walk::shift;
use plaus_dist::{Stream, open_unit};
use plaus_mcmc::Move;

/// All moves with their weights.
pub(super) fn all(config: &Config, weights: &Weights, rules: &Rules) -> Vec<(f64, Box<dyn Move<Spelling>>)> {
    let steps = &config.steps;
    let change_all = ChangeAll { symmetric: rules.symmetric_redraws(), radial_offsets: rules.radial_offsets() };
    vec![
        (weights.change_all, Box::new(change_all)),
        (weights.change_vertices, Box::new(ChangeVertices { chance: steps.vertex_chance, sd: steps.vertex_mm })),
        (weights.redraw_vertices, Box::new(RedrawVertices { chance: steps.redraw_chance })),
        (weights.change_ball, Box::new(ChangeBall { sd: steps.ball_mm })),
        (weights.toggle, Box::new(Toggle { chance: steps.toggle_chance, incomplete: rules.incomplete_toggles() })),
        (weights.redrop, Box::new(Redrop { aimed: steps.aimed })),
        (weights.birth_death, Box::new(BirthDeath { aimed: steps.aimed })),
        (weights.swap, Box::new(Swap)),
    ]
}

/// Whether something of this probability happens.
fn happens(chance: f64, stream: &mut Stream) -> bool {
    open_unit(stream) < chance
}

//! The moves of worlds that users describe: from the library, as they follow from the variables, and one for tables.

use super::Custom;
use super::equal::{Shift, relabel, swap, turn};
use super::recast::Recast;
use super::throws::Throw;
use crate::model::unmet;
use plaus_mcmc::Move;
use plaus_mcmc::library::{RedrawAll, RedrawGroup, Symmetry};

/// Those of its own.
pub(super) fn all(world: &Custom) -> Vec<Box<dyn Move<Custom>>> {
    let mut all: Vec<Box<dyn Move<Custom>>> = vec![
        Box::new(RedrawAll::exact("redraw_all")),
        Box::new(RedrawGroup { name: "redraw_body" }),
        Box::new(unmet(world, |_, _| Vec::new())),
    ];
    let some = |of: fn(&Throw) -> bool| world.throws().iter().any(of);
    if some(|_| true) {
        all.push(Box::new(Recast));
    }
    if some(|throw| !throw.zones.is_empty()) {
        all.push(Box::new(Shift));
    }
    if some(Throw::is_turned) {
        all.push(Box::new(Symmetry { name: "turn", map: turn }));
    }
    if some(|throw| throw.rotations.len() > 1) {
        all.push(Box::new(Symmetry { name: "relabel", map: relabel }));
    }
    if !world.alike().is_empty() {
        all.push(Box::new(Symmetry { name: "swap", map: swap }));
    }
    all
}

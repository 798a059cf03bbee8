//! Bowling under the regulation preset, compared with statistics of the game.

mod map;
mod professional;
mod published;
mod roll;
mod search;
mod symmetry;
mod window;

use crate::{Make, Result, Work};
use plaus_scenes::bowling::Coefficients;

const SEED: u64 = 7_155_000;

/// Parts of the comparison by name, as in `--only bowling/map`.
const PARTS: &[(&str, Make)] =
    &[("symmetry", symmetry::make), ("map", map::make), ("search", search::make), ("professionals", professionals)];

pub(crate) fn make(work: &mut Work) -> Result<()> {
    work.make_parts("bowling", PARTS)
}

fn professionals(work: &mut Work) -> Result<()> {
    let sets = [
        ("The scene's coefficients", Coefficients::default(), published::FIRST_BALLS),
        ("The coefficients of least misfit in the search", search::least_misfit(), 3_000),
    ];
    professional::make(work, &sets)
}

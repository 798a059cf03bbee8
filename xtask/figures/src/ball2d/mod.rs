//! The 2D ball: figures 1 and 2, and the claims of section 5.1.

mod arrival;
mod downward;
mod mixing;
mod paths;
mod reference;
mod rest;
mod sigma;

use crate::sampler::Sampler;
use crate::{Result, Work};
use plaus_scenes::Moves;
use plaus_scenes::ball2d::{Ball2d, Config};

/// Index of the place of rest among the scene's scalars; the angles follow it.
const REST: usize = 0;
const FIRST_ANGLE: usize = 1;

/// Seed of the chain of figure 2; with the default moves, of figure 1.
const FIGURE_SEED: u64 = 1;

/// The paper's moves and the default ones, with the names they have in tables.
const BOTH: [(Moves, &str); 2] = [(Moves::Paper, "paper's"), (Moves::Mixed, "default")];

/// The default scenario, with changes.
fn sampler(moves: Moves, change: impl FnOnce(&mut Config)) -> Result<Sampler<Ball2d>> {
    let mut config = Config { moves, ..Config::default() };
    change(&mut config);
    Sampler::new(Ball2d::new(&config)?)
}

pub(crate) fn make(work: &mut Work) -> Result<()> {
    if let Some(part) = &work.part {
        return Err(format!("ball2d has no part `{part}`: its figures are made together").into());
    }
    paths::make(work)?;
    rest::make(work)?;
    let reference = reference::sample(work)?;
    arrival::make(work)?;
    sigma::make(work, &reference)?;
    downward::make(work, &reference)?;
    Ok(())
}

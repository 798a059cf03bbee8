//! Bowling under the regulation preset beside statistics of the game.

mod map;
mod professional;
mod published;
mod roll;
mod search;
mod symmetry;
mod window;

use crate::{Result, Work};
use plaus_scenes::bowling::Contact;

const SEED: u64 = 7_155_000;

/// A part of the comparison.
type Part = fn(&mut Work) -> Result<()>;

const PARTS: &[(&str, Part)] =
    &[("symmetry", symmetry::make), ("map", map::make), ("search", search::make), ("professionals", professionals)];

pub(crate) fn make(work: &mut Work) -> Result<()> {
    let only = work.part.clone();
    if let Some(name) = only.as_ref().filter(|name| !PARTS.iter().any(|(known, _)| known == name)) {
        let known: Vec<&str> = PARTS.iter().map(|(name, _)| *name).collect();
        return Err(format!("bowling has no part `{name}`, only {}", known.join(", ")).into());
    }
    for (_, part) in PARTS.iter().filter(|(name, _)| only.as_ref().is_none_or(|only| only == name)) {
        part(work)?;
        work.write_report()?;
    }
    Ok(())
}

fn professionals(work: &mut Work) -> Result<()> {
    let sets = [
        ("The scene's coefficients", Contact::default(), published::FIRST_BALLS),
        ("The coefficients of least misfit in the search", search::least_misfit(), 3_000),
    ];
    professional::make(work, &sets)
}

//! The worlds of the study, one file each.

mod alley;
mod bins;
mod die;
mod words;

use crate::world::World;
use plaus_figures::Result;

/// Names of all worlds, in the order of the report.
pub(crate) const NAMES: [&str; 6] = ["bins", "hi", "acm", "die", "die-bumpy", "bowling"];

/// The world of a name.
pub(crate) fn world(name: &str) -> Result<Box<dyn World>> {
    Ok(match name {
        "bins" => Box::new(bins::MarblesOverBins::new()?),
        "hi" => Box::new(words::Word::hi()?),
        "acm" => Box::new(words::Word::acm()?),
        "die" => Box::new(die::Throws::flat()?),
        "die-bumpy" => Box::new(die::Throws::bumpy()?),
        "bowling" => Box::new(alley::Shots::new()?),
        _ => return Err(format!("there is no world {name}; worlds: {}", NAMES.join(", ")).into()),
    })
}

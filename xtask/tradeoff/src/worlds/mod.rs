//! The worlds of the study, one file each.

mod alley;
mod bins;
mod bowl;
mod coin;
mod cradle;
mod die;
mod dominoes;
mod pendulum;
mod seesaw;
mod shards;
mod track;
mod words;

pub(crate) use cradle::Cradle;
pub(crate) use pendulum::Pendulum;

use crate::staged::Staged;
use crate::world::World;
use plaus_figures::Result;

/// Names of all worlds, in the order of the report.
pub(crate) const NAMES: [&str; 15] = [
    "bins",
    "hi",
    "acm",
    "die",
    "die-bumpy",
    "bowling",
    "coin",
    "track",
    "bowl",
    "dominoes",
    "shard",
    "shards",
    "seesaw",
    "cradle",
    "pendulum",
];

/// The world of a name.
pub(crate) fn world(name: &str) -> Result<Box<dyn World>> {
    Ok(match name {
        "bins" => Box::new(bins::MarblesOverBins::new()?),
        "hi" => Box::new(words::Word::hi()?),
        "acm" => Box::new(words::Word::acm()?),
        "die" => Box::new(die::Throws::flat()?),
        "die-bumpy" => Box::new(die::Throws::bumpy()?),
        "bowling" => Box::new(alley::Shots::new()?),
        "coin" => Box::new(Staged::new(coin::Coin)?),
        "track" => Box::new(Staged::new(track::Track)?),
        "bowl" => Box::new(Staged::new(bowl::Bowl)?),
        "dominoes" => Box::new(Staged::new(dominoes::Dominoes)?),
        "shard" => Box::new(Staged::new(shards::Shards::ALONE)?),
        "shards" => Box::new(Staged::new(shards::Shards::HEAP)?),
        "seesaw" => Box::new(Staged::new(seesaw::Seesaw)?),
        "cradle" => Box::new(Staged::new(Cradle)?),
        "pendulum" => Box::new(Staged::new(Pendulum)?),
        _ => return Err(format!("there is no world {name}; worlds: {}", NAMES.join(", ")).into()),
    })
}

//! Draws of the prior, counted.

use super::{ChanceError, ChancePulse, DRAW, Parts, at_least, prior, streams};
use crate::target::Goal;
use plaus_dist::Seed;
use serde::{Deserialize, Serialize};

/// Number of draws between two checks for a stop.
const AT_A_TIME: u64 = 16;

/// The counts of one batch.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Counted {
    /// Number of independent draws from the prior.
    pub draws: u64,
    /// Number of draws that reach the goal, then of those that meet each of its parts.
    pub hits: Vec<u64>,
}

/// Counts how many of `draws` draws from the prior reach the goal of `target`, and how many meet each of its `parts`.
///
/// # Errors
/// [`ChanceError`] if the model fails, there are no draws to make, or the pulse was stopped.
pub fn count<T: Goal>(
    target: &T,
    parts: Parts<'_, T>,
    seed: Seed,
    batch: u32,
    draws: u64,
    pulse: &ChancePulse,
) -> Result<Counted, ChanceError> {
    at_least("draws", draws, 1)?;
    let (streams, mut scratch) = (streams(seed, batch), T::Scratch::default());
    let mut met = vec![false; 1 + parts.count];
    let mut hits = vec![0; met.len()];
    for draw in 0..draws {
        let state = prior(target, &mut streams.at(draw, DRAW), &mut scratch);
        let state = state.map_err(|source| ChanceError::Model { batch, draw, source })?;
        parts.look(target, state.by_ref(), &mut met);
        hits.iter_mut().zip(&met).for_each(|(hits, &met)| *hits += u64::from(met));
        if (draw + 1).is_multiple_of(AT_A_TIME) || draw + 1 == draws {
            pulse.made(if draw + 1 == draws { draw % AT_A_TIME + 1 } else { AT_A_TIME })?;
        }
    }
    Ok(Counted { draws, hits })
}

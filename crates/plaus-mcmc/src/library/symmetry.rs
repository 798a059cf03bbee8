//! A symmetry of a world.

use crate::moves::{At, Move, Proposal, Transition};
use crate::target::{ModelError, StateRefOf, Target};
use plaus_dist::{LogRatio, Stream};

/// Changes the candidate, which comes in as a copy of the current draw. Returns whether there was anything to change.
pub type Map<T> = fn(&T, StateRefOf<'_, T>, &mut <T as Target>::Draw, &mut Stream) -> bool;

/// A map of draws that preserves volume: a reflection, a turn, a renumbering. It is its own reverse, or is chosen among
/// several maps, each as likely as its reverse. Symmetric; if the prior is not, its densities account for that. The
/// chain stays if there is nothing to change.
pub struct Symmetry<T: Target> {
    /// The move's name.
    pub name: &'static str,
    /// The map.
    pub map: Map<T>,
}

impl<T: Target> Move<T> for Symmetry<T> {
    fn name(&self) -> &str {
        self.name
    }

    fn propose(&self, at: At<'_, T>, candidate: &mut T::Draw, stream: &mut Stream) -> Result<Proposal, ModelError> {
        let changed = (self.map)(at.target, at.state, candidate, stream);
        Ok(if changed { Proposal::SYMMETRIC } else { Proposal::Stay })
    }

    fn log_ratio(&self, _: Transition<'_, T>) -> Result<LogRatio, ModelError> {
        Ok(LogRatio::ONE)
    }
}

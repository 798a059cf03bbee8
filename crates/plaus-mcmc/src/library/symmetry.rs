//! A symmetry of a world.

use crate::moves::{Move, Path, Proposal};
use crate::target::{ModelError, StateRefOf, Target};
use plaus_dist::{LogRatio, Stream};

/// Changes the candidate, which comes in as a copy of the current draw; whether there was anything to change.
pub type Map<T> = fn(&T, StateRefOf<'_, T>, &mut <T as Target>::Draw, &mut Stream) -> bool;

/// A map of draws that keeps volumes and is its own reverse, or one of several of which each is as likely as its
/// reverse: a reflection, a turn, a renumbering. Symmetric; where the prior is not, the prior says so. Where there is
/// nothing to change the chain stays.
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

    fn propose(
        &self,
        target: &T,
        current: StateRefOf<'_, T>,
        candidate: &mut T::Draw,
        stream: &mut Stream,
    ) -> Result<Proposal, ModelError> {
        let changed = (self.map)(target, current, candidate, stream);
        Ok(if changed { Proposal::SYMMETRIC } else { Proposal::Stay })
    }

    fn log_ratio(&self, _: &T, _: StateRefOf<'_, T>, _: StateRefOf<'_, T>, _: Path) -> Result<LogRatio, ModelError> {
        Ok(LogRatio::ONE)
    }
}

//! Some variables anew.

use super::{happens, old_over_new};
use crate::law::Recipe;
use crate::moves::{Move, Path, Proposal};
use crate::target::{ModelError, StateRefOf};
use crate::vars::{Variables, renew};
use plaus_dist::{LogRatio, Stream};

/// Each variable of a set, with probability `chance`, is drawn anew from its law. Ratio: densities of the old values
/// over those of the new ones; those that stay cancel. Where most matter to little of what happens, they forget at once
/// what small steps need thousands for.
#[derive(Debug, Clone)]
pub struct RedrawSome {
    /// The move's name.
    pub name: &'static str,
    /// The set; none of it depends on another of it.
    pub among: Vec<usize>,
    /// Probability that one is drawn anew.
    pub chance: f64,
}

impl<T: Variables> Move<T> for RedrawSome {
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
        let mut any = false;
        for &var in &self.among {
            if happens(self.chance, stream) {
                renew(target, candidate, var, Recipe::Exact, stream);
                any = true;
            }
        }
        if !any {
            return Ok(Proposal::Stay);
        }
        Ok(Proposal::with_ratio(old_over_new(target, &self.among, current.draw, candidate)?))
    }

    fn log_ratio(
        &self,
        target: &T,
        from: StateRefOf<'_, T>,
        to: StateRefOf<'_, T>,
        _: Path,
    ) -> Result<LogRatio, ModelError> {
        old_over_new(target, &self.among, from.draw, to.draw)
    }
}

//! A new draw of some variables.

use super::{happens, old_over_new};
use crate::law::Recipe;
use crate::moves::{At, Move, Proposal, Transition};
use crate::scale::Scale;
use crate::target::ModelError;
use crate::vars::{Variables, renew};
use plaus_dist::{LogRatio, Stream, math};

/// Least probability that a chain adapts to. With a thousand variables it still changes one.
const LEAST: f64 = 1e-3;

/// Each variable of a set is drawn anew from its law with probability `chance`. Ratio: density of the old values over
/// that of the new ones; variables that stay cancel. Where most variables hardly matter to what happens, this changes
/// them at once, which takes small steps thousands of iterations.
///
/// A chain may adapt the probability. If each new value spoils a solution with the same small probability, a share
/// `exp(−λ chance)` of proposals is accepted; most variables change per proposal where that is 1/e.
#[derive(Debug, Clone)]
pub struct RedrawSome {
    /// The move's name.
    pub name: &'static str,
    /// The set; none of its variables depends on another of them.
    pub among: Vec<usize>,
    /// Probability that a variable is drawn anew.
    pub chance: f64,
}

impl<T: Variables> Move<T> for RedrawSome {
    fn name(&self) -> &str {
        self.name
    }

    fn propose(&self, at: At<'_, T>, candidate: &mut T::Draw, stream: &mut Stream) -> Result<Proposal, ModelError> {
        let mut any = false;
        for &var in &self.among {
            if happens(self.chance, stream) {
                renew(at.target, candidate, var, Recipe::Exact, stream);
                any = true;
            }
        }
        if !any {
            return Ok(Proposal::Stay);
        }
        Ok(Proposal::with_ratio(old_over_new(at.target, &self.among, at.state.draw, candidate)?))
    }

    fn log_ratio(&self, step: Transition<'_, T>) -> Result<LogRatio, ModelError> {
        old_over_new(step.target, &self.among, step.from.draw, step.to.draw)
    }

    /// The probability that a variable is drawn anew.
    fn scales(&self) -> Vec<Scale> {
        let target = math::exp(-1.0);
        vec![Scale { name: "chance", start: self.chance, least: LEAST.min(self.chance), most: 1.0, target }]
    }

    fn at_scales(&self, values: &[Option<f64>]) -> Option<Box<dyn Move<T>>> {
        let chance = values.first().copied().flatten().unwrap_or(self.chance);
        Some(Box::new(Self { chance, ..self.clone() }))
    }
}

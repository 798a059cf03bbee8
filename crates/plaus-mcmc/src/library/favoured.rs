//! A change of one variable that the state favours.

use super::step::{ratio, step_by};
use super::{Sizes, happens, is_adapted, marked, old_over_new, one_of, unmarked};
use crate::law::Recipe;
use crate::moves::{At, Move, Path, Proposal, Transition};
use crate::scale::Scale;
use crate::target::{ModelError, StateRefOf};
use crate::vars::{Variables, renew};
use plaus_dist::{LogRatio, Stream, math};

/// Whether a state favours each variable of a target. It must follow from the state alone.
pub type Favours<T> = fn(&T, StateRefOf<'_, T>) -> Vec<bool>;

/// One variable of a set makes a step, as in [`Step`](super::Step), or is drawn anew. Variables that the state favours
/// are chosen [`by`](Self::by) times as often as others, for example those that a missed goal depends on. The chain
/// stays if the set is empty.
///
/// Ratio: that of the step, or the density of the old value over that of the new one; times the probability of choosing
/// the variable in the new state over that in the old one. The new state's probability needs its outcome.
#[derive(Debug)]
pub struct Favoured<T: Variables> {
    /// The move's name.
    pub name: &'static str,
    /// The set.
    pub among: Vec<usize>,
    /// What a state favours.
    pub favours: Favours<T>,
    /// How many times as often a favoured variable is chosen; at least 1.
    pub by: f64,
    /// Probability that the variable is drawn anew.
    pub anew: f64,
    /// Sizes of steps.
    pub sizes: Sizes,
}

/// A bit in a path: set if the variable was drawn anew.
const ANEW: u64 = 1 << 62;

/// Rounding of a sum and a logarithm, in nats.
const SLACK: f64 = 1e-9;

impl<T: Variables> Favoured<T> {
    /// How often each variable of the set is chosen, relative to one that the state does not favour.
    fn weights(&self, target: &T, state: StateRefOf<'_, T>) -> Vec<f64> {
        let favoured = (self.favours)(target, state);
        let weight = |var: &usize| if favoured.get(*var) == Some(&true) { self.by } else { 1.0 };
        self.among.iter().map(weight).collect()
    }

    /// Log probability of choosing the variable of a path.
    fn log_q(&self, target: &T, state: StateRefOf<'_, T>, path: Path) -> f64 {
        let weights = self.weights(target, state);
        math::ln(weights[place(path)] / weights.iter().sum::<f64>())
    }

    /// The ratio of the change alone.
    fn changed(&self, target: &T, [from, to]: [&T::Draw; 2], path: Path) -> Result<LogRatio, ModelError> {
        let var = self.among[place(path)];
        if path.0 & ANEW == 0 { ratio(target, from, to, var) } else { old_over_new(target, &[var], from, to) }
    }
}

/// The place of a path's variable in the set.
fn place(path: Path) -> usize {
    (unmarked(path).0 & !ANEW) as usize
}

impl<T: Variables + 'static> Move<T> for Favoured<T> {
    fn name(&self) -> &str {
        self.name
    }

    fn propose(&self, at: At<'_, T>, candidate: &mut T::Draw, stream: &mut Stream) -> Result<Proposal, ModelError> {
        let weights = self.weights(at.target, at.state);
        let chosen = one_of(weights.iter().copied(), stream);
        // Rounding may leave a little more than nothing.
        let Some(index) = chosen.or(weights.len().checked_sub(1)) else { return Ok(Proposal::Stay) };
        let var = self.among[index];
        let path = if happens(self.anew, stream) {
            renew(at.target, candidate, var, Recipe::Exact, stream);
            Path(index as u64 | ANEW)
        } else {
            let (size, is_wide) = self.sizes.sample(stream);
            step_by(at.target, candidate, var, size, stream);
            marked(Path(index as u64), is_wide)
        };
        let chosen = LogRatio::new(-self.log_q(at.target, at.state, path))?;
        let log_ratio = self.changed(at.target, [at.state.draw, candidate], path)?.times(chosen)?;
        // No state favours a variable more than one that favours it alone.
        let most = math::ln(self.by / (self.by + (weights.len() - 1) as f64)) + SLACK;
        Ok(Proposal::Candidate { log_ratio, path, later: Some(LogRatio::new(most)?) })
    }

    fn log_ratio(&self, step: Transition<'_, T>) -> Result<LogRatio, ModelError> {
        let chosen = self.log_q(step.target, step.to, step.path) - self.log_q(step.target, step.from, step.path);
        Ok(self.changed(step.target, [step.from.draw, step.to.draw], step.path)?.times(LogRatio::new(chosen)?)?)
    }

    fn log_ratio_after(&self, step: Transition<'_, T>) -> Result<LogRatio, ModelError> {
        Ok(LogRatio::new(self.log_q(step.target, step.to, step.path))?)
    }

    fn scales(&self) -> Vec<Scale> {
        vec![self.sizes.declared("step", Scale::ONE)]
    }

    fn at_scales(&self, values: &[Option<f64>]) -> Option<Box<dyn Move<T>>> {
        let sizes = self.sizes.about(values.first().copied().flatten());
        let Self { name, favours, by, anew, .. } = *self;
        Some(Box::new(Self { name, among: self.among.clone(), favours, by, anew, sizes }))
    }

    fn scale_of(&self, path: Path) -> Option<usize> {
        (is_adapted(path) && path.0 & ANEW == 0).then_some(0)
    }
}

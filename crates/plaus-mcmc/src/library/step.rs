//! A step that leaves a variable's law invariant.

use super::sizes::normal_step;
use super::{Sizes, is_adapted, marked, unmarked};
use crate::law::Law;
use crate::moves::{At, Move, Path, Proposal, Transition};
use crate::scale::Scale;
use crate::target::ModelError;
use crate::vars::Variables;
use plaus_dist::stream::below;
use plaus_dist::{Density, LogDensity, LogRatio, NotANumber, Stream, standard_normal};

/// A way to make a step: which variable makes it, and which sizes it has.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Way {
    /// The variable.
    pub var: usize,
    /// Index of its sizes in [`Step::sizes`].
    pub size: usize,
}

/// One variable makes a step of a random size s that leaves its law invariant. With ξ a standard normal number, a
/// number z standard deviations from its mean goes to √(1 − s²) z + s ξ. A number on an interval or a rectangle with
/// joined ends moves by s ξ times its width. For a variable that is not made of numbers, the target makes the step.
///
/// Ratio: the Gaussian's density at the old value over that at the new one, before anything is cut off; the prior
/// rejects what a cut forbids. All other steps are symmetric.
#[derive(Debug, Clone)]
pub struct Step {
    /// The move's name.
    pub name: &'static str,
    /// The ways, group by group. A group is chosen, then one of its ways, each equally likely.
    pub ways: Vec<Way>,
    /// How many ways a group has.
    pub each: usize,
    /// Sizes of steps with their names.
    pub sizes: Vec<(&'static str, Sizes)>,
}

impl Step {
    /// Steps of one range of sizes, for each of these variables.
    #[must_use]
    pub fn of(name: &'static str, vars: &[usize], sizes: Sizes) -> Self {
        let ways: Vec<Way> = vars.iter().map(|&var| Way { var, size: 0 }).collect();
        Self { name, each: ways.len(), ways, sizes: vec![("step", sizes)] }
    }

    fn way(&self, path: Path) -> Option<&Way> {
        self.ways.get(unmarked(path).0 as usize)
    }
}

/// Moves a variable by a step of this size.
pub(super) fn step_by<T: Variables>(target: &T, draw: &mut T::Draw, var: usize, size: f64, stream: &mut Stream) {
    let law = &target.vars().get(var).law;
    let shift = target.shift(draw, var);
    if let Law::Own = law {
        return target.step_own(draw, var, size, stream);
    }
    let Some(values) = target.get_mut(draw, var) else { return };
    let Some(gaussian) = law.gaussian() else {
        let width = size * law.width();
        let step = [(); super::MOST].map(|()| width * standard_normal(stream));
        return law.add(&step, values);
    };
    for value in values {
        let old = *value + shift;
        let z = normal_step(size, (old - gaussian.mean()) / gaussian.sd(), stream);
        *value += gaussian.mean() + gaussian.sd() * z - old;
    }
}

/// Density of a variable's value under the Gaussian that its steps leave invariant; 1 if there is none.
fn gaussian_density<T: Variables>(target: &T, draw: &T::Draw, var: usize) -> Result<LogDensity, NotANumber> {
    let (Some(gaussian), Some(values)) = (target.vars().get(var).law.gaussian(), target.get(draw, var)) else {
        return Ok(LogDensity::ONE);
    };
    let shift = target.shift(draw, var);
    values.iter().try_fold(LogDensity::ONE, |sum, value| Ok(sum + gaussian.log_density(&(value + shift))?))
}

/// The ratio of a variable's step.
pub(super) fn ratio<T: Variables>(
    target: &T,
    from: &T::Draw,
    to: &T::Draw,
    var: usize,
) -> Result<LogRatio, ModelError> {
    Ok(LogRatio::of(gaussian_density(target, from, var)?, gaussian_density(target, to, var)?)?)
}

impl<T: Variables> Move<T> for Step {
    fn name(&self) -> &str {
        self.name
    }

    fn propose(&self, at: At<'_, T>, candidate: &mut T::Draw, stream: &mut Stream) -> Result<Proposal, ModelError> {
        let group = below(stream, self.ways.len() / self.each.max(1));
        let index = group * self.each + below(stream, self.each);
        let Some(&Way { var, size }) = self.ways.get(index) else { return Ok(Proposal::Stay) };
        let (length, is_wide) = self.sizes[size].1.sample(stream);
        step_by(at.target, candidate, var, length, stream);
        let log_ratio = ratio(at.target, at.state.draw, candidate, var)?;
        Ok(Proposal::Candidate { log_ratio, path: marked(Path(index as u64), is_wide), later: None })
    }

    fn log_ratio(&self, step: Transition<'_, T>) -> Result<LogRatio, ModelError> {
        match self.way(step.path) {
            Some(way) => ratio(step.target, step.from.draw, step.to.draw, way.var),
            None => Ok(LogRatio::ONE),
        }
    }

    fn scales(&self) -> Vec<Scale> {
        self.sizes.iter().map(|(name, sizes)| sizes.declared(name, Scale::ONE)).collect()
    }

    fn at_scales(&self, values: &[Option<f64>]) -> Option<Box<dyn Move<T>>> {
        let mut adapted = self.clone();
        adapted.sizes.iter_mut().zip(values).for_each(|((_, sizes), value)| *sizes = sizes.about(*value));
        Some(Box::new(adapted))
    }

    fn scale_of(&self, path: Path) -> Option<usize> {
        self.way(path).filter(|_| is_adapted(path)).map(|way| way.size)
    }
}

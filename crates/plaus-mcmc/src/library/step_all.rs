//! A step of all variables that leaves their laws invariant.

use super::step::{ratio, step_by};
use super::{Sizes, is_adapted, marked};
use crate::moves::{At, Move, Path, Proposal, Transition};
use crate::scale::Scale;
use crate::target::ModelError;
use crate::vars::Variables;
use plaus_dist::{LogRatio, Stream};

/// All variables of a set make a step of one random size that leaves their laws invariant, each as in
/// [`Step`](super::Step) (Cotter, Roberts, Stuart and White, "MCMC methods for functions", Statistical Science 28,
/// 2013). If an outcome depends a little on each of many variables, this step moves it at any number of them, whereas
/// random walks need shorter and shorter steps. The chain stays if the set is empty.
///
/// Ratio: the product of the single steps' ratios.
#[derive(Debug, Clone)]
pub struct StepAll {
    /// The move's name.
    pub name: &'static str,
    /// The set.
    pub among: Vec<usize>,
    /// Sizes of the step.
    pub sizes: Sizes,
}

impl StepAll {
    fn ratio<T: Variables>(&self, target: &T, from: &T::Draw, to: &T::Draw) -> Result<LogRatio, ModelError> {
        self.among.iter().try_fold(LogRatio::ONE, |all, &var| Ok(all.times(ratio(target, from, to, var)?)?))
    }
}

impl<T: Variables> Move<T> for StepAll {
    fn name(&self) -> &str {
        self.name
    }

    fn propose(&self, at: At<'_, T>, candidate: &mut T::Draw, stream: &mut Stream) -> Result<Proposal, ModelError> {
        if self.among.is_empty() {
            return Ok(Proposal::Stay);
        }
        let (size, is_wide) = self.sizes.sample(stream);
        self.among.iter().for_each(|&var| step_by(at.target, candidate, var, size, stream));
        let log_ratio = self.ratio(at.target, at.state.draw, candidate)?;
        Ok(Proposal::Candidate { log_ratio, path: marked(Path(0), is_wide), later: None })
    }

    fn log_ratio(&self, step: Transition<'_, T>) -> Result<LogRatio, ModelError> {
        self.ratio(step.target, step.from.draw, step.to.draw)
    }

    fn scales(&self) -> Vec<Scale> {
        vec![self.sizes.declared("step", Scale::MANY)]
    }

    fn at_scales(&self, values: &[Option<f64>]) -> Option<Box<dyn Move<T>>> {
        let sizes = self.sizes.about(values.first().copied().flatten());
        Some(Box::new(Self { sizes, ..self.clone() }))
    }

    fn scale_of(&self, path: Path) -> Option<usize> {
        is_adapted(path).then_some(0)
    }
}

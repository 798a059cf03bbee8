//! Everything anew, with numbers from a density that was learnt in the warm-up.

use super::happens;
use crate::fit::Fit;
use crate::law::Recipe;
use crate::moves::{Move, Path, Proposal};
use crate::target::{ModelError, StateRefOf};
use crate::vars::{Variables, Vars, log_density_of};
use plaus_dist::{LogRatio, Stream, math};
use std::sync::Arc;

/// The share of proposals that come from the prior. It bounds what a density that fits badly can cost: a state is held
/// at most ten times as long as if all came from the prior.
const PRIOR: f64 = 0.1;

/// A draw that shares nothing with the current one: its learnt variables from a mixture of the prior and a [`Fit`] to
/// the states of the warm-up, all others, also those that no numbers hold, from the prior given what they depend on.
/// Until there is a fit, it is a fresh draw of the prior. Without learnt variables the chain stays.
///
/// Ratio: density of the old draw over that of the new one, of the whole mixture, whichever part of it made the new
/// one: `p(old) m(old) / p(new) m(new)`, `m = s + (1 − s) g / p_learnt`, with s the prior's share and g the fit's
/// density. What is not learnt is drawn from its law, so that m does not see it.
#[derive(Debug, Clone)]
pub struct Learned {
    name: &'static str,
    among: Vec<usize>,
    fit: Option<Arc<Fit>>,
}

impl Learned {
    /// It learns the variables that are columns of tables, each of one number with a density, on which no other hangs,
    /// and which no draw lacks.
    #[must_use]
    pub fn of(name: &'static str, vars: &Vars) -> Self {
        let needed: Vec<usize> = vars.iter().filter_map(|var| var.law.depends_on()).collect();
        let mut among =
            vars.which(|var| var.column.is_some() && !var.optional && var.law.is_density() && var.law.width() > 0.0);
        among.retain(|var| !needed.contains(var));
        Self { name, among, fit: None }
    }

    /// The indices of the variables it learns.
    #[must_use]
    pub fn among(&self) -> &[usize] {
        &self.among
    }

    /// The values of those in a draw, each in units of its law's width.
    pub fn point<T: Variables>(&self, target: &T, draw: &T::Draw) -> Vec<f64> {
        let value = |&var: &usize| {
            let number = target.get(draw, var).and_then(|values| values.first().copied()).unwrap_or(f64::NAN);
            (number + target.shift(draw, var)) / target.vars().get(var).law.width()
        };
        self.among.iter().map(value).collect()
    }

    fn set<T: Variables>(&self, target: &T, draw: &mut T::Draw, point: &[f64]) {
        for (&var, x) in self.among.iter().zip(point) {
            let value = x * target.vars().get(var).law.width() - target.shift(draw, var);
            if let Some(values) = target.get_mut(draw, var) {
                values.fill(value);
            }
        }
    }

    /// Log of the mixture's density over the prior's.
    fn over_prior<T: Variables>(&self, target: &T, draw: &T::Draw) -> Result<f64, ModelError> {
        let Some(fit) = &self.fit else { return Ok(0.0) };
        let widths: f64 = self.among.iter().map(|&var| math::ln(target.vars().get(var).law.width())).sum();
        let learnt = fit.log_density(&self.point(target, draw)) - widths;
        let prior = log_density_of(target, draw, self.among.iter().copied())?.value();
        Ok(math::ln_add_exp(math::ln(PRIOR), math::ln(1.0 - PRIOR) + learnt - prior))
    }

    fn ratio<T: Variables>(&self, target: &T, from: &T::Draw, to: &T::Draw) -> Result<LogRatio, ModelError> {
        let prior = LogRatio::of(target.log_prior(from)?, target.log_prior(to)?)?;
        Ok(prior.times(LogRatio::new(self.over_prior(target, from)? - self.over_prior(target, to)?)?)?)
    }
}

impl<T: Variables> Move<T> for Learned {
    fn name(&self) -> &str {
        self.name
    }

    /// The path is 0 where the prior made the numbers, else that of the fit's kernel that did, and 1.
    fn propose(
        &self,
        target: &T,
        current: StateRefOf<'_, T>,
        candidate: &mut T::Draw,
        stream: &mut Stream,
    ) -> Result<Proposal, ModelError> {
        if self.among.is_empty() {
            return Ok(Proposal::Stay);
        }
        target.renew_all(candidate, Recipe::Exact, stream);
        let mut path = Path(0);
        if let Some(fit) = self.fit.as_ref().filter(|_| !happens(PRIOR, stream)) {
            let (kernel, point) = fit.sample(stream);
            self.set(target, candidate, &point);
            path = Path(kernel as u64 + 1);
        }
        if target.log_prior(candidate)?.is_zero() {
            // The chain rejects it for its prior; no ratio is needed.
            return Ok(Proposal::SYMMETRIC);
        }
        Ok(Proposal::Candidate { log_ratio: self.ratio(target, current.draw, candidate)?, path, later: None })
    }

    fn log_ratio(
        &self,
        target: &T,
        from: StateRefOf<'_, T>,
        to: StateRefOf<'_, T>,
        _: Path,
    ) -> Result<LogRatio, ModelError> {
        self.ratio(target, from.draw, to.draw)
    }

    fn learns(&self) -> usize {
        self.among.len()
    }

    fn learn_from(&self, target: &T, state: StateRefOf<'_, T>) -> Vec<f64> {
        self.point(target, state.draw)
    }

    fn at_fit(&self, fit: &Fit) -> Option<Box<dyn Move<T>>> {
        Some(Box::new(Self { fit: Some(Arc::new(fit.clone())), ..self.clone() }))
    }
}

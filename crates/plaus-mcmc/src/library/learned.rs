//! New values for numbers, from a density learnt in the warm-up.

use super::{happens, old_over_new};
use crate::fit::Fit;
use crate::law::Recipe;
use crate::moves::{At, Move, Path, Proposal, Transition};
use crate::target::{ModelError, StateRefOf};
use crate::vars::{Member, Variables, Vars, log_density_of, renew};
use plaus_dist::stream::below;
use plaus_dist::{LogRatio, Stream, math};
use std::sync::Arc;

/// Share of proposals that come from the prior. It bounds the cost of a density that fits badly: a state is held at
/// most ten times as long as if all proposals came from the prior.
const PRIOR: f64 = 0.1;
/// Largest number of variables in a part if only some of them are proposed.
const MOST: usize = 16;

/// Variables of a part get values that do not depend on their old ones. They come from a mixture of the variables' laws
/// and a [`Fit`] to the states of the warm-up, both given the part's variables that are not chosen. Everything else
/// stays as it is, including variables that are not made of numbers. Until there is a fit, only the laws propose. The
/// chain stays if there are no variables to learn.
///
/// Ratio: the whole mixture's density at the old values over that at the new ones, whichever component made the new
/// ones: `p(old) m(old) / p(new) m(new)`, `m = s + (1 − s) g / p`. Here p is the density of the chosen variables under
/// their laws, s the laws' share of proposals, and g the fit's density given the variables that are not chosen.
#[derive(Debug, Clone)]
pub struct Learned {
    name: &'static str,
    parts: Vec<Vec<usize>>,
    /// Whether each variable of the part is chosen with probability ½; otherwise all are.
    some: bool,
    /// By part; empty before anything is learnt.
    fits: Arc<[Option<Fit>]>,
}

impl Learned {
    /// All variables that can be learnt, as one part: those that are columns of tables, are one number with a density,
    /// have no other variable depending on them, and are present in every draw.
    #[must_use]
    pub fn of(name: &'static str, vars: &Vars) -> Self {
        let all = learnable(vars);
        let parts = if all.is_empty() { Vec::new() } else { vec![all] };
        Self { name, parts, some: false, fits: Arc::new([]) }
    }

    /// One part for each body or part of the world; each is equally likely, and each of its variables is chosen with
    /// probability ½. The variables that belong to none form a part too. A part of more than sixteen variables is cut
    /// into several.
    #[must_use]
    pub fn some_of(name: &'static str, vars: &Vars) -> Self {
        let all = learnable(vars);
        let mut members: Vec<Option<Member>> = all.iter().map(|&var| vars.get(var).member).collect();
        members.sort_unstable();
        members.dedup();
        let of = |member| all.iter().copied().filter(move |&var| vars.get(var).member == member).collect::<Vec<_>>();
        let parts =
            members.into_iter().flat_map(|member| of(member).chunks(MOST).map(<[_]>::to_vec).collect::<Vec<_>>());
        Self { name, parts: parts.collect(), some: true, fits: Arc::new([]) }
    }

    /// The indices of the variables it learns, by part.
    #[must_use]
    pub fn parts(&self) -> &[Vec<usize>] {
        &self.parts
    }

    /// The values of a draw's variables, each in units of its law's width.
    fn values<T: Variables>(target: &T, draw: &T::Draw, vars: &[usize]) -> Vec<f64> {
        let value = |&var: &usize| {
            let number = target.get(draw, var).and_then(|values| values.first().copied()).unwrap_or(f64::NAN);
            (number + target.shift(draw, var)) / target.vars().get(var).law.width()
        };
        vars.iter().map(value).collect()
    }

    /// The values of all variables that it learns, part by part.
    pub fn point<T: Variables>(&self, target: &T, draw: &T::Draw) -> Vec<f64> {
        self.parts.iter().flat_map(|part| Self::values(target, draw, part)).collect()
    }

    /// The choice that a path records.
    #[must_use]
    pub fn chosen(&self, path: Path) -> Chosen {
        let (part, mask) = ((path.0 >> 32) as usize, path.0 >> 16 & 0xffff);
        let is_chosen = |k: &usize| !self.some || mask >> k & 1 == 1;
        let (new, mut order): (Vec<usize>, Vec<usize>) = (0..self.parts[part].len()).partition(is_chosen);
        let known = order.len();
        order.extend(new);
        Chosen { part, vars: order.iter().map(|&k| self.parts[part][k]).collect(), order, known }
    }

    /// The fit to the part, with its numbers in the chosen order.
    fn fit(&self, chosen: &Chosen) -> Option<Fit> {
        let fit = self.fits.get(chosen.part)?.as_ref()?;
        if chosen.known == 0 { Some(fit.clone()) } else { fit.ordered(&chosen.order) }
    }

    /// The mixture's density at the old draw over that at the new one.
    fn ratio<T: Variables>(
        target: &T,
        chosen: &Chosen,
        fit: Option<&Fit>,
        [from, to]: [&T::Draw; 2],
    ) -> Result<LogRatio, ModelError> {
        let anew = chosen.anew();
        if log_density_of(target, to, anew.iter().copied())?.is_zero() {
            // The chain rejects it for its prior; no ratio is needed.
            return Ok(LogRatio::ONE);
        }
        let widths: f64 = anew.iter().map(|&var| math::ln(target.vars().get(var).law.width())).sum();
        let over_laws = |draw: &T::Draw| -> Result<f64, ModelError> {
            let Some(fit) = fit else { return Ok(0.0) };
            let learnt = fit.log_density(&Self::values(target, draw, &chosen.vars), chosen.known) - widths;
            let laws = log_density_of(target, draw, anew.iter().copied())?.value();
            Ok(math::ln_add_exp(math::ln(PRIOR), math::ln(1.0 - PRIOR) + learnt - laws))
        };
        let mixture = LogRatio::new(over_laws(from)? - over_laws(to)?)?;
        Ok(old_over_new(target, anew, from, to)?.times(mixture)?)
    }
}

/// The variables of a part, ordered so that those that get new values come last.
#[derive(Debug, Clone, PartialEq)]
pub struct Chosen {
    /// The part.
    pub part: usize,
    /// The places of its variables in the part.
    pub order: Vec<usize>,
    /// The variables.
    pub vars: Vec<usize>,
    /// How many of them keep their values.
    pub known: usize,
}

impl Chosen {
    fn anew(&self) -> &[usize] {
        &self.vars[self.known..]
    }
}

fn learnable(vars: &Vars) -> Vec<usize> {
    let needed: Vec<usize> = vars.iter().filter_map(|var| var.law.depends_on()).collect();
    let mut all =
        vars.which(|var| var.column.is_some() && !var.optional && var.law.is_density() && var.law.width() > 0.0);
    all.retain(|var| !needed.contains(var));
    all
}

impl<T: Variables> Move<T> for Learned {
    fn name(&self) -> &str {
        self.name
    }

    /// The path holds the part, which of its variables get new values, and what made them: 0 for their laws, one more
    /// than the kernel's index for a kernel of the fit.
    fn propose(&self, at: At<'_, T>, candidate: &mut T::Draw, stream: &mut Stream) -> Result<Proposal, ModelError> {
        if self.parts.is_empty() {
            return Ok(Proposal::Stay);
        }
        let part = below(stream, self.parts.len());
        let count = if self.some { self.parts[part].len() } else { 0 };
        let mask = (0..count).fold(0, |mask, k| mask | u64::from(happens(0.5, stream)) << k);
        let mut path = Path((part as u64) << 32 | mask << 16);
        let chosen = self.chosen(path);
        let fit = self.fit(&chosen);
        if chosen.anew().is_empty() {
            return Ok(Proposal::Stay);
        }
        if let Some(fit) = fit.as_ref().filter(|_| !happens(PRIOR, stream)) {
            let known = Self::values(at.target, at.state.draw, &chosen.vars[..chosen.known]);
            let (kernel, point) = fit.sample(&known, stream);
            for (&var, x) in chosen.anew().iter().zip(&point[chosen.known..]) {
                let value = x * at.target.vars().get(var).law.width() - at.target.shift(candidate, var);
                if let Some(values) = at.target.get_mut(candidate, var) {
                    values.fill(value);
                }
            }
            path.0 |= kernel as u64 + 1;
        } else {
            chosen.anew().iter().for_each(|&var| renew(at.target, candidate, var, Recipe::Exact, stream));
        }
        let log_ratio = Self::ratio(at.target, &chosen, fit.as_ref(), [at.state.draw, candidate])?;
        Ok(Proposal::Candidate { log_ratio, path, later: None })
    }

    fn log_ratio(&self, step: Transition<'_, T>) -> Result<LogRatio, ModelError> {
        let chosen = self.chosen(step.path);
        Self::ratio(step.target, &chosen, self.fit(&chosen).as_ref(), [step.from.draw, step.to.draw])
    }

    fn learns(&self) -> Vec<usize> {
        self.parts.iter().map(Vec::len).collect()
    }

    fn learn_from(&self, target: &T, state: StateRefOf<'_, T>) -> Vec<f64> {
        self.point(target, state.draw)
    }

    fn at_fits(&self, fits: &[Option<Fit>]) -> Option<Box<dyn Move<T>>> {
        Some(Box::new(Self { fits: fits.into(), ..self.clone() }))
    }
}

//! Numbers anew from a density that was learnt in the warm-up.

use super::{happens, old_over_new};
use crate::fit::Fit;
use crate::law::Recipe;
use crate::moves::{Move, Path, Proposal};
use crate::target::{ModelError, StateRefOf};
use crate::vars::{Member, Variables, Vars, log_density_of, renew};
use plaus_dist::stream::below;
use plaus_dist::{LogRatio, Stream, math};
use std::sync::Arc;

/// The share of proposals that come from the prior. It bounds what a density that fits badly can cost: a state is held
/// at most ten times as long as if all came from the prior.
const PRIOR: f64 = 0.1;
/// Most variables of a part of which some are proposed.
const MOST: usize = 16;

/// Variables of a part get values that do not hang on their old ones: from a mixture of their laws and a [`Fit`] to the
/// states of the warm-up, given those variables of the part that are not chosen. All else stays as it is, also what no
/// numbers hold. Until there is a fit, the laws alone propose. Without learnt variables the chain stays.
///
/// Ratio: density of the old values over that of the new ones, of the whole mixture, whichever part of it made the new
/// ones: `p(old) m(old) / p(new) m(new)`, `m = s + (1 − s) g / p`, with p the density of the chosen variables' laws, s
/// their share and g the fit's density given the others.
#[derive(Debug, Clone)]
pub struct Learned {
    name: &'static str,
    parts: Vec<Vec<usize>>,
    /// Whether each variable of the part is chosen with probability ½, rather than all.
    some: bool,
    /// By part; none before anything was learnt.
    fits: Arc<[Option<Fit>]>,
}

impl Learned {
    /// All that can be learnt, at once: the variables that are columns of tables, each of one number with a density, on
    /// which no other hangs, and which no draw lacks.
    #[must_use]
    pub fn of(name: &'static str, vars: &Vars) -> Self {
        let all = learnable(vars);
        let parts = if all.is_empty() { Vec::new() } else { vec![all] };
        Self { name, parts, some: false, fits: Arc::new([]) }
    }

    /// Some of those of one body or part, each part as likely, each of its variables with probability ½. What belongs
    /// to none is a part too; one of more than sixteen variables is cut into several.
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

    /// Those of all that it learns, part by part.
    pub fn point<T: Variables>(&self, target: &T, draw: &T::Draw) -> Vec<f64> {
        self.parts.iter().flat_map(|part| Self::values(target, draw, part)).collect()
    }

    /// What a path says was chosen.
    #[must_use]
    pub fn chosen(&self, path: Path) -> Chosen {
        let (part, mask) = ((path.0 >> 32) as usize, path.0 >> 16 & 0xffff);
        let is_chosen = |k: &usize| !self.some || mask >> k & 1 == 1;
        let (new, mut order): (Vec<usize>, Vec<usize>) = (0..self.parts[part].len()).partition(is_chosen);
        let known = order.len();
        order.extend(new);
        Chosen { part, vars: order.iter().map(|&k| self.parts[part][k]).collect(), order, known }
    }

    /// The fit to the part, with its numbers in this order.
    fn fit(&self, chosen: &Chosen) -> Option<Fit> {
        let fit = self.fits.get(chosen.part)?.as_ref()?;
        if chosen.known == 0 { Some(fit.clone()) } else { fit.ordered(&chosen.order) }
    }

    /// The way the mixture's density over the laws' differs between two draws, old over new, times that of the laws.
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

/// Variables of a part in an order in which those come last that are to have new values.
#[derive(Debug, Clone, PartialEq)]
pub struct Chosen {
    /// The part.
    pub part: usize,
    /// The places of its variables in the part.
    pub order: Vec<usize>,
    /// The variables.
    pub vars: Vec<usize>,
    /// How many of them stay.
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

    /// The path holds the part, which of its variables have new values, and the fit's kernel that made them and 1, or 0
    /// where their laws did.
    fn propose(
        &self,
        target: &T,
        current: StateRefOf<'_, T>,
        candidate: &mut T::Draw,
        stream: &mut Stream,
    ) -> Result<Proposal, ModelError> {
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
            let known = Self::values(target, current.draw, &chosen.vars[..chosen.known]);
            let (kernel, point) = fit.sample(&known, stream);
            for (&var, x) in chosen.anew().iter().zip(&point[chosen.known..]) {
                let value = x * target.vars().get(var).law.width() - target.shift(candidate, var);
                if let Some(values) = target.get_mut(candidate, var) {
                    values.fill(value);
                }
            }
            path.0 |= kernel as u64 + 1;
        } else {
            chosen.anew().iter().for_each(|&var| renew(target, candidate, var, Recipe::Exact, stream));
        }
        let log_ratio = Self::ratio(target, &chosen, fit.as_ref(), [current.draw, candidate])?;
        Ok(Proposal::Candidate { log_ratio, path, later: None })
    }

    fn log_ratio(
        &self,
        target: &T,
        from: StateRefOf<'_, T>,
        to: StateRefOf<'_, T>,
        path: Path,
    ) -> Result<LogRatio, ModelError> {
        let chosen = self.chosen(path);
        Self::ratio(target, &chosen, self.fit(&chosen).as_ref(), [from.draw, to.draw])
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

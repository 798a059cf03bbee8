//! What a draw is made of: named variables, each with its unit, its law, and the body or part it belongs to.
//!
//! A target that declares its variables gets the moves of [`crate::library`], a prior density and draws from the prior
//! for free, and its readers get names, units and dimensions. The draw itself may have any form: the target says where
//! a variable's numbers are.

use crate::law::{Law, Recipe};
use crate::target::Target;
use plaus_dist::{Density, LogDensity, NotANumber, Stream, open_unit};
use serde::Serialize;
use std::borrow::Cow;

/// The body or part, of several, that something belongs to: ball 3, pin 7.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
pub struct Member {
    /// Their kind, as the name of a dimension: `ball`.
    pub kind: &'static str,
    /// Its number.
    pub number: u32,
}

/// A random variable of a draw.
#[derive(Debug, Clone)]
pub struct Var {
    /// Its name, the same for all members of a kind.
    pub name: Cow<'static, str>,
    /// The unit of its column; empty for pure numbers.
    pub unit: &'static str,
    /// Its law, in the draw's own unit.
    pub law: Law,
    /// The member it belongs to; `None` if there is only one.
    pub member: Option<Member>,
    /// Whether a draw may lack it, with probability ½.
    pub optional: bool,
    /// The factor from the draw's unit to the column's, for a variable that is a column of tables and is diagnosed.
    pub column: Option<f64>,
}

impl Var {
    /// A variable that is not shown as a column.
    #[must_use]
    pub fn new(name: impl Into<Cow<'static, str>>, unit: &'static str, law: Law) -> Self {
        Self { name: name.into(), unit, law, member: None, optional: false, column: None }
    }

    /// The same variable, belonging to a body or part.
    #[must_use]
    pub fn of(self, kind: &'static str, number: u32) -> Self {
        Self { member: Some(Member { kind, number }), ..self }
    }

    /// The same variable, as one that a draw may lack.
    #[must_use]
    pub fn optional(self) -> Self {
        Self { optional: true, ..self }
    }

    /// The same variable, shown as a column, in a unit that is the draw's divided by `factor`.
    #[must_use]
    pub fn column(self, factor: f64) -> Self {
        Self { column: Some(factor), ..self }
    }
}

/// The variables of a target's draws, in order.
#[derive(Debug, Clone, Default)]
pub struct Vars {
    all: Vec<Var>,
    groups: Vec<Vec<usize>>,
    /// Log probability of which optional variables are present and which are absent.
    presence: f64,
}

impl Vars {
    /// These variables.
    #[must_use]
    pub fn new(all: Vec<Var>) -> Self {
        let mut members: Vec<Member> = all.iter().filter_map(|var| var.member).collect();
        members.sort_unstable();
        members.dedup();
        let of = |member| (0..all.len()).filter(|&k| all[k].member == Some(member)).collect();
        let optional = all.iter().filter(|var| var.optional).count();
        let presence = 0.0 - optional as f64 * std::f64::consts::LN_2;
        Self { groups: members.into_iter().map(of).collect(), presence, all }
    }

    /// The same variables in other groups than the members': lists of indices of variables that belong together.
    #[must_use]
    pub fn in_groups(self, groups: Vec<Vec<usize>>) -> Self {
        Self { groups, ..self }
    }

    /// How many there are.
    #[must_use]
    pub fn len(&self) -> usize {
        self.all.len()
    }

    /// Whether there is none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.all.is_empty()
    }

    /// One of them, by its index.
    #[inline]
    #[must_use]
    pub fn get(&self, var: usize) -> &Var {
        &self.all[var]
    }

    /// All of them.
    pub fn iter(&self) -> impl Iterator<Item = &Var> {
        self.all.iter()
    }

    /// The indices of the uncertain variables that `choose` accepts.
    pub fn which(&self, choose: impl Fn(&Var) -> bool) -> Vec<usize> {
        (0..self.all.len()).filter(|&k| self.all[k].law.is_uncertain() && choose(&self.all[k])).collect()
    }

    /// The indices of the uncertain variables with these names, in order.
    #[must_use]
    pub fn named(&self, names: &[&str]) -> Vec<usize> {
        self.which(|var| names.contains(&var.name.as_ref()))
    }

    /// The indices of each member's variables, in order of kind and number; or the groups that were given.
    #[must_use]
    pub fn groups(&self) -> &[Vec<usize>] {
        &self.groups
    }
}

/// A target that says which variables its draws hold, and where.
pub trait Variables: Target {
    /// The variables.
    fn vars(&self) -> &Vars;

    /// The numbers of a variable; `None` if the draw lacks it, or if it is not made of numbers.
    fn get<'a>(&self, draw: &'a Self::Draw, var: usize) -> Option<&'a [f64]>;

    /// The same, to change.
    fn get_mut<'a>(&self, draw: &'a mut Self::Draw, var: usize) -> Option<&'a mut [f64]>;

    /// Adds an optional variable to a draw, with any numbers, or removes it.
    fn set_present(&self, _draw: &mut Self::Draw, _var: usize, _present: bool) {}

    /// The difference between a variable's value and its number: a common shift that a draw holds separately.
    #[inline]
    fn shift(&self, _draw: &Self::Draw, _var: usize) -> f64 {
        0.0
    }

    /// A fresh value of a variable whose law is [`Law::Own`].
    fn renew_own(&self, _draw: &mut Self::Draw, _var: usize, _stream: &mut Stream) {}

    /// A step of such a variable, `size` times the largest one, that preserves its law: weighted by that law, it is as
    /// likely as the way back.
    fn step_own(&self, _draw: &mut Self::Draw, _var: usize, _size: f64, _stream: &mut Stream) {}

    /// A new draw of all variables, in order. Every variable that is not optional is already there.
    fn renew_all(&self, draw: &mut Self::Draw, recipe: Recipe, stream: &mut Stream) {
        for var in 0..self.vars().len() {
            if self.vars().get(var).optional {
                let present = open_unit(stream) < 0.5;
                self.set_present(draw, var, present);
                if !present {
                    continue;
                }
            }
            renew(self, draw, var, recipe, stream);
        }
    }

    /// A new draw of one group's variables, by its index in [`Vars::groups`]. A variable that the draw lacks stays
    /// absent.
    fn renew_group(&self, draw: &mut Self::Draw, group: usize, stream: &mut Stream) {
        for &var in &self.vars().groups()[group] {
            renew(self, draw, var, Recipe::Exact, stream);
        }
    }
}

/// The value of the variable that another one's law depends on.
fn other<T: Variables + ?Sized>(target: &T, draw: &T::Draw, law: &Law) -> f64 {
    let other = law.depends_on().and_then(|other| target.get(draw, other));
    other.and_then(|values| values.first().copied()).unwrap_or(f64::NAN)
}

/// Draws a variable anew, which the draw must have.
pub fn renew<T: Variables + ?Sized>(target: &T, draw: &mut T::Draw, var: usize, recipe: Recipe, stream: &mut Stream) {
    let law = &target.vars().get(var).law;
    if let Law::Own = law {
        return target.renew_own(draw, var, stream);
    }
    let (other, shift) = (other(target, draw, law), target.shift(draw, var));
    if let Some(values) = target.get_mut(draw, var) {
        law.sample(other, recipe, stream, values);
        if shift != 0.0 {
            values.iter_mut().for_each(|value| *value -= shift);
        }
    }
}

/// Log density of a variable's value, given the others; the density is 1 if the draw lacks it.
///
/// # Errors
/// [`NotANumber`] if a value is NaN.
#[inline]
pub fn log_density<T: Variables + ?Sized>(target: &T, draw: &T::Draw, var: usize) -> Result<LogDensity, NotANumber> {
    let law = &target.vars().get(var).law;
    let Some(values) = target.get(draw, var) else { return Ok(LogDensity::ONE) };
    let shift = target.shift(draw, var);
    // The usual case: for scenes without a simulator, nothing in a draw costs more than the density.
    if let (Law::Gaussian(gaussian), [value]) = (law, values) {
        return gaussian.log_density(&(value + shift));
    }
    let other = other(target, draw, law);
    match values {
        [value] if shift != 0.0 => law.log_density(other, &[value + shift]),
        _ => law.log_density(other, values),
    }
}

/// Log density of some variables: the sum over each of them.
///
/// # Errors
/// [`NotANumber`] if a value is NaN.
pub fn log_density_of<T: Variables + ?Sized>(
    target: &T,
    draw: &T::Draw,
    vars: impl IntoIterator<Item = usize>,
) -> Result<LogDensity, NotANumber> {
    vars.into_iter().try_fold(LogDensity::ONE, |sum, var| Ok(sum + log_density(target, draw, var)?))
}

/// Log density of a whole draw: that of each variable, and ½ for the presence or absence of an optional one.
///
/// # Errors
/// [`NotANumber`] if a value is NaN.
#[inline]
pub fn log_prior<T: Variables + ?Sized>(target: &T, draw: &T::Draw) -> Result<LogDensity, NotANumber> {
    let mut sum = LogDensity::new(target.vars().presence)?;
    for var in 0..target.vars().len() {
        sum = sum + log_density(target, draw, var)?;
    }
    Ok(sum)
}

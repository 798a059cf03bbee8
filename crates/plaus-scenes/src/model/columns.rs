//! The columns of a state in tables: its random variables, as declared, and outcomes.

pub use plaus_mcmc::Member;
use plaus_mcmc::{Variables, Vars};
use serde::Serialize;
use std::borrow::Cow;

/// Where a scalar comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Role {
    /// A random variable of the draw: its mixing shows whether solutions really differ.
    Draw,
    /// A result of the simulation.
    Outcome,
    /// A result for tables and counts alone: no diagnosis, and no move, looks at it.
    Detail,
}

/// A number that every state of a scene has: a column of a table, a variable of the diagnostics.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Scalar {
    /// Column name, `snake_case`, with the member's number if it belongs to one. If a scenario names bodies, it follows
    /// the body's name and a dot.
    pub name: String,
    /// Unit, for readers; empty for pure numbers.
    pub unit: &'static str,
    /// Where it comes from.
    pub role: Role,
    /// Its name without a number.
    #[serde(skip)]
    pub base: Cow<'static, str>,
    /// The member it belongs to: the `die` 2 of `x_2`; `None` if there is only one.
    #[serde(skip)]
    pub member: Option<Member>,
    /// Whether its values are whole numbers.
    #[serde(skip)]
    pub whole: bool,
}

/// A column that is not a variable: its declaration, for all members of a kind.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Column {
    name: &'static str,
    unit: &'static str,
    role: Role,
    whole: bool,
}

impl Column {
    /// A result.
    #[must_use]
    pub const fn result(name: &'static str, unit: &'static str) -> Self {
        Self { name, unit, role: Role::Outcome, whole: false }
    }

    /// A result that is a whole number.
    #[must_use]
    pub const fn count(name: &'static str) -> Self {
        Self { name, unit: "", role: Role::Outcome, whole: true }
    }

    /// The same for the draw alone: a summary of variables that are not columns themselves.
    #[must_use]
    pub const fn of_the_draw(self) -> Self {
        Self { role: Role::Draw, ..self }
    }

    /// The scalar of a member, or of all.
    #[must_use]
    pub fn of(self, member: Option<Member>) -> Scalar {
        let Self { name, unit, role, whole } = self;
        Scalar { whole, ..Scalar::new(name, unit, role, member) }
    }
}

impl Scalar {
    /// A number, of a member or of all.
    #[must_use]
    pub fn new(base: impl Into<Cow<'static, str>>, unit: &'static str, role: Role, member: Option<Member>) -> Self {
        let base = base.into();
        let name = member.map_or_else(|| base.to_string(), |Member { number, .. }| format!("{base}_{number}"));
        Self { name, unit, role, base, member, whole: false }
    }
}

/// The scalars of a scene: outcomes, then variables; first those of no member, then those of each member together.
#[must_use]
pub fn scalars(results: Vec<Scalar>, vars: &Vars) -> Vec<Scalar> {
    let shown = vars.iter().filter(|var| var.column.is_some());
    let variable = shown.map(|var| Scalar::new(var.name.clone(), var.unit, Role::Draw, var.member));
    let mut all: Vec<Scalar> = results.into_iter().chain(variable).collect();
    all.sort_by_key(|scalar| scalar.member);
    all
}

/// The values of variables that are columns, in order.
pub fn values<'a, T: Variables>(target: &'a T, draw: &'a T::Draw) -> impl Iterator<Item = f64> + 'a {
    let shown = target.vars().iter().enumerate().filter_map(|(var, declared)| Some((var, declared.column?)));
    shown.map(move |(var, factor)| {
        let value = target.get(draw, var).and_then(|values| values.first().copied()).unwrap_or(f64::NAN);
        let shift = target.shift(draw, var);
        (if shift == 0.0 { value } else { value + shift }) * factor
    })
}

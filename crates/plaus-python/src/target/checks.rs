//! Are the moves right? The checks that the scenes' own moves pass.

use super::kernel::{Kernel, mixture, one};
use super::{ByFunctions, Functions, Point};
use crate::errors::{RunError, of_chain, of_model};
use plaus_dist::{LogPotential, Seed};
use plaus_mcmc::check::{CheckError, OneStep, PriorOnly, Ratios, Statistic, one_step, prior, ratios, rejection};
use plaus_mcmc::view::lend;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

/// The findings of checks of moves.
#[pyclass(frozen, get_all, module = "plaus")]
pub(crate) struct CheckReport {
    /// Whether nothing was found.
    passed: bool,
    /// What each check found, in words.
    text: String,
    /// Smallest p-value of the statistical checks.
    p: f64,
    /// Share of candidates accepted in them: a move that is never accepted has not been tested.
    accepted: f64,
}

#[pymethods]
impl CheckReport {
    fn __str__(&self) -> &str {
        &self.text
    }

    fn __repr__(&self) -> String {
        format!("<CheckReport passed={}, p={:.2e}, accepted={:.2}>", self.passed, self.p, self.accepted)
    }

    fn __bool__(&self) -> bool {
        self.passed
    }
}

fn refused(py: Python<'_>, error: &CheckError) -> PyErr {
    match error {
        CheckError::Model { index, source } => of_model(py, source, &format!("raised in sample {index} of a check")),
        CheckError::Chain { index, source } => of_chain(py, source, None, &format!("In sample {index} of a check")),
        CheckError::Setting { .. } => PyValueError::new_err(error.to_string()),
        other => RunError::new_err(other.to_string()),
    }
}

/// How to check.
struct Plan {
    seed: Seed,
    samples: u64,
    pairs: u64,
    false_alarm: f64,
    bound: Option<LogPotential>,
    dimensions: usize,
}

/// Words, whether it passed, p-value, accepted and made.
type Found = (String, bool, f64, u64, u64);

fn look(
    target: &ByFunctions,
    kernels: &[Box<dyn plaus_mcmc::Move<ByFunctions>>],
    moves: [plaus_mcmc::Mixture<ByFunctions>; 2],
    plan: &Plan,
) -> Result<Found, CheckError> {
    let (mut text, mut passed, mut p, mut accepted, mut made) = (String::new(), true, 1.0_f64, 0, 0);
    for kernel in kernels {
        let asked = Ratios { seed: plan.seed, pairs: plan.pairs, ..Ratios::default() };
        let report = ratios(target, kernel.as_ref(), prior(target), asked)?;
        text += &report.to_string();
        passed &= report.passed();
    }
    let statistic = |k: usize| Statistic::new(format!("x[{k}]"), move |state: &Point| state.draw[k]);
    let statistics: Vec<_> = (0..plan.dimensions).map(statistic).collect();
    // The probability of a false alarm is shared among the checks.
    let share = plan.false_alarm / if plan.bound.is_some() { 2.0 } else { 1.0 };
    let asked = OneStep { seed: plan.seed, samples: plan.samples, false_alarm: share, ..OneStep::default() };
    let [at_prior, at_target] = moves;
    let flat = PriorOnly::new(target);
    let mut note = |what: &str, report: plaus_mcmc::check::OneStepReport| {
        text += &format!("{what}: {report}");
        passed &= report.passed();
        p = p.min(report.p().value());
        accepted += report.accepted();
        made += report.moves.iter().map(|(_, counts)| counts.made()).sum::<u64>();
    };
    note(
        "prior alone",
        one_step(&flat, &lend::<PriorOnly<'_, ByFunctions>>(at_prior)?, prior(&flat), &statistics, asked)?,
    );
    if let Some(bound) = plan.bound {
        note("target", one_step(target, &at_target, rejection(target, bound), &statistics, asked)?);
    }
    Ok((text, passed, p, accepted, made))
}

/// Checks moves: that ratios match those of the reverse steps, and that a step preserves the law of exact draws.
#[pyfunction]
#[pyo3(signature = (functions, kernels, *, dimensions, samples, pairs, seed, false_alarm, bound))]
#[allow(clippy::too_many_arguments, reason = "named in Python, which is the only caller")]
pub(crate) fn check(
    py: Python<'_>,
    functions: Py<Functions>,
    kernels: Vec<Py<Kernel>>,
    dimensions: usize,
    samples: u64,
    pairs: u64,
    seed: u64,
    false_alarm: f64,
    bound: Option<f64>,
) -> PyResult<CheckReport> {
    let wrong = |_| PyValueError::new_err("bound: expected a number that log_density never exceeds, or None");
    let bound = bound.map(LogPotential::new).transpose().map_err(wrong)?;
    let moves = [mixture(py, &kernels)?, mixture(py, &kernels)?];
    let kernels: Vec<_> = kernels.iter().map(|kernel| one(py, kernel)).collect();
    let plan = Plan { seed: Seed(seed), samples, pairs, false_alarm, bound, dimensions };
    let target = ByFunctions(functions);
    let found = py.detach(move || look(&target, &kernels, moves, &plan));
    let (text, passed, p, accepted, made) = found.map_err(|error| refused(py, &error))?;
    Ok(CheckReport { passed, text, p, accepted: accepted as f64 / made.max(1) as f64 })
}

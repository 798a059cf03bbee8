//! Moves whose proposals are functions in Python.

use super::{ByFunctions, lend, number, read, shown};
use crate::errors::Raised;
use plaus_dist::{LogRatio, Stream};
use plaus_mcmc::{At, Mixture, ModelError, Move, Proposal, Redraw, Transition};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyTuple;

/// A move: what it proposes, and how much likelier the way back is.
#[pyclass(frozen, module = "plaus._plaus")]
pub(crate) struct Kernel {
    name: String,
    weight: f64,
    /// None: a whole new start.
    propose: Option<Py<PyAny>>,
    /// None: as likely as the way back.
    log_ratio: Option<Py<PyAny>>,
}

#[pymethods]
impl Kernel {
    #[new]
    fn new(name: String, weight: f64, propose: Option<Py<PyAny>>, log_ratio: Option<Py<PyAny>>) -> Self {
        Self { name, weight, propose, log_ratio }
    }
}

/// The mixture of these moves.
pub(super) fn mixture(py: Python<'_>, kernels: &[Py<Kernel>]) -> PyResult<Mixture<ByFunctions>> {
    let raise = |kernel: &Py<Kernel>| -> (f64, Box<dyn Move<ByFunctions>>) { (kernel.get().weight, one(py, kernel)) };
    Mixture::new(kernels.iter().map(raise).collect()).map_err(|error| PyValueError::new_err(error.to_string()))
}

/// One of them.
pub(super) fn one(py: Python<'_>, kernel: &Py<Kernel>) -> Box<dyn Move<ByFunctions>> {
    if kernel.get().propose.is_none() { Box::new(Redraw) } else { Box::new(Made(kernel.clone_ref(py))) }
}

struct Made(Py<Kernel>);

impl Made {
    fn ratio(&self, py: Python<'_>, from: &[f64], to: &[f64]) -> PyResult<f64> {
        match &self.0.get().log_ratio {
            Some(ratio) => number(&ratio.bind(py).call1((shown(py, from), shown(py, to)))?, "log_ratio"),
            None => Ok(0.0),
        }
    }
}

impl Move<ByFunctions> for Made {
    fn name(&self) -> &str {
        &self.0.get().name
    }

    fn propose(
        &self,
        at: At<'_, ByFunctions>,
        candidate: &mut Vec<f64>,
        stream: &mut Stream,
    ) -> Result<Proposal, ModelError> {
        let Some(propose) = &self.0.get().propose else { return Ok(Proposal::Stay) };
        let nats = Python::attach(|py| {
            let given = shown(py, at.state.draw);
            let made = lend(py, stream, |rng| {
                let made = propose.bind(py).call1((&given, rng))?;
                if made.is_none() {
                    return Ok(None);
                }
                // A pair whose first is no number: a point and its own log ratio.
                let pair = made.cast::<PyTuple>().ok().filter(|pair| pair.len() == 2);
                let pair = pair.and_then(|pair| Some((pair.get_item(0).ok()?, pair.get_item(1).ok()?)));
                let (point, ratio) = match pair.filter(|(first, _)| first.extract::<f64>().is_err()) {
                    Some((point, ratio)) => (read(&point, "propose")?, Some(number(&ratio, "propose's log ratio")?)),
                    None => (read(&made, "propose")?, None),
                };
                if point.len() != at.state.draw.len() {
                    let (now, then) = (at.state.draw.len(), point.len());
                    return Err(PyTypeError::new_err(format!("propose gave {then} numbers for a point of {now}")));
                }
                let ratio = ratio.map_or_else(|| self.ratio(py, at.state.draw, &point), Ok)?;
                candidate.clone_from(&point);
                Ok(Some(ratio))
            });
            made.map_err(|error| Raised::wrap(py, error, Some(given.unbind())))
        })?;
        Ok(match nats {
            Some(nats) => Proposal::with_ratio(LogRatio::new(nats)?),
            None => Proposal::Stay,
        })
    }

    fn log_ratio(&self, step: Transition<'_, ByFunctions>) -> Result<LogRatio, ModelError> {
        let nats = Python::attach(|py| {
            self.ratio(py, step.from.draw, step.to.draw)
                .map_err(|error| Raised::wrap(py, error, Some(shown(py, step.from.draw).unbind())))
        })?;
        Ok(LogRatio::new(nats)?)
    }
}

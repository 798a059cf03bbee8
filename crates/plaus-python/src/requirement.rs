//! A requirement in Python: a function of the outcome that the chain calls, last of all, for every candidate that it
//! may still accept.

use crate::clock::now;
use crate::errors::Raised;
use crate::outcome::Outcome;
use plaus_dist::LogPotential;
use plaus_mcmc::{ModelError, StateRefOf};
use plaus_run::Further;
use plaus_scenes::animation::Motion;
use plaus_scenes::require::{FAR, Judge, Mark};
use plaus_scenes::{AnyScene, Scene, Stage};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyBytes, PyTuple};
use std::fmt;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering::Relaxed};

/// The mark of an answer: a log potential, and whether the requirement is met.
fn mark_of(log: f64, met: bool) -> Mark {
    Mark { margin: if met { 0.0 } else { log.clamp(-FAR, -f64::MIN_POSITIVE) }, log }
}

/// A requirement, with what it has cost.
#[pyclass(frozen, module = "plaus._plaus")]
pub(crate) struct Asked {
    function: Py<PyAny>,
    name: String,
    most: Option<LogPotential>,
    calls: AtomicU64,
    nanoseconds: AtomicU64,
    waited: AtomicU64,
    /// Whether the function has ever used a motion: if so, motions are kept for it.
    looks: Arc<AtomicBool>,
}

#[pymethods]
impl Asked {
    #[new]
    fn new(function: Py<PyAny>, name: String, most: Option<f64>) -> PyResult<Self> {
        let wrong = |_| PyValueError::new_err("most: expected a number that the log potential never exceeds, or None");
        let most = most.map(LogPotential::new).transpose().map_err(wrong)?;
        let zero = || AtomicU64::new(0);
        Ok(Self { function, name, most, calls: zero(), nanoseconds: zero(), waited: zero(), looks: Arc::default() })
    }

    /// Calls, seconds spent in them, and seconds that chains waited for their turn.
    #[getter]
    fn cost(&self) -> (u64, f64, f64) {
        let seconds = |nanoseconds: &AtomicU64| nanoseconds.load(Relaxed) as f64 * 1e-9;
        (self.calls.load(Relaxed), seconds(&self.nanoseconds), seconds(&self.waited))
    }
}

impl Asked {
    /// The mark in the function's answer: `(log potential, met)`, or a truth value that stands for (0, true) and
    /// (−∞, false).
    fn mark(&self, answer: &Bound<'_, PyAny>) -> PyResult<Mark> {
        let name = &self.name;
        if answer.is_instance_of::<PyBool>() || answer.get_type().name()?.to_string_lossy() == "bool" {
            let met = answer.is_truthy()?;
            return Ok(mark_of(if met { 0.0 } else { f64::NEG_INFINITY }, met));
        }
        let wrong = || {
            let message =
                format!("{name} answered {answer}: a pair (log potential, met) is expected, or True or False");
            PyTypeError::new_err(message)
        };
        let pair = answer.cast::<PyTuple>().map_err(|_| wrong())?;
        if pair.len() != 2 {
            return Err(wrong());
        }
        let log: f64 = pair.get_item(0)?.extract().map_err(|_| wrong())?;
        let met = pair.get_item(1)?.is_truthy()?;
        LogPotential::new(log).map_err(|_| {
            PyValueError::new_err(format!(
                "{name} answered a log potential of {log}: a finite number is expected, or -inf"
            ))
        })?;
        Ok(mark_of(log, met))
    }

    /// Calls the function, here or in another process.
    fn ask(&self, outcome: Outcome, others: Option<&Py<PyAny>>) -> Result<Mark, ModelError> {
        let asked = now();
        let spent = |seconds: f64| (seconds * 1e9) as u64;
        let pack = |others| outcome.pack().map(|parcel| (others, parcel));
        let parcel: Option<(&Py<PyAny>, Vec<u8>)> = others.map(pack).transpose()?;
        Python::attach(|py| {
            let begun = now();
            let outcome = Py::new(py, outcome).map_err(|error| Raised::wrap(py, error, None))?;
            let answered = match &parcel {
                Some((others, parcel)) => {
                    others.bind(py).call1((PyBytes::new(py, parcel),)).and_then(|it| it.extract())
                }
                None => self.function.bind(py).call1((&outcome,)).map(|answer| (now() - begun, answer)),
            };
            let took = answered.as_ref().map_or_else(|_| now() - begun, |(seconds, _)| *seconds);
            self.calls.fetch_add(1, Relaxed);
            self.nanoseconds.fetch_add(spent(took), Relaxed);
            self.waited.fetch_add(spent((now() - asked - took).max(0.0)), Relaxed);
            let mark = answered.and_then(|(_, answer): (f64, Bound<'_, PyAny>)| self.mark(&answer));
            mark.map_err(|error| Raised::wrap(py, error, Some(outcome.into_any())))
        })
    }
}

/// What asks the function, here or in other processes.
#[derive(Clone)]
pub(crate) struct ByPython {
    pub(crate) asked: Arc<Py<Asked>>,
    /// What asks the function in other processes: takes a parcel, and gives the seconds that the function took with
    /// what it answered, or raises what it raised. None: it is called here.
    pub(crate) others: Option<Arc<Py<PyAny>>>,
}

impl ByPython {
    /// As a further requirement on the draws of a scenario, whose scene is `scene`.
    pub(crate) fn further(self, scene: Stage) -> Further {
        let names = scene.scalars().into_iter().map(|scalar| scalar.name).collect();
        let name = self.asked.get().name.clone();
        Further { name, judge: Arc::new(OfScene { by: self, scene: Arc::new(scene), names }) }
    }
}

/// A requirement of a scene.
struct OfScene {
    by: ByPython,
    scene: Arc<Stage>,
    names: Arc<[String]>,
}

impl fmt::Debug for OfScene {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(out, "OfScene({})", self.by.asked.get().name)
    }
}

impl Judge<AnyScene> for OfScene {
    fn most(&self) -> Option<LogPotential> {
        self.by.asked.get().most
    }

    /// Not if it runs in another process, which simulates for itself.
    fn wants_motion(&self) -> bool {
        self.by.others.is_none() && self.by.asked.get().looks.load(Relaxed)
    }

    fn judge(&self, state: StateRefOf<'_, Stage>, motion: Option<Motion>) -> Result<Mark, ModelError> {
        let outcome = Outcome::of(&self.scene, &self.names, state, (&self.by.asked.get().looks, motion));
        self.by.asked.get().ask(outcome, self.by.others.as_deref())
    }
}

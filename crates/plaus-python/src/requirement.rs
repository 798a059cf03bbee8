//! A requirement in Python: a function of the outcome that the chain calls, last of all, for every candidate that it
//! may still accept.

use crate::clock::now;
use crate::errors::{Raised, RunError};
use crate::motion::Motion;
use crate::parcel;
use plaus_dist::LogPotential;
use plaus_mcmc::{Mark, Mixture, ModelError, Required, Requirement, Sink, State, StateOf};
use plaus_run::{Drive, Driven, Journey, RunFileError};
use plaus_scenes::{Animation, Scene};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyBytes, PyDict, PyTuple};
use serde::{Deserialize, Serialize};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering::Relaxed};
use std::sync::{Arc, OnceLock};

/// What a state can show of itself, whatever its scene.
trait Shown: Send + Sync {
    fn motion(&self) -> Result<Animation, ModelError>;

    /// All that another process needs to make it again.
    fn pack(&self, numbers: &Numbers) -> Result<Vec<u8>, ModelError>;
}

/// A draw and the scene that simulates it.
struct Drawn<S: Scene> {
    scene: Arc<S>,
    draw: S::Draw,
}

impl<S: Scene> Shown for Drawn<S> {
    fn motion(&self) -> Result<Animation, ModelError> {
        self.scene.motion(&self.draw)
    }

    fn pack(&self, numbers: &Numbers) -> Result<Vec<u8>, ModelError> {
        parcel::pack(numbers, &self.draw)
    }
}

/// What is known of a state without simulating it again.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct Numbers {
    pub(crate) values: Vec<f64>,
    pub(crate) log_prior: f64,
    pub(crate) log_constraint: f64,
    pub(crate) satisfied: bool,
}

/// What came of a candidate: what a requirement judges.
///
/// Numbers are at hand; motion and impacts are made when they are first asked for. A function that asked for them once
/// gets them from the simulation that was run anyway, where the scene keeps it; else by simulating once more.
#[pyclass(frozen, module = "plaus")]
pub(crate) struct Outcome {
    shown: Box<dyn Shown>,
    names: Arc<[String]>,
    numbers: Numbers,
    motion: OnceLock<Motion>,
    /// Told when the motion is asked for.
    asked: Option<Arc<Py<Asked>>>,
}

impl Outcome {
    fn of<S: Scene>(scene: &Arc<S>, names: &Arc<[String]>, state: &StateOf<S>) -> Self {
        let mut values = vec![0.0; names.len()];
        scene.write_scalars(state, &mut values);
        let State { draw, log_prior, log_constraint, .. } = state;
        let (log_prior, log_constraint) = (log_prior.value(), log_constraint.value());
        let numbers = Numbers { values, log_prior, log_constraint, satisfied: scene.class(state).is_some() };
        Self::new(scene, names, numbers, draw.clone())
    }

    /// What came of `draw`.
    pub(crate) fn new<S: Scene>(scene: &Arc<S>, names: &Arc<[String]>, numbers: Numbers, draw: S::Draw) -> Self {
        let shown = Box::new(Drawn { scene: Arc::clone(scene), draw });
        Self { shown, names: Arc::clone(names), numbers, motion: OnceLock::new(), asked: None }
    }
}

#[pymethods]
impl Outcome {
    /// The scene's numbers by name, as in the table of draws.
    #[getter]
    fn scalars<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let scalars = PyDict::new(py);
        self.names.iter().zip(&self.numbers.values).try_for_each(|(name, value)| scalars.set_item(name, value))?;
        Ok(scalars)
    }

    /// One of the scene's numbers: `outcome["rest_x"]`.
    fn __getitem__(&self, name: &str) -> PyResult<f64> {
        let found = self.names.iter().position(|known| known == name);
        found.map(|index| self.numbers.values[index]).ok_or_else(|| {
            let known = self.names.join(", ");
            pyo3::exceptions::PyKeyError::new_err(format!("there is no number `{name}`: there are {known}"))
        })
    }

    /// Log prior density of the draw, up to a constant.
    #[getter]
    fn log_prior(&self) -> f64 {
        self.numbers.log_prior
    }

    /// Log constraint of the scenario alone, up to a constant.
    #[getter]
    fn log_constraint(&self) -> f64 {
        self.numbers.log_constraint
    }

    /// Whether the scenario's own constraint is satisfied.
    #[getter]
    fn satisfied(&self) -> bool {
        self.numbers.satisfied
    }

    /// The motion of all bodies, without what stands still around them.
    #[getter]
    fn motion(&self, py: Python<'_>) -> PyResult<Motion> {
        if let Some(asked) = &self.asked {
            asked.get().looks.store(true, Relaxed);
        }
        if let Some(motion) = self.motion.get() {
            return Ok(motion.clone());
        }
        // Other chains go on meanwhile.
        let made = py.detach(|| self.shown.motion()).map_err(|error| RunError::new_err(error.to_string()))?;
        Ok(self.motion.get_or_init(|| Motion(Arc::new(made))).clone())
    }

    /// Names of the bodies.
    #[getter]
    fn bodies(&self, py: Python<'_>) -> PyResult<Vec<String>> {
        Ok(self.motion(py)?.0.tracks.iter().map(|track| track.name.clone()).collect())
    }

    /// Where each body is at the end, by name: (x, y, z) in m, y up.
    #[getter]
    fn rest<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let motion = self.motion(py)?;
        let rest = PyDict::new(py);
        for track in &motion.0.tracks {
            rest.set_item(&track.name, track.position(motion.0.duration).to_array())?;
        }
        Ok(rest)
    }

    /// How each body is turned at the end, by name: a unit quaternion (x, y, z, w) from its axes to the world's.
    #[getter]
    fn rest_orientation<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let motion = self.motion(py)?;
        let rest = PyDict::new(py);
        for track in &motion.0.tracks {
            rest.set_item(&track.name, track.orientation(motion.0.duration).to_array())?;
        }
        Ok(rest)
    }

    fn __repr__(&self) -> String {
        let numbers = self.names.iter().zip(&self.numbers.values).take(6);
        let numbers: Vec<String> = numbers.map(|(name, value)| format!("{name}={value:.4}")).collect();
        let more = if self.names.len() > 6 { ", ..." } else { "" };
        format!("<Outcome {}{more}, satisfied={}>", numbers.join(", "), self.numbers.satisfied)
    }
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
    /// Whether the function has ever asked for a motion: then motions are kept for it.
    looks: AtomicBool,
}

#[pymethods]
impl Asked {
    #[new]
    fn new(function: Py<PyAny>, name: String, most: Option<f64>) -> PyResult<Self> {
        let wrong = |_| PyValueError::new_err("most: a number that no log potential exceeds, or None");
        let most = most.map(LogPotential::new).transpose().map_err(wrong)?;
        let zero = || AtomicU64::new(0);
        Ok(Self {
            function,
            name,
            most,
            calls: zero(),
            nanoseconds: zero(),
            waited: zero(),
            looks: AtomicBool::new(false),
        })
    }

    /// Calls, seconds spent in them, and seconds that chains waited for their turn.
    #[getter]
    fn cost(&self) -> (u64, f64, f64) {
        let seconds = |nanoseconds: &AtomicU64| nanoseconds.load(Relaxed) as f64 * 1e-9;
        (self.calls.load(Relaxed), seconds(&self.nanoseconds), seconds(&self.waited))
    }
}

impl Asked {
    /// The mark in what the function answered: `(log potential, met)`, or a truth value that stands for (0, true) and
    /// (−∞, false).
    fn mark(&self, answer: &Bound<'_, PyAny>) -> PyResult<Mark> {
        let name = &self.name;
        if answer.is_instance_of::<PyBool>() || answer.get_type().name()?.to_string_lossy() == "bool" {
            let met = answer.is_truthy()?;
            return Ok(Mark { log: if met { LogPotential::ONE } else { LogPotential::ZERO }, met });
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
        let log = LogPotential::new(log).map_err(|_| {
            PyValueError::new_err(format!(
                "{name} answered a log potential of {log}: a number below ∞ is expected, or -inf"
            ))
        })?;
        Ok(Mark { log, met })
    }

    /// Asks the function, here or in another process.
    fn ask(&self, outcome: Outcome, others: Option<&Py<PyAny>>) -> Result<Mark, ModelError> {
        let asked = now();
        let spent = |seconds: f64| (seconds * 1e9) as u64;
        let pack = |others| outcome.shown.pack(&outcome.numbers).map(|parcel| (others, parcel));
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

/// A requirement of a known scene.
struct OfScene<S: Scene> {
    by: ByPython,
    scene: Arc<S>,
    names: Arc<[String]>,
    most: Option<LogPotential>,
}

impl<S: Scene> OfScene<S> {
    /// Whether the function looks at motions, here: another process simulates for itself.
    fn keeps(&self) -> bool {
        self.by.others.is_none() && self.by.asked.get().looks.load(Relaxed)
    }
}

impl<S: Scene> Requirement<S> for OfScene<S> {
    fn most(&self) -> Option<LogPotential> {
        self.most
    }

    fn prepare(&self, scene: &S, scratch: &mut S::Scratch) {
        if self.keeps() {
            scene.record_motions(scratch);
        }
    }

    fn judge(&self, scene: &S, state: &StateOf<S>, scratch: &S::Scratch) -> Result<Mark, ModelError> {
        let mut outcome = Outcome::of(&self.scene, &self.names, state);
        if self.keeps() {
            outcome.motion = Motion(Arc::new(scene.motion_simulated(&state.draw, scratch)?)).into();
        }
        outcome.asked = Some(Arc::clone(&self.by.asked));
        self.by.asked.get().ask(outcome, self.by.others.as_deref())
    }
}

/// Drives chains under a requirement.
#[derive(Clone)]
pub(crate) struct ByPython {
    pub(crate) asked: Arc<Py<Asked>>,
    /// What asks the function in other processes: takes a parcel, and gives the seconds that the function took with
    /// what it answered, or raises what it raised. None: it is called here.
    pub(crate) others: Option<Arc<Py<PyAny>>>,
}

impl Drive for ByPython {
    fn requirement(&self) -> Option<String> {
        Some(self.asked.get().name.clone())
    }

    fn drive<S: Scene, K: Sink<S::Draw, S::Outcome, Error = RunFileError>>(
        &self,
        scene: &Arc<S>,
        moves: &Mixture<S>,
        journey: Journey<'_, S>,
        sink: &mut K,
    ) -> Driven {
        let names = scene.scalars().into_iter().map(|scalar| scalar.name).collect();
        let (by, most) = (self.clone(), self.asked.get().most);
        let required = Required::new(&**scene, OfScene { by, scene: Arc::clone(scene), names, most });
        plaus_mcmc::required::run(
            &required,
            moves,
            (journey.plan, journey.chains, journey.starts),
            journey.threads,
            sink,
            journey.pulse,
        )
    }
}

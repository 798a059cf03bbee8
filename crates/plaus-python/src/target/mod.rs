//! A target whose prior and density are functions in Python, for toy problems: sampled by the same chains, checked by
//! the same checks.

mod checks;
mod kernel;
mod sample;

pub(crate) use checks::{CheckReport, check};
pub(crate) use kernel::Kernel;
pub(crate) use sample::sample_target;

use crate::errors::Raised;
use numpy::{PyArray1, PyArrayMethods};
use plaus_dist::{LogDensity, LogPotential, Stream, open_unit};
use plaus_mcmc::{Goal, ModelError, Simulated, SolutionClass, State, StateRef, StateRefOf, Target};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyBool;
use std::sync::{Mutex, PoisonError};

/// Random numbers of one iteration: the same for the same seed, chain and iteration, whatever else is drawn.
#[pyclass(frozen, module = "plaus")]
pub(crate) struct Rng(Mutex<Stream>);

impl Rng {
    fn with<T>(&self, use_it: impl FnOnce(&mut Stream) -> T) -> T {
        use_it(&mut self.0.lock().unwrap_or_else(PoisonError::into_inner))
    }
}

#[pymethods]
impl Rng {
    /// Numbers of a seed, outside of any chain.
    #[new]
    fn new(seed: u64) -> Self {
        Self(Mutex::new(plaus_dist::Seed(seed).chain(0).at(0, plaus_dist::Purpose::START)))
    }

    /// Uniform between `low` and `high`, without the ends.
    #[pyo3(signature = (low = 0.0, high = 1.0))]
    fn uniform(&self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.with(open_unit)
    }

    /// Normal with this mean and standard deviation.
    #[pyo3(signature = (mean = 0.0, sd = 1.0))]
    fn normal(&self, mean: f64, sd: f64) -> f64 {
        mean + sd * self.with(plaus_dist::standard_normal)
    }

    /// A whole number from 0 to `count` − 1, each equally likely.
    fn below(&self, count: usize) -> PyResult<usize> {
        if count == 0 {
            return Err(PyValueError::new_err("below(0): there is no number below 0"));
        }
        Ok(self.with(|stream| plaus_dist::stream::below(stream, count)))
    }
}

/// Lends a stream to a function: it goes on where the function leaves it.
fn lend<T>(py: Python<'_>, stream: &mut Stream, call: impl FnOnce(&Bound<'_, Rng>) -> PyResult<T>) -> PyResult<T> {
    let rng = Bound::new(py, Rng(Mutex::new(stream.clone())))?;
    let made = call(&rng);
    *stream = rng.get().with(|stream| stream.clone());
    made
}

/// A point as Python sees it: a read-only array.
fn shown<'py>(py: Python<'py>, point: &[f64]) -> Bound<'py, PyAny> {
    let array = PyArray1::from_slice(py, point);
    array.readwrite().make_nonwriteable();
    array.into_any()
}

/// A point as Python made it: a number, or a sequence of them.
fn read(made: &Bound<'_, PyAny>, what: &str) -> PyResult<Vec<f64>> {
    let wrong = || PyTypeError::new_err(format!("{what} gave {made}: a number is expected, or a sequence of them"));
    let point = match made.extract::<f64>() {
        Ok(number) => vec![number],
        Err(_) => made.extract::<Vec<f64>>().map_err(|_| wrong())?,
    };
    match point.iter().find(|number| number.is_nan()) {
        Some(_) => Err(PyValueError::new_err(format!("{what} gave a NaN: {point:?}"))),
        None => Ok(point),
    }
}

/// The functions of a target.
#[pyclass(frozen, module = "plaus._plaus")]
pub(crate) struct Functions {
    start: Py<PyAny>,
    log_prior: Py<PyAny>,
    log_density: Py<PyAny>,
    /// Whether a point is a solution, and of which class.
    met: Option<Py<PyAny>>,
}

#[pymethods]
impl Functions {
    #[new]
    fn new(start: Py<PyAny>, log_prior: Py<PyAny>, log_density: Py<PyAny>, met: Option<Py<PyAny>>) -> Self {
        Self { start, log_prior, log_density, met }
    }
}

/// A target of these functions.
pub(crate) struct ByFunctions(pub(crate) Py<Functions>);

/// What the functions say of a point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Said {
    log: LogPotential,
    class: Option<SolutionClass>,
}

/// A state of such a target.
pub(crate) type Point = State<Vec<f64>, Said>;

/// The same, lent.
pub(crate) type PointRef<'a> = StateRef<'a, Vec<f64>, Said>;

impl ByFunctions {
    /// Calls a function with a point; what it raises comes with the point.
    fn call<T>(
        &self,
        function: &Py<PyAny>,
        point: &[f64],
        read: impl FnOnce(&Bound<'_, PyAny>) -> PyResult<T>,
    ) -> Result<T, ModelError> {
        Python::attach(|py| {
            let given = shown(py, point);
            let made = function.bind(py).call1((&given,)).and_then(|made| read(&made));
            made.map_err(|error| Raised::wrap(py, error, Some(given.unbind())))
        })
    }
}

fn number(made: &Bound<'_, PyAny>, what: &str) -> PyResult<f64> {
    made.extract().map_err(|_| PyTypeError::new_err(format!("{what} gave {made}: a number is expected")))
}

/// The class of solutions that an answer stands for: False or None for no solution, True for one class, whole numbers
/// for classes of their own.
fn class(made: &Bound<'_, PyAny>) -> PyResult<Option<SolutionClass>> {
    if made.is_none() {
        return Ok(None);
    }
    if made.is_instance_of::<PyBool>() || made.get_type().name()?.to_string_lossy() == "bool" {
        return Ok(made.is_truthy()?.then_some(SolutionClass::EMPTY));
    }
    let features = made.extract::<i64>().map(|one| vec![one]).or_else(|_| made.extract::<Vec<i64>>());
    let wrong = |_| PyTypeError::new_err(format!("met gave {made}: True, False, or whole numbers are expected"));
    features.map(|features| Some(SolutionClass::of(features))).map_err(wrong)
}

impl Target for ByFunctions {
    type Draw = Vec<f64>;
    type Outcome = Said;
    type Scratch = ();

    /// A start that raises is a point that nothing can be said about; the prior is asked next, and says so.
    fn start(&self, stream: &mut Stream) -> Vec<f64> {
        Python::attach(|py| {
            let made = lend(py, stream, |rng| read(&self.0.get().start.bind(py).call1((rng,))?, "start"));
            made.unwrap_or_else(|error| {
                failed_start(py, error);
                Vec::new()
            })
        })
    }

    fn log_prior(&self, draw: &Vec<f64>) -> Result<LogDensity, ModelError> {
        if let Some(error) = take_failed_start() {
            return Err(Python::attach(|py| Raised::wrap(py, error, None)));
        }
        let nats = self.call(&self.0.get().log_prior, draw, |made| number(made, "log_prior"))?;
        Ok(LogDensity::new(nats)?)
    }

    fn simulate(
        &self,
        draw: &Vec<f64>,
        _: Option<StateRefOf<'_, Self>>,
        _: LogPotential,
        (): &mut (),
    ) -> Result<Simulated<Said>, ModelError> {
        let nats = self.call(&self.0.get().log_density, draw, |made| number(made, "log_density"))?;
        let class = match &self.0.get().met {
            Some(met) => self.call(met, draw, class)?,
            None => None,
        };
        Ok(Simulated::Complete(Said { log: LogPotential::new(nats)?, class }))
    }

    fn log_constraint(&self, outcome: &Said) -> Result<LogPotential, ModelError> {
        Ok(outcome.log)
    }
}

impl Goal for ByFunctions {
    fn class(&self, state: PointRef<'_>) -> Option<SolutionClass> {
        state.outcome.class
    }
}

thread_local! {
    /// What `start` raised: a start cannot fail by itself, so the density that is asked next on this thread does.
    static FAILED_START: std::cell::RefCell<Option<PyErr>> = const { std::cell::RefCell::new(None) };
}

fn failed_start(_: Python<'_>, error: PyErr) {
    FAILED_START.with(|place| *place.borrow_mut() = Some(error));
}

fn take_failed_start() -> Option<PyErr> {
    FAILED_START.with(|place| place.borrow_mut().take())
}

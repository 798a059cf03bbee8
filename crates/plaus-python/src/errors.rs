//! Exceptions: what went wrong, with the place it went wrong at.

use plaus_mcmc::{ChainError, ModelError};
use plaus_scenes::scenario;
use pyo3::create_exception;
use pyo3::exceptions::{PyMemoryError, PyRuntimeError, PyValueError};
use pyo3::prelude::*;
use std::fmt;

create_exception!(
    plaus,
    ScenarioError,
    PyValueError,
    "A scenario that cannot be sampled.\n\n`problems` lists everything that is wrong; `message`, `key`, `line`, `column` and `hint` are those of the first."
);
create_exception!(
    plaus,
    RunError,
    PyRuntimeError,
    "A run that cannot be made, read or continued: what is wrong, and what can be done."
);
create_exception!(
    plaus,
    WorldError,
    PyValueError,
    "A world, or a start in it, that cannot be simulated: which body, surface or number is at fault."
);

/// One thing that is wrong with a scenario.
#[pyclass(frozen, get_all, module = "plaus")]
#[derive(Debug, Clone)]
pub(crate) struct Problem {
    /// The key at fault, dotted from the root; empty if the text is not TOML.
    key: String,
    /// What is wrong, with the allowed range if there is one.
    message: String,
    /// How to mend it, if that is known.
    hint: Option<String>,
    /// Line in the text, from 1; None for overrides and for tables that the text lacks.
    line: Option<usize>,
    /// Column in characters, from 1.
    column: Option<usize>,
    /// The override at fault, as `key=value`; None for the text itself.
    said: Option<String>,
}

#[pymethods]
impl Problem {
    fn __repr__(&self) -> String {
        let place = match (self.line, self.column) {
            (Some(line), Some(column)) => format!("line {line}, column {column}: "),
            _ => String::new(),
        };
        let hint = self.hint.as_ref().map(|hint| format!("; {hint}")).unwrap_or_default();
        format!("<Problem {place}{}: {}{hint}>", self.key, self.message)
    }
}

impl From<&scenario::Problem> for Problem {
    fn from(problem: &scenario::Problem) -> Self {
        let said = match &problem.source {
            scenario::Source::File => None,
            scenario::Source::Override(said) => Some(said.clone()),
        };
        let (key, message, hint) = (problem.key.clone(), problem.message.clone(), problem.help.clone());
        Self { key, message, hint, line: problem.line, column: problem.column, said }
    }
}

/// The exception for a wrong scenario.
pub(crate) fn of_scenario(py: Python<'_>, error: &scenario::ScenarioError) -> PyErr {
    let raised = ScenarioError::new_err(error.to_string());
    let problems: Vec<Problem> = error.problems.iter().map(Problem::from).collect();
    let fill = || -> PyResult<()> {
        let value = raised.value(py);
        if let Some(first) = problems.first() {
            value.setattr("message", &first.message)?;
            value.setattr("key", &first.key)?;
            value.setattr("line", first.line)?;
            value.setattr("column", first.column)?;
            value.setattr("hint", &first.hint)?;
        }
        value.setattr("problems", problems)
    };
    match fill() {
        Ok(()) => raised,
        Err(error) => error,
    }
}

/// The exception for an error of a run. An exception of a callback is raised again, with a note that says where the
/// chain was.
pub(crate) fn of_run(py: Python<'_>, error: &plaus_run::Error) -> PyErr {
    match error {
        plaus_run::Error::Config(config) => {
            let located = scenario::ScenarioError::locate("scenario", "", config);
            of_scenario(py, &located)
        }
        plaus_run::Error::Chain { chain, source, safe } => {
            let kept = format!("The run keeps the first {safe} iterations of each chain");
            of_chain(py, source, Some(*chain), &kept)
        }
        plaus_run::Error::Model(model) => of_model(py, model, "while it was evaluated"),
        other => RunError::new_err(other.to_string()),
    }
}

/// The exception for a chain that failed.
pub(crate) fn of_chain(py: Python<'_>, error: &ChainError, chain: Option<u32>, kept: &str) -> PyErr {
    let of = chain.map(|chain| format!("chain {chain}, ")).unwrap_or_default();
    if let ChainError::Model { iteration, step, source } = error {
        let step = step.as_ref().map(|name| format!(", move `{name}`")).unwrap_or_default();
        if let Some(raised) = source.downcast_ref::<Raised>() {
            let error = raised.error(py, &format!("raised in {of}iteration {iteration}{step}. {kept}"));
            let value = error.value(py);
            // An exception that accepts no attributes is raised without them.
            let _ = value.setattr("plaus_chain", chain);
            let _ = value.setattr("plaus_iteration", *iteration);
            return error;
        }
    }
    RunError::new_err(format!("{of}{error}. {kept}"))
}

/// The exception for a model that failed outside a chain.
pub(crate) fn of_model(py: Python<'_>, error: &ModelError, place: &str) -> PyErr {
    match error.downcast_ref::<Raised>() {
        Some(raised) => raised.error(py, place),
        None => RunError::new_err(error.to_string()),
    }
}

/// An exception of a callback, on its way through the chain.
#[derive(Debug)]
pub(crate) struct Raised {
    error: PyErr,
    text: String,
    /// What the callback was called with.
    given: Option<Py<PyAny>>,
}

impl Raised {
    /// Wraps the exception that a callback raised when called with `given`.
    pub(crate) fn wrap(py: Python<'_>, error: PyErr, given: Option<Py<PyAny>>) -> ModelError {
        let text = error.value(py).to_string();
        ModelError::new(Self { error, text, given })
    }

    fn error(&self, py: Python<'_>, place: &str) -> PyErr {
        let error = self.error.clone_ref(py);
        let value = error.value(py);
        let mut note = format!("plaus: {place}");
        if let Some(given) = &self.given
            && value.setattr("plaus_given", given).is_ok()
        {
            note += "; the exception's `plaus_given` is what the function was called with: call it again to see";
        }
        // An exception that accepts no notes is raised without one.
        let _ = value.call_method1("add_note", (note,));
        error
    }
}

impl fmt::Display for Raised {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "a callback raised: {}", self.text)
    }
}

impl std::error::Error for Raised {}

/// Room for `count` values, or MemoryError if there is none.
pub(crate) fn room<T: Clone>(value: T, count: usize) -> PyResult<Vec<T>> {
    let mut room = Vec::new();
    match room.try_reserve_exact(count) {
        Ok(()) => {
            room.resize(count, value);
            Ok(room)
        }
        Err(error) => Err(PyMemoryError::new_err(format!("no memory for {count} numbers: {error}"))),
    }
}

/// The product of the sides of an array; MemoryError if no memory could hold it.
pub(crate) fn volume(sides: &[usize]) -> PyResult<usize> {
    let product = sides.iter().try_fold(1_usize, |product, &side| product.checked_mul(side));
    product.ok_or_else(|| PyMemoryError::new_err(format!("an array of {sides:?} numbers is larger than any memory")))
}

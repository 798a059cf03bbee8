//! Scenarios: from a file, a text or a dictionary.

use crate::errors::{ScenarioError, of_scenario};
use crate::wait::{Wait, Watched};
use plaus_run::{Recipe, ScenarioFolder};
use plaus_scenes::Stage;
use plaus_scenes::files::{Assets, Files, NoFiles};
use plaus_scenes::require::Tally;
use plaus_scenes::scenario::ScenarioError as Wrong;
use pyo3::exceptions::{PyKeyboardInterrupt, PyOSError, PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyDict, PyFloat, PyInt, PyList, PyString, PyTuple};
use std::cell::RefCell;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use toml::{Table, Value};

/// Longest scenario that is read, in bytes.
const LONGEST: usize = 16 << 20;

/// A scenario: a world, what must happen in it, and how it is sampled.
///
/// `from_file`, `from_text`, `from_dict` and `default` read and check it. They raise one `ScenarioError` with
/// everything that is wrong. A scenario never changes; `set` returns another one.
#[pyclass(frozen, module = "plaus")]
#[derive(Debug, Clone)]
pub(crate) struct Scenario {
    pub(crate) recipe: Recipe,
    /// Its name in messages.
    shown: String,
    /// All files that were read with it. Changed keys are checked with them again.
    files: Assets,
}

impl Scenario {
    fn read(
        py: Python<'_>,
        (shown, file): (String, String),
        text: String,
        overrides: Vec<String>,
        files: &(impl Files + Sync),
    ) -> PyResult<Self> {
        let read = py.detach(|| {
            let seen = RefCell::new(Assets::default());
            let noted = |path: &str, anywhere: bool| {
                let bytes = files.bytes(path, anywhere)?;
                seen.borrow_mut().insert(path, bytes.clone());
                Ok(bytes)
            };
            let scenario = plaus_scenes::Scenario::read_with(&shown, &text, &overrides, &noted);
            scenario.map(|scenario| (scenario, seen.into_inner()))
        });
        let (scenario, files) = read.map_err(|error| of_scenario(py, &error))?;
        let recipe = Recipe { scenario, file, text, overrides, solutions: None };
        Ok(Self { recipe, shown, files })
    }

    /// The same scenario with more overrides, in order.
    pub(crate) fn with(&self, py: Python<'_>, more: Vec<String>) -> PyResult<Self> {
        if more.is_empty() {
            return Ok(self.clone());
        }
        let Recipe { file, text, overrides, .. } = &self.recipe;
        let all = overrides.iter().cloned().chain(more).collect();
        Self::read(py, (self.shown.clone(), file.clone()), text.clone(), all, &self.files)
    }
}

impl Scenario {
    /// Tallies what this many draws from the prior meet; Ctrl-C ends it.
    fn drawn(&self, py: Python<'_>, draws: u64) -> PyResult<(Stage, Tally)> {
        let stopped = Arc::new(AtomicBool::new(false));
        let (seed, scenario) = (self.recipe.scenario.sampler.seed, self.recipe.scenario.clone());
        let told = Arc::clone(&stopped);
        let job = move || {
            let stage = scenario.stage()?;
            let tally = Tally::of_prior(&stage, seed, draws, |_| !told.load(Relaxed))?;
            Ok((stage, tally))
        };
        let over = Wait { py, max_time: None, poll: None, interval: f64::INFINITY }.over(&Stopped(stopped), job)?;
        match over.why {
            Some(_) => Err(PyKeyboardInterrupt::new_err(())),
            None => Ok(over.made),
        }
    }
}

/// Work that looks at a flag.
struct Stopped(Arc<AtomicBool>);

impl Watched for Stopped {
    fn stop(&self) {
        self.0.store(true, Relaxed);
    }

    fn tell(&self, _: &Bound<'_, PyDict>) -> PyResult<bool> {
        Ok(false)
    }
}

/// The pickled form of a scenario: its text, its name, the keys set since, and its files.
type Parts = (String, String, Vec<String>, Vec<(String, Vec<u8>)>);

#[pymethods]
impl Scenario {
    /// Says how to make one.
    #[new]
    #[pyo3(signature = (*_given, **_named))]
    fn new(_given: &Bound<'_, PyTuple>, _named: Option<&Bound<'_, PyDict>>) -> PyResult<Self> {
        let message = "use Scenario.from_file(path), from_text(text), from_dict(tables) or default(scene)";
        Err(PyTypeError::new_err(message))
    }

    /// Reads a scenario file (TOML).
    #[staticmethod]
    fn from_file(py: Python<'_>, path: PathBuf) -> PyResult<Self> {
        let shown = path.display().to_string();
        let bytes = std::fs::read(&path).map_err(|error| match error.raw_os_error() {
            // Python names the file, and chooses the kind of OSError by the number.
            Some(number) => {
                let said = error.to_string();
                let said = said.split(" (os error").next().unwrap_or_default().to_owned();
                PyOSError::new_err((number, said, shown.clone()))
            }
            None => error.into(),
        })?;
        if bytes.len() > LONGEST {
            return Err(PyValueError::new_err(format!(
                "{shown}: longer than {LONGEST} bytes, the most that a scenario may have"
            )));
        }
        let text = Wrong::decode(&shown, bytes).map_err(|error| of_scenario(py, &error))?;
        let file = path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
        Self::read(py, (shown, file), text, Vec::new(), &ScenarioFolder::of(&path))
    }

    /// Reads the text of a scenario file; `name` is its name in messages and in runs.
    #[staticmethod]
    #[pyo3(signature = (text, name = "scenario.toml"))]
    fn from_text(py: Python<'_>, text: String, name: &str) -> PyResult<Self> {
        Self::read(py, (name.to_owned(), name.to_owned()), text, Vec::new(), &NoFiles)
    }

    /// A scenario from nested dictionaries, like the tables of a file: `{"world": {"ball2d": {"target": 2}}}`.
    #[staticmethod]
    #[pyo3(signature = (tables, name = "scenario.toml"))]
    fn from_dict(py: Python<'_>, tables: &Bound<'_, PyDict>, name: &str) -> PyResult<Self> {
        let text = toml::to_string(&table(tables, "")?)
            .map_err(|error| PyValueError::new_err(format!("the dictionary cannot be written as TOML: {error}")))?;
        Self::read(py, (name.to_owned(), name.to_owned()), text, Vec::new(), &NoFiles)
    }

    /// The scenario of a scene (`ball2d`, `bowling`, `dice`, `spelling`) with all settings at their defaults.
    #[staticmethod]
    fn default(py: Python<'_>, scene: &str) -> PyResult<Self> {
        let none = || ScenarioError::new_err(plaus_scenes::scenario::no_scene(scene));
        let scenario = plaus_scenes::Scenario::default_of(scene).ok_or_else(none)?;
        let name = format!("{scene}.toml");
        Self::read(py, (name.clone(), name), scenario.to_toml(), Vec::new(), &NoFiles)
    }

    /// The same scenario with some keys changed: `set("sigma_d=0.05")` as on the command line, or
    /// `set(sigma_d=0.05)`, or `set(**{"weights.aim": 2})`. A key is a full dotted name, or a unique ending of it.
    #[pyo3(signature = (*overrides, **keys))]
    fn set(
        &self,
        py: Python<'_>,
        overrides: Vec<Bound<'_, PyAny>>,
        keys: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Self> {
        let text = |given: &Bound<'_, PyAny>| {
            given.extract::<String>().map_err(|_| {
                let message = format!("{given} is not text: write set(key=value), or set(\"key=value\")");
                PyTypeError::new_err(message)
            })
        };
        let mut more = overrides.iter().map(text).collect::<PyResult<Vec<String>>>()?;
        for (key, value) in keys.into_iter().flatten() {
            let key: String = key.extract()?;
            more.push(format!("{key}={}", self::value(&value, &key)?));
        }
        self.with(py, more)
    }

    /// Every key with its value, including defaults, as nested dictionaries. Errors were raised when the scenario was
    /// made.
    ///
    /// With `draws`: draws this many animations from the prior. Returns how many of them met each requirement, by how
    /// much the nearest missed it and what it lacks, and pairs that were never met together: what
    /// `plaus check --draws N --json` prints.
    #[pyo3(signature = (*, draws = None))]
    fn check<'py>(&self, py: Python<'py>, draws: Option<u64>) -> PyResult<Bound<'py, PyAny>> {
        let Some(draws) = draws else {
            let tables: Table = self.toml().parse().map_err(|error| PyValueError::new_err(format!("{error}")))?;
            return to_python(py, &Value::Table(tables));
        };
        if draws == 0 {
            return Err(PyValueError::new_err("draws is 0, but must be at least 1"));
        }
        let (stage, tally) = self.drawn(py, draws)?;
        py.import("json")?.call_method1("loads", (plaus_cli::tally_to_json(&stage, &tally).to_string(),))
    }

    /// Every key with its value, as the text of a scenario file.
    #[getter]
    fn toml(&self) -> String {
        self.recipe.scenario.to_toml()
    }

    /// The scene's name.
    #[getter]
    fn scene(&self) -> &'static str {
        self.recipe.scenario.world.name()
    }

    /// The text that it was read from, without the keys set since.
    #[getter]
    fn text(&self) -> &str {
        &self.recipe.text
    }

    /// The name of the text.
    #[getter]
    fn name(&self) -> &str {
        &self.recipe.file
    }

    /// Keys set since, as `key=value`.
    #[getter]
    fn overrides(&self) -> Vec<String> {
        self.recipe.overrides.clone()
    }

    fn __eq__(&self, other: &Bound<'_, PyAny>) -> bool {
        other.cast::<Self>().is_ok_and(|other| other.get().recipe.scenario == self.recipe.scenario)
    }

    fn __hash__(&self) -> u64 {
        // FNV-1a of the whole text: equal scenarios have equal texts.
        self.toml()
            .bytes()
            .fold(0xcbf2_9ce4_8422_2325, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3))
    }

    fn __repr__(&self) -> String {
        let set: String = self.recipe.overrides.iter().map(|said| format!(", {said}")).collect();
        format!("<Scenario {}: {}{set}>", self.recipe.file, self.scene())
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<(Bound<'py, PyAny>, Parts)> {
        let rebuild = slf.py().import("plaus._plaus")?.getattr("_scenario")?;
        let Self { recipe: Recipe { file, text, overrides, .. }, files, .. } = slf.get();
        let files = files.iter().map(|(path, bytes)| (path.to_owned(), bytes.to_vec())).collect();
        Ok((rebuild, (text.clone(), file.clone(), overrides.clone(), files)))
    }
}

/// Restores a pickled scenario, with the files that it names.
#[pyfunction]
#[pyo3(signature = (text, name, overrides, files = Vec::new()))]
pub(crate) fn _scenario(
    py: Python<'_>,
    text: String,
    name: String,
    overrides: Vec<String>,
    files: Vec<(String, Vec<u8>)>,
) -> PyResult<Scenario> {
    let mut assets = Assets::default();
    files.into_iter().for_each(|(path, bytes)| assets.insert(path, bytes));
    Scenario::read(py, (name.clone(), name), text, overrides, &assets)
}

fn table(tables: &Bound<'_, PyDict>, within: &str) -> PyResult<Table> {
    let mut made = Table::new();
    for (key, item) in tables {
        let key: String = key.extract().map_err(|_| PyTypeError::new_err(format!("{within}: keys are strings")))?;
        let path = if within.is_empty() { key.clone() } else { format!("{within}.{key}") };
        made.insert(key, value(&item, &path)?);
    }
    Ok(made)
}

/// The TOML value for a Python one; `path` is its place.
fn value(item: &Bound<'_, PyAny>, path: &str) -> PyResult<Value> {
    if item.is_instance_of::<PyBool>() {
        Ok(Value::Boolean(item.extract()?))
    } else if item.is_instance_of::<PyInt>() {
        item.extract().map(Value::Integer)
    } else if item.is_instance_of::<PyFloat>() {
        item.extract().map(Value::Float)
    } else if item.is_instance_of::<PyString>() {
        item.extract().map(Value::String)
    } else if let Ok(tables) = item.cast::<PyDict>() {
        table(tables, path).map(Value::Table)
    } else if item.is_instance_of::<PyList>() || item.is_instance_of::<PyTuple>() {
        let items = item.try_iter()?.enumerate();
        let items = items.map(|(index, item)| value(&item?, &format!("{path}[{index}]"))).collect::<PyResult<_>>();
        items.map(Value::Array)
    } else if let Ok(number) = item.call_method0("__index__") {
        number.extract().map(Value::Integer) // numpy's whole numbers
    } else if let Ok(number) = item.call_method0("__float__") {
        number.extract().map(Value::Float)
    } else {
        let kind = item.get_type().name()?.to_string();
        Err(PyTypeError::new_err(format!(
            "{path}: a scenario cannot hold a {kind}: use numbers, strings, booleans, lists and dictionaries"
        )))
    }
}

/// The Python value for a TOML one.
fn to_python<'py>(py: Python<'py>, value: &Value) -> PyResult<Bound<'py, PyAny>> {
    Ok(match value {
        Value::String(text) => PyString::new(py, text).into_any(),
        Value::Integer(number) => number.into_pyobject(py)?.into_any(),
        Value::Float(number) => PyFloat::new(py, *number).into_any(),
        Value::Boolean(flag) => PyBool::new(py, *flag).to_owned().into_any(),
        Value::Datetime(time) => PyString::new(py, &time.to_string()).into_any(),
        Value::Array(items) => {
            let items: Vec<_> = items.iter().map(|item| to_python(py, item)).collect::<PyResult<_>>()?;
            PyList::new(py, items)?.into_any()
        }
        Value::Table(tables) => {
            let made = PyDict::new(py);
            for (key, item) in tables {
                made.set_item(key, to_python(py, item)?)?;
            }
            made.into_any()
        }
    })
}

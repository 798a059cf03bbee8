//! The simulator: worlds built in Python, run from many starts at once.

mod batch;
mod engine;
mod parts;

use crate::arrays::{frozen, given};
use crate::errors::WorldError;
use crate::scenario::Scenario;
use batch::{Batch, Made, Starts};
use parts::{Body, Law, Surface, Whole};
use plaus_scenes::spelling::Bins;
use plaus_scenes::{Physical, PlainWorld, Scene};
use plaus_sim::worlds::DieOnTable;
use plaus_sim::{Accuracy, Preset};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::sync::Mutex;

/// A world that can be run. Tables with bumps cache what was looked at, so each thread has its own copy.
#[pyclass(frozen, module = "plaus._plaus")]
pub(crate) struct SimWorld {
    world: Mutex<Physical>,
    bodies: usize,
    /// Places where bodies can start, if the world came with them.
    places: Vec<[f64; 3]>,
}

pub(crate) fn wrong(error: plaus_sim::WorldError) -> PyErr {
    WorldError::new_err(error.to_string())
}

/// Tolerances by the name of a preset.
fn accuracy(name: &str, events: Option<u64>) -> PyResult<Accuracy> {
    let preset = Preset::ALL.into_iter().find(|preset| preset.name() == name).ok_or_else(|| {
        let known: Vec<&str> = Preset::ALL.map(Preset::name).to_vec();
        PyValueError::new_err(format!("`{name}` is not an accuracy: there are {}", known.join(", ")))
    })?;
    let preset = Accuracy::preset(preset);
    Ok(Accuracy { events: events.unwrap_or(preset.events), ..preset })
}

impl SimWorld {
    fn of(world: Physical, places: Vec<[f64; 3]>) -> Self {
        Self { bodies: engine::bodies(&world), world: Mutex::new(world), places }
    }
}

/// The arrays of a batch that were asked for.
fn arrays<'py>(py: Python<'py>, made: Made, sides: [usize; 3]) -> PyResult<Bound<'py, PyDict>> {
    let [starts, bodies, times] = sides;
    let all = PyDict::new(py);
    all.set_item("ending", frozen(py, [starts], made.ending)?)?;
    all.set_item("time", frozen(py, [starts], made.time)?)?;
    all.set_item("impacts", frozen(py, [starts], made.impacts)?)?;
    all.set_item("position", frozen(py, [starts, bodies, 3], made.rest.position)?)?;
    all.set_item("velocity", frozen(py, [starts, bodies, 3], made.rest.velocity)?)?;
    all.set_item("spin", frozen(py, [starts, bodies, 3], made.rest.spin)?)?;
    all.set_item("orientation", frozen(py, [starts, bodies, 4], made.rest.orientation)?)?;
    if times > 0 {
        all.set_item("positions", frozen(py, [starts, times, bodies, 3], made.way.position)?)?;
        all.set_item("orientations", frozen(py, [starts, times, bodies, 4], made.way.orientation)?)?;
    }
    if let Some(events) = made.events {
        let count = events.t.len();
        let table = PyDict::new(py);
        table.set_item("start", frozen(py, [count], events.start)?)?;
        table.set_item("t", frozen(py, [count], events.t)?)?;
        table.set_item("body", frozen(py, [count], events.body)?)?;
        table.set_item("other", frozen(py, [count], events.other)?)?;
        table.set_item("point", frozen(py, [count, 3], events.point)?)?;
        table.set_item("normal", frozen(py, [count, 3], events.normal)?)?;
        table.set_item("speed", frozen(py, [count], events.speed)?)?;
        table.set_item("impulse", frozen(py, [count], events.impulse)?)?;
        all.set_item("events", table)?;
    }
    Ok(all)
}

/// An optional array of a start's numbers, `width` for each body.
fn optional<'py>(
    py: Python<'py>,
    (name, value): (&str, Option<&Bound<'py, PyAny>>),
    (starts, bodies, width): (usize, usize, usize),
) -> PyResult<Option<Vec<f64>>> {
    let Some(value) = value else { return Ok(None) };
    let (numbers, shape) = if width == 1 {
        let (numbers, [a, b]) = given::<2>(py, name, value)?;
        (numbers, [a, b, 1])
    } else {
        given::<3>(py, name, value)?
    };
    if shape != [starts, bodies, width] {
        return Err(PyValueError::new_err(format!(
            "{name}: shape {shape:?}, but {starts} starts of {bodies} bodies need {:?}",
            [starts, bodies, width]
        )));
    }
    Ok(Some(numbers))
}

#[pymethods]
impl SimWorld {
    #[new]
    #[pyo3(signature = (bodies, surfaces, laws, *, engine, materials, gravity, duration, accuracy, events))]
    #[allow(clippy::too_many_arguments, reason = "named in Python, which is the only caller")]
    fn new(
        bodies: Vec<Body>,
        surfaces: Vec<Surface>,
        laws: Vec<Law>,
        engine: &str,
        materials: u16,
        gravity: [f64; 3],
        duration: f64,
        accuracy: &str,
        events: Option<u64>,
    ) -> PyResult<Self> {
        let accuracy = self::accuracy(accuracy, events)?;
        let whole = Whole { bodies, surfaces, laws, materials, gravity, duration, accuracy };
        let world = if engine == "marbles" { whole.marbles()? } else { whole.rigid()? };
        Ok(Self::of(world, Vec::new()))
    }

    /// Marbles over the bins of the paper's figure 10.
    #[staticmethod]
    fn bins(count: usize, duration: f64, accuracy: &str, events: Option<u64>) -> PyResult<Self> {
        let made = Bins::default().world(count, self::accuracy(accuracy, events)?, duration);
        Ok(Self::of(Physical::Marbles(Box::new(made.map_err(wrong)?)), Vec::new()))
    }

    /// Dice of 16 mm on a flat table.
    #[staticmethod]
    fn dice(count: usize, accuracy: &str, events: Option<u64>) -> PyResult<Self> {
        let die = DieOnTable { accuracy: self::accuracy(accuracy, events)?, ..DieOnTable::default() };
        Ok(Self::of(Physical::Rigid(Box::new(die.world_of(count, |_, _| 0.0).map_err(wrong)?)), Vec::new()))
    }

    /// The world of a scenario without its randomness.
    #[staticmethod]
    fn of_scenario(scenario: &Scenario) -> PyResult<Self> {
        let world = &scenario.recipe.scenario.world;
        let scene = world.scene().map_err(|error| WorldError::new_err(error.to_string()))?;
        let made = Scene::world(&scene).map_err(|error| WorldError::new_err(error.to_string()))?;
        let PlainWorld { world, places } = made.ok_or_else(|| {
            PyValueError::new_err(format!("{} moves in closed form: it has no simulator", world.name()))
        })?;
        Ok(Self::of(world, places.iter().map(|place| place.to_array()).collect()))
    }

    /// Places where bodies can start, one in each row; none for a world that the user built.
    #[getter]
    fn places(&self) -> Vec<[f64; 3]> {
        self.places.clone()
    }

    #[getter]
    fn bodies(&self) -> usize {
        self.bodies
    }

    /// Runs from every start, on all threads; returns arrays by name.
    #[pyo3(signature = (position, *, velocity, spin, orientation, release, until, times, events, threads))]
    #[allow(clippy::too_many_arguments, reason = "named in Python, which is the only caller")]
    fn run<'py>(
        &self,
        py: Python<'py>,
        position: &Bound<'py, PyAny>,
        velocity: Option<&Bound<'py, PyAny>>,
        spin: Option<&Bound<'py, PyAny>>,
        orientation: Option<&Bound<'py, PyAny>>,
        release: Option<&Bound<'py, PyAny>>,
        until: f64,
        times: Vec<f64>,
        events: bool,
        threads: usize,
    ) -> PyResult<Bound<'py, PyDict>> {
        let (position, [count, bodies, width]) = given::<3>(py, "position", position)?;
        if (bodies, width) != (self.bodies, 3) {
            let message = format!(
                "position: shape {:?}, but a world of {} bodies needs (starts, {}, 3)",
                [count, bodies, width],
                self.bodies,
                self.bodies
            );
            return Err(PyValueError::new_err(message));
        }
        let array = |name, value, width| optional(py, (name, value), (count, bodies, width));
        let starts = Starts {
            count,
            bodies,
            position,
            velocity: array("velocity", velocity, 3)?,
            spin: array("spin", spin, 3)?,
            orientation: array("orientation", orientation, 4)?,
            release: array("release", release, 1)?,
        };
        if let Some(wrong) = times.iter().find(|time| !(**time >= 0.0 && time.is_finite())) {
            return Err(PyValueError::new_err(format!("times: {wrong} is not a time of at least 0")));
        }
        if until.is_nan() || until < 0.0 {
            return Err(PyValueError::new_err(format!("until is {until}, but must be a time of at least 0")));
        }
        let sides = [count, bodies, times.len()];
        let made = Batch { starts, until, times, events }.run(py, &self.world, threads)?;
        arrays(py, made, sides)
    }
}

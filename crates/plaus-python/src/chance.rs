//! Estimates of chances, made while Python waits, like runs.

use crate::errors::of_run;
use crate::scenario::Scenario;
use crate::wait::{Over, Wait, Watched};
use plaus_mcmc::chance::{ChancePulse, Method};
use plaus_run::chance::{Asking, Chance, Inquiry, ask, read};
use plaus_run::disk::{Disk, RealDisk};
use pyo3::exceptions::{PyFileNotFoundError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::path::PathBuf;
use std::sync::{Arc, Mutex, PoisonError};

/// What is known of an estimate while it is being made.
#[derive(Default)]
struct Board {
    pulse: ChancePulse,
    /// Batches made, and batches planned.
    batches: Mutex<(usize, usize)>,
}

impl Watched for Board {
    fn stop(&self) {
        self.pulse.stop();
    }

    fn tell(&self, state: &Bound<'_, PyDict>) -> PyResult<bool> {
        let (done, due) = *self.batches.lock().unwrap_or_else(PoisonError::into_inner);
        state.set_item("simulations", self.pulse.simulations())?;
        state.set_item("batches", done)?;
        state.set_item("batches_planned", due)?;
        Ok(true)
    }
}

/// What is known of a chance: the command's output as JSON and in words, and its scenario's name and effective text.
type Known = (String, String, String, String);

fn known(chance: &Chance) -> Known {
    let json = plaus_cli::chance_to_json(chance).to_string();
    let stored = &chance.scenario;
    (json, plaus_cli::chance_in_words(chance), stored.file.clone(), stored.effective.clone())
}

/// Numbers of an estimate; those not given are the command's defaults.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct Numbers {
    batches: Option<u64>,
    draws: Option<u64>,
    particles: Option<u64>,
    steps: Option<u64>,
    rungs: Option<u64>,
    iterations: Option<u64>,
}

impl Numbers {
    /// What is asked, checked against the command's ranges.
    fn asking(&self, mut asking: Asking) -> PyResult<Asking> {
        let Asking { batches, draws, splitting, stones, .. } = &mut asking;
        *batches = within("batches", self.batches, 2, 100_000)?.map_or(*batches, |number| number as u32);
        *draws = within("draws", self.draws, 1, u64::MAX)?.unwrap_or(*draws);
        let particles = within("particles", self.particles, 2, 10_000_000)?;
        splitting.particles = particles.map_or(splitting.particles, |number| number as u32);
        splitting.steps = within("steps", self.steps, 1, 1_000_000_000)?.unwrap_or(splitting.steps);
        stones.rungs = within("rungs", self.rungs, 2, 256)?.map_or(stones.rungs, |number| number as u32);
        stones.iterations = within("iterations", self.iterations, 1, 1_000_000_000_000)?.unwrap_or(stones.iterations);
        stones.warmup = stones.iterations / 4;
        Ok(asking)
    }
}

fn within(name: &str, number: Option<u64>, least: u64, most: u64) -> PyResult<Option<u64>> {
    match number {
        Some(number) if !(least..=most).contains(&number) => {
            Err(PyValueError::new_err(format!("{name} is {number}, but must be from {least} to {most}")))
        }
        number => Ok(number),
    }
}

fn method(name: &str) -> PyResult<Method> {
    match name {
        "counting" => Ok(Method::Counting),
        "splitting" => Ok(Method::Splitting),
        "stones" => Ok(Method::Stones),
        "importance" => Ok(Method::Importance),
        _ => Err(PyValueError::new_err(format!(
            "there is no method {name:?}: there are counting, splitting, stones, importance"
        ))),
    }
}

/// Estimates how likely it is that a scenario does what it asks for. Returns what is known, why it was stopped, and
/// seconds.
#[pyfunction]
#[pyo3(signature = (scenario, *, overrides, numbers, methods, out, threads, max_time, poll, interval))]
#[allow(clippy::too_many_arguments, reason = "named in Python, which is the only caller")]
pub(crate) fn chance<'py>(
    py: Python<'py>,
    scenario: &Bound<'py, Scenario>,
    overrides: Vec<String>,
    numbers: Numbers,
    methods: Vec<String>,
    out: Option<PathBuf>,
    threads: usize,
    max_time: Option<f64>,
    poll: Option<Bound<'py, PyAny>>,
    interval: f64,
) -> PyResult<(Known, Option<&'static str>, f64)> {
    let recipe = scenario.get().with(py, overrides)?.recipe;
    let asking = numbers.asking(Asking::new(recipe.plan().seed))?;
    let methods = methods.iter().map(|name| method(name)).collect::<PyResult<_>>()?;
    let board = Arc::new(Board::default());
    let shared = Arc::clone(&board);
    let job = move || {
        let place = out.as_deref().map(|path| (path, &RealDisk as &dyn Disk));
        let pulse = &shared.pulse;
        let inquiry = Inquiry { recipe: &recipe, asking, methods, shard: None, place, threads, pulse };
        ask(&inquiry, &|chance: &Chance| {
            *shared.batches.lock().unwrap_or_else(PoisonError::into_inner) = chance.done();
        })
    };
    let Over { made, why, seconds } = Wait { py, max_time, poll, interval }.over(&*board, job)?;
    Ok((known(&made), why, seconds))
}

/// Reads the file of an estimate.
#[pyfunction]
pub(crate) fn read_chance(py: Python<'_>, path: PathBuf) -> PyResult<Known> {
    match py.detach(|| read(&path)).map_err(|error| of_run(py, &error))? {
        Some(chance) => Ok(known(&chance)),
        None => Err(PyFileNotFoundError::new_err(format!("{}: there is no such file", path.display()))),
    }
}

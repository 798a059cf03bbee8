//! Runs, read back.

use crate::arrays::frozen;
use crate::errors::{RunError, of_run, room, volume};
use crate::motion::Motion;
use plaus_gallery::Options;
use plaus_mcmc::parallel;
use plaus_run::replay::{Replay, replay, replay_at, replay_each};
use plaus_run::{ChainPhase, Diagnosis, Error, Folder, RunFileProblem, RunReader, SampleId, solutions};
use plaus_scenes::{AccuracyPreset, Role, Scalar, Scene};
use pyo3::exceptions::{PyFileNotFoundError, PyValueError};
use pyo3::prelude::*;
use serde_json::json;
use std::path::PathBuf;
use std::sync::Arc;

/// A solution: chain, draw, iteration, log p, and whether it is of the warm-up.
type Found = (u32, u64, u64, f64, bool);

/// A run in a folder.
#[pyclass(frozen, module = "plaus._plaus")]
pub(crate) struct RunFolder {
    run: plaus_run::Run,
}

/// Does `work` without Python's lock, on threads of its own: those of a process that forked are not there in the child.
pub(crate) fn apart<T: Send>(py: Python<'_>, threads: usize, work: impl FnOnce() -> T + Send) -> PyResult<T> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
    let pool = pool.map_err(|error| RunError::new_err(format!("cannot start worker threads: {error}")))?;
    Ok(py.detach(|| pool.install(work)))
}

impl RunFolder {
    /// What `look` finds out about the run, without Python's lock.
    fn read<T: Send>(
        &self,
        py: Python<'_>,
        look: impl FnOnce(&RunReader<'_>) -> Result<T, Error> + Send,
    ) -> PyResult<T> {
        let made = apart(py, 0, || self.run.reader().and_then(|run| look(&run)))?;
        made.map_err(|error| of_run(py, &error))
    }
}

/// All draws of a phase, a column a number.
struct Table {
    scalars: Vec<Scalar>,
    chains: usize,
    draws: usize,
    /// Of the scalars, then log p, then the accepted share.
    numbers: Vec<Vec<f64>>,
    satisfied: Vec<bool>,
}

fn table(run: &RunReader<'_>, phase: ChainPhase) -> Result<PyResult<Table>, Error> {
    let scalars = run.scene().scalars();
    let (chains, draws) = (run.chains().len(), run.draws(phase) as usize);
    let rooms = || -> PyResult<_> {
        let count = volume(&[chains, draws])?;
        let numbers: Vec<Vec<f64>> = (0..scalars.len() + 2).map(|_| room(0.0, count)).collect::<PyResult<_>>()?;
        Ok((numbers, room(false, count)?))
    };
    let (mut numbers, mut satisfied) = match rooms() {
        Ok(rooms) => rooms,
        Err(error) => return Ok(Err(error)),
    };
    if draws > 0 {
        let mut parts: Vec<(Vec<&mut [f64]>, &mut [bool])> =
            satisfied.chunks_mut(draws).map(|part| (Vec::new(), part)).collect();
        for column in &mut numbers {
            column.chunks_mut(draws).zip(&mut parts).for_each(|(chunk, part)| part.0.push(chunk));
        }
        let first = run.chains().start;
        let filled = parallel::map_mut(&mut parts, |k, part| fill(run, (first + k as u32, phase), part));
        filled.into_iter().collect::<Result<(), _>>()?;
    }
    Ok(Ok(Table { scalars, chains, draws, numbers, satisfied }))
}

fn fill(
    run: &RunReader<'_>,
    (chain, phase): (u32, ChainPhase),
    (numbers, satisfied): &mut (Vec<&mut [f64]>, &mut [bool]),
) -> Result<(), Error> {
    let thin = run.run().manifest().plan.thin as f64;
    let count = numbers.len() - 2;
    let mut values = vec![0.0; count];
    run.walk(chain, phase, |repeats| -> Result<(), Error> {
        run.scene().write_scalars(repeats.entry.state.by_ref(), &mut values);
        let first = repeats.draw as usize;
        let span = first..first + repeats.draws as usize;
        for (column, &value) in numbers.iter_mut().zip(&values) {
            column[span.clone()].fill(value);
        }
        numbers[count][span.clone()].fill(repeats.entry.state.log_p().value());
        // As in an export: the first draw of such repeats is where something was accepted; a swap comes on top.
        numbers[count + 1][first] = (f64::from(repeats.accepted) / thin).min(1.0);
        satisfied[span].fill(repeats.entry.class.is_some());
        Ok(())
    })
}

fn solutions_of(run: &RunReader<'_>) -> Result<Vec<Found>, Error> {
    Ok(solutions::distinct(run)?.iter().map(told).collect())
}

fn told(one: &plaus_run::Solution) -> Found {
    let plaus_run::Solution { sample, iteration, log_p } = *one;
    (sample.chain, sample.draw, iteration, log_p, !sample.phase.is_sampling())
}

/// Samples simulated again, each as it was or at another accuracy.
fn replays(run: &RunReader<'_>, samples: &[SampleId], accuracy: Option<AccuracyPreset>) -> Result<Vec<Replay>, Error> {
    match (accuracy, samples) {
        (Some(accuracy), all) => all.iter().map(|&sample| replay_at(run, sample, accuracy)).collect(),
        (None, &[one]) => Ok(vec![replay(run, one)?]),
        (None, all) => replay_each(run, all, |replay| replay),
    }
}

fn phase(warmup: bool) -> ChainPhase {
    if warmup { ChainPhase::Warmup } else { ChainPhase::Sampling }
}

/// A column: name, unit, role, and an array (chain, draw).
type Column<'py> = (String, &'static str, &'static str, Bound<'py, PyAny>);

#[pymethods]
impl RunFolder {
    #[new]
    #[pyo3(signature = (path, salvage = false))]
    fn open(py: Python<'_>, path: PathBuf, salvage: bool) -> PyResult<Self> {
        let run = py.detach(|| plaus_run::Run::open(&Folder::new(path))).map_err(|error| match &error {
            Error::File(file) if matches!(file.problem, RunFileProblem::Missing) => {
                PyFileNotFoundError::new_err(error.to_string())
            }
            _ => of_run(py, &error),
        })?;
        Ok(Self { run: if salvage { run.salvaged() } else { run } })
    }

    /// What the run is, as JSON.
    fn manifest(&self) -> PyResult<String> {
        serde_json::to_string(self.run.manifest()).map_err(|error| RunError::new_err(error.to_string()))
    }

    /// Draws of the warm-up and of the sampling phase that each chain has, and iterations done.
    fn size(&self, py: Python<'_>) -> PyResult<(u64, u64, u64)> {
        self.read(py, |run| Ok((run.draws(ChainPhase::Warmup), run.draws(ChainPhase::Sampling), run.iterations())))
    }

    /// Numbers of the chains that the folder holds: the first, and one past the last.
    fn chains(&self) -> (u32, u32) {
        let chains = self.run.manifest().chains();
        (chains.start, chains.end)
    }

    fn is_being_written(&self) -> bool {
        self.run.folder().is_being_written()
    }

    /// Columns of a phase: the scene's numbers, then `lp`, `acceptance_rate` and `satisfied`.
    fn columns<'py>(&self, py: Python<'py>, warmup: bool) -> PyResult<Vec<Column<'py>>> {
        let Table { scalars, chains, draws, numbers, satisfied } = self.read(py, |run| table(run, phase(warmup)))??;
        let role = |role| match role {
            Role::Draw => "draw",
            Role::Outcome => "outcome",
            Role::Detail => "detail",
        };
        let own = scalars.into_iter().map(|scalar| (scalar.name, scalar.unit, role(scalar.role)));
        let more = ["lp", "acceptance_rate"].map(|name| (name.to_owned(), "", "stat"));
        let mut columns: Vec<Column<'py>> = Vec::new();
        for ((name, unit, role), values) in own.chain(more).zip(numbers) {
            columns.push((name, unit, role, frozen(py, [chains, draws], values)?));
        }
        columns.push(("satisfied".to_owned(), "", "stat", frozen(py, [chains, draws], satisfied)?));
        Ok(columns)
    }

    /// The first draw of each distinct solution: chain, draw, iteration, log p, and whether it is of the warm-up.
    fn solutions(&self, py: Python<'_>) -> PyResult<Vec<Found>> {
        self.read(py, solutions_of)
    }

    /// Up to `count` distinct solutions: the likeliest, then always the one that looks least like those before.
    fn most_different(&self, py: Python<'_>, count: usize) -> PyResult<Vec<Found>> {
        self.read(py, |run| Ok(solutions::most_different(run, count)?.solutions.iter().map(told).collect()))
    }

    /// What is known of samples that are simulated again, as JSON, and their motions.
    #[pyo3(signature = (samples, accuracy = None))]
    fn replay(
        &self,
        py: Python<'_>,
        samples: Vec<(u32, u64, bool)>,
        accuracy: Option<String>,
    ) -> PyResult<Vec<(String, Motion)>> {
        let named = |(chain, draw, early)| SampleId { chain, phase: phase(early), draw };
        let samples: Vec<SampleId> = samples.into_iter().map(named).collect();
        let accuracy = accuracy.map(|name| preset(&name)).transpose()?;
        let manifest = self.run.manifest();
        let show = |replay: Replay| {
            let facts = plaus_cli::label_of(manifest, &replay).facts;
            (json!(facts).to_string(), Motion(Arc::new(replay.animation.motion)))
        };
        self.read(py, |run| Ok(replays(run, &samples, accuracy)?.into_iter().map(show).collect()))
    }

    /// A page that plays solutions, how many it shows, and how many there are.
    fn gallery(&self, py: Python<'_>, count: usize) -> PyResult<(String, usize, usize)> {
        let options = Options { count, run: self.run.folder().path().display().to_string(), ..Options::default() };
        let made = self.read(py, |run| plaus_gallery::gallery(run, &options))?;
        Ok((made.html, made.shown, made.distinct))
    }

    /// What `plaus diagnose --json` says.
    #[pyo3(signature = (most = None))]
    fn diagnose(&self, py: Python<'_>, most: Option<u64>) -> PyResult<String> {
        let diagnosis = self.read(py, |run| Ok(Diagnosis::of(run, most)?))?;
        Ok(plaus_cli::diagnosis_to_json(self.run.manifest(), &diagnosis).to_string())
    }
}

/// A preset of accuracy by name.
fn preset(name: &str) -> PyResult<AccuracyPreset> {
    name.parse().map_err(PyValueError::new_err)
}

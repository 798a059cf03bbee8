//! Sampling: the progress of a run, and where the run is kept.

use crate::clock::now;
use crate::requirement::{Asked, ByPython};
use crate::scenario::Scenario;
use crate::wait::{Wait, Watched};
use plaus_mcmc::{Control, Ending, Plan, Progress, Pulse};
use plaus_run::disk::{Disk, RealDisk};
use plaus_run::{Folder, Further, Manifest, More, Recipe, Sampling, Watch};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

/// The progress of a run.
#[derive(Default)]
struct Board {
    pulse: Arc<Pulse>,
    /// The plan, and the iterations that each chain had done before.
    plan: Mutex<Option<(Plan, u64)>>,
}

/// Saves a run about once a second.
struct Watching {
    board: Arc<Board>,
    checkpoint: f64,
    pause: f64,
    writing: Option<f64>,
}

impl Watch for Watching {
    fn begin(&mut self, manifest: &Manifest, done: u64) {
        self.checkpoint = now();
        *self.board.plan.lock().unwrap_or_else(PoisonError::into_inner) = Some((manifest.plan, done));
    }

    fn round(&mut self, _: &Progress<'_>) -> Control {
        if self.board.pulse.is_stopped() { Control::Stop } else { Control::Continue }
    }

    fn checkpoint_due(&mut self) -> bool {
        let due = now() - self.checkpoint >= self.pause;
        self.writing = due.then(now);
        due
    }

    fn checkpoint_done(&mut self) {
        if let Some(begun) = self.writing.take() {
            self.pause = (20.0 * (now() - begun)).max(1.0);
        }
        self.checkpoint = now();
    }

    fn pulse(&self) -> Arc<Pulse> {
        Arc::clone(&self.board.pulse)
    }
}

/// A disk for runs that end with the program: nothing waits until it is safe from a power cut.
struct Fleeting;

impl Disk for Fleeting {
    fn append(&self, path: &Path, bytes: &[u8]) -> io::Result<()> {
        RealDisk.append(path, bytes)
    }

    fn write(&self, path: &Path, bytes: &[u8]) -> io::Result<()> {
        std::fs::write(path, bytes)
    }

    fn sync(&self, _: &Path) -> io::Result<()> {
        Ok(())
    }

    fn rename(&self, from: &Path, to: &Path) -> io::Result<()> {
        RealDisk.rename(from, to)
    }

    fn truncate(&self, path: &Path, length: u64) -> io::Result<()> {
        RealDisk.truncate(path, length)
    }

    fn remove(&self, path: &Path) -> io::Result<()> {
        RealDisk.remove(path)
    }

    fn create_folder(&self, path: &Path) -> io::Result<()> {
        RealDisk.create_folder(path)
    }
}

/// What to do.
enum Task {
    Sample(Recipe),
    Resume(More),
}

struct Job {
    task: Task,
    folder: Folder,
    threads: usize,
    fleeting: bool,
    by: Option<ByPython>,
    board: Arc<Board>,
}

impl Job {
    fn run(self) -> Result<Ending, plaus_run::Error> {
        let Self { task, folder, threads, fleeting, by, board } = self;
        let mut watch = Watching { board, checkpoint: now(), pause: 0.2, writing: None };
        let disk: &dyn Disk = if fleeting { &Fleeting } else { &RealDisk };
        let further = by.map(|by| -> Result<Further, plaus_run::Error> {
            Ok(by.further(match &task {
                Task::Sample(recipe) => recipe.scenario.stage()?,
                Task::Resume(_) => Manifest::read(&folder)?.scenario()?.stage()?,
            }))
        });
        let sampling = Sampling { threads, disk, watch: &mut watch, further: further.transpose()? };
        match task {
            Task::Sample(recipe) => plaus_run::sample(&folder, &recipe, sampling),
            Task::Resume(more) => plaus_run::resume(&folder, more, sampling),
        }
    }
}

impl Watched for Board {
    fn stop(&self) {
        self.pulse.stop();
    }

    fn tell(&self, state: &Bound<'_, PyDict>) -> PyResult<bool> {
        let plan = *self.plan.lock().unwrap_or_else(PoisonError::into_inner);
        let Some((plan, before)) = plan else { return Ok(false) };
        let chains = self.pulse.chains();
        state.set_item("warmup", plan.warmup)?;
        state.set_item("iterations_planned", plan.end())?;
        state.set_item("iterations_before", before)?;
        state.set_item("solutions_wanted", plan.solutions)?;
        state.set_item("distinct", self.pulse.distinct())?;
        state.set_item("iterations", chains.iter().map(|chain| chain.iterations).collect::<Vec<_>>())?;
        state.set_item("satisfied", chains.iter().map(|chain| chain.hits).collect::<Vec<_>>())?;
        Ok(true)
    }
}

/// Samples into `folder`, or continues the run there if `scenario` is None; returns how it ended, and seconds.
#[pyfunction]
#[pyo3(signature = (
    scenario, folder, *, overrides, solutions, iterations, threads, fleeting, max_time, asked, others, poll, interval
))]
#[allow(clippy::too_many_arguments, reason = "named in Python, which is the only caller")]
pub(crate) fn sample<'py>(
    py: Python<'py>,
    scenario: Option<&Bound<'py, Scenario>>,
    folder: PathBuf,
    overrides: Vec<String>,
    solutions: Option<u64>,
    iterations: Option<u64>,
    threads: usize,
    fleeting: bool,
    max_time: Option<f64>,
    asked: Option<Py<Asked>>,
    others: Option<Py<PyAny>>,
    poll: Option<Bound<'py, PyAny>>,
    interval: f64,
) -> PyResult<(&'static str, f64)> {
    let task = match scenario {
        Some(scenario) => Task::Sample(Recipe { solutions, ..scenario.get().with(py, overrides)?.recipe }),
        None => Task::Resume(More { iterations, solutions }),
    };
    let board = Arc::new(Board::default());
    let by = asked.map(|asked| ByPython { asked: Arc::new(asked), others: others.map(Arc::new) });
    let job = Job { task, folder: Folder::new(folder), threads, fleeting, by, board: Arc::clone(&board) };
    let over = Wait { py, max_time, poll, interval }.over(&*board, move || job.run())?;
    let ending = match (over.made, over.why) {
        (Ending::Complete, _) => "complete",
        (Ending::EnoughSolutions, _) => "enough_solutions",
        (Ending::Stopped, why) => why.unwrap_or("stopped"),
    };
    Ok((ending, over.seconds))
}

//! Chains of a target in Python, kept in memory.

use super::kernel::{Kernel, mixture};
use super::{ByFunctions, Functions, Point};
use crate::arrays::frozen;
use crate::errors::{RunError, of_chain, room};
use plaus_dist::Seed;
use plaus_mcmc::{Block, Control, Ending, MoveCounts, Plan, Progress, Pulse, RunError as Failed, Sink, Snapshot};
use pyo3::exceptions::PyMemoryError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::collections::TryReserveError;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::thread;
use std::time::Duration;

/// How often it is looked whether Python wants an end.
const TICK: Duration = Duration::from_millis(50);

/// Draws of all chains, without the warm-up.
#[derive(Default)]
struct Kept {
    warmup: u64,
    chains: Vec<Chain>,
    counts: Vec<MoveCounts>,
}

#[derive(Default, Clone)]
struct Chain {
    points: Vec<f64>,
    log_p: Vec<f64>,
    satisfied: Vec<bool>,
}

impl Chain {
    /// Makes room for further draws of a point.
    fn reserve(&mut self, draws: usize, size: usize) -> Result<(), TryReserveError> {
        self.points.try_reserve(draws.saturating_mul(size))?;
        self.log_p.try_reserve(draws)?;
        self.satisfied.try_reserve(draws)
    }
}

impl Sink<Vec<f64>, super::Said> for Kept {
    /// There is no memory for more draws.
    type Error = TryReserveError;

    fn block(
        &mut self,
        chain: u32,
        block: Block<Vec<f64>, super::Said>,
        snapshot: &Snapshot<Vec<f64>, super::Said>,
    ) -> Result<(), Self::Error> {
        let chain = &mut self.chains[chain as usize];
        let mut next = block.first_iteration;
        for entry in block.entries {
            let state: &Point = &entry.state;
            let from = next.max(self.warmup);
            next += entry.draws;
            chain.reserve(next.saturating_sub(from) as usize, state.draw.len())?;
            for _ in from..next.max(from) {
                chain.points.extend(&state.draw);
                chain.log_p.push(state.log_p().value());
                chain.satisfied.push(entry.class.is_some());
            }
        }
        if self.counts.is_empty() {
            self.counts = vec![MoveCounts::default(); snapshot.counts.len()];
        }
        Ok(())
    }

    fn round(&mut self, progress: &Progress<'_>) -> Result<Control, Self::Error> {
        self.counts.fill(MoveCounts::default());
        for (counts, _) in &progress.chains {
            self.counts.iter_mut().zip(*counts).for_each(|(sum, count)| sum.add(count));
        }
        Ok(Control::Continue)
    }
}

/// Samples a target; arrays by name.
#[pyfunction]
#[pyo3(signature = (functions, kernels, *, chains, warmup, iterations, seed, solutions))]
#[allow(clippy::too_many_arguments, reason = "named in Python, which is the only caller")]
pub(crate) fn sample_target<'py>(
    py: Python<'py>,
    functions: Py<Functions>,
    kernels: Vec<Py<Kernel>>,
    chains: u32,
    warmup: u64,
    iterations: u64,
    seed: u64,
    solutions: Option<u64>,
) -> PyResult<Bound<'py, PyDict>> {
    let moves = mixture(py, &kernels)?;
    let names = moves.names();
    let (block, thin) = (1000, 1);
    // Nothing is adapted: whoever looks for solutions gets each from the first on.
    let warmup = if solutions.is_some() { 0 } else { warmup };
    let plan = Plan {
        seed: Seed(seed),
        chains,
        warmup,
        iterations,
        thin,
        block,
        solutions,
        rungs: 1,
        adapt_rungs: false,
        swap_every: 20,
        adapt: false,
        weigh: false,
        settle: false,
        climbs: 0,
        sampled: false,
    };
    let target = ByFunctions(functions);
    let pulse = Arc::new(Pulse::default());
    let mut kept = Kept { warmup, chains: vec![Chain::default(); chains as usize], counts: Vec::new() };
    // One thread: the functions could not run side by side anyway, and this way they are called in one order.
    let (ended, interrupted) = py.detach(|| {
        let (over, interrupted) = (AtomicBool::new(false), AtomicBool::new(false));
        let ended = thread::scope(|scope| {
            let (kept, pulse, over, target, moves) = (&mut kept, &pulse, &over, &target, &moves);
            let work = scope.spawn(move || {
                let ended = plaus_mcmc::run_watched(target, moves, plan, Vec::new(), 1, kept, pulse);
                over.store(true, Relaxed);
                ended
            });
            while !work.is_finished() {
                thread::park_timeout(TICK);
                if !over.load(Relaxed) && Python::attach(|py| py.check_signals()).is_err() {
                    interrupted.store(true, Relaxed);
                    pulse.stop();
                }
            }
            work.join()
        });
        (ended, interrupted.into_inner())
    });
    let ended = ended.map_err(|_| RunError::new_err("plaus panicked while sampling: a bug of plaus"))?;
    let ending = ended.map_err(|error| match error {
        Failed::Chain { chain, source } => of_chain(py, &source, Some(chain), "Nothing of it is kept"),
        Failed::Sink(error) => PyMemoryError::new_err(format!("no memory for more draws: {error}. Nothing is kept")),
        other => RunError::new_err(other.to_string()),
    })?;
    let made = arrays(py, &kept)?;
    let counts = names.iter().zip(&kept.counts).map(|(name, counts)| (name, counts.acceptance()));
    made.set_item("acceptance", counts.collect::<Vec<_>>())?;
    made.set_item(
        "ending",
        match ending {
            Ending::Complete => "complete",
            Ending::EnoughSolutions => "enough_solutions",
            Ending::Stopped if interrupted => "interrupted",
            Ending::Stopped => "stopped",
        },
    )?;
    Ok(made)
}

/// The draws that all chains have.
fn arrays<'py>(py: Python<'py>, kept: &Kept) -> PyResult<Bound<'py, PyDict>> {
    let (chains, draws) = (kept.chains.len(), kept.chains.iter().map(|chain| chain.log_p.len()).min().unwrap_or(0));
    let size = |chain: &Chain| chain.points.len() / chain.log_p.len().max(1);
    let size = kept.chains.first().map_or(0, size);
    if kept.chains.iter().any(|chain| chain.points.len() != size * chain.log_p.len()) {
        return Err(RunError::new_err("start gave points of different lengths: all points of a target have one"));
    }
    let made = PyDict::new(py);
    made.set_item("x", frozen(py, [chains, draws, size], joined(kept, draws * size, |chain| &chain.points)?)?)?;
    made.set_item("lp", frozen(py, [chains, draws], joined(kept, draws, |chain| &chain.log_p)?)?)?;
    made.set_item("satisfied", frozen(py, [chains, draws], joined(kept, draws, |chain| &chain.satisfied)?)?)?;
    Ok(made)
}

/// The first `each` values of every chain, one chain after the other.
fn joined<T: Copy + Default>(kept: &Kept, each: usize, of: impl Fn(&Chain) -> &[T]) -> PyResult<Vec<T>> {
    let mut all = room(T::default(), each * kept.chains.len())?;
    if each > 0 {
        all.chunks_mut(each).zip(&kept.chains).for_each(|(part, chain)| part.copy_from_slice(&of(chain)[..each]));
    }
    Ok(all)
}

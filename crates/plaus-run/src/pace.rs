//! How fast a run's chains are on this machine. A folder does not record any times.

use crate::error::Error;
use crate::read::RunReader;
use plaus_mcmc::{Block, Control, Distinct, Plan, Progress, Pulse, Sink, Snapshot, Start, run_some};

/// A sink that drops everything.
struct Nowhere;

impl<D, O> Sink<D, O> for Nowhere {
    type Error = std::convert::Infallible;
    fn block(&mut self, _: u32, _: Block<D, O>, _: &Snapshot<D, O>) -> Result<(), Self::Error> {
        Ok(())
    }
    fn round(&mut self, _: &Progress<'_>) -> Result<Control, Self::Error> {
        Ok(Control::Continue)
    }
}

/// Continues the first chain of a run on one thread, without recording, until `pulse` is stopped; gives the number of
/// iterations made. The run does not change. `None` if there is no chain to continue.
///
/// # Errors
/// [`Error`] if an iteration fails, or the run has a requirement that its folder does not hold.
pub fn pace(run: &RunReader<'_>, pulse: &Pulse) -> Result<Option<u64>, Error> {
    let manifest = run.run().manifest();
    manifest.judges_alone()?;
    let first = run.chains().start;
    let Some(snapshot) = run.snapshot(first).cloned() else { return Ok(None) };
    let begun = snapshot.end_iteration;
    // The longest plan that any run may have.
    let iterations = (1 << 48) - 1 - manifest.plan.warmup;
    let plan = Plan { iterations, solutions: None, ..manifest.plan };
    let moves = manifest.mixture(run.scene())?;
    let starts = vec![Start { snapshot, distinct: Distinct::default() }];
    run_some(run.scene(), &moves, plan, first..first + 1, starts, 1, &mut Nowhere, pulse)
        .map_err(|error| Error::Sampling(error.to_string()))?;
    Ok(pulse.chains().first().map(|chain| chain.iterations.saturating_sub(begun)))
}

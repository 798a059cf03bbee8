//! How the chains of a run are driven: by the scene alone, or with a further requirement.

use crate::error::RunFileError;
use crate::{Draw, Outcome};
use plaus_mcmc::{Ending, Mixture, Plan, Pulse, RunError, Sink, Start};
use plaus_scenes::Stage;
use std::ops::Range;
use std::sync::Arc;

/// Where the chains of a scene continue.
pub(crate) type Starts = Vec<Start<Draw, Outcome>>;

/// Everything about a run that is not in its scene.
pub struct Journey<'a> {
    /// Length, recording interval and seed.
    pub plan: Plan,
    /// Which of the plan's chains: all, or those of a piece.
    pub chains: Range<u32>,
    /// Where the chains continue; empty for a new run.
    pub starts: Starts,
    /// Threads; 0 means one per core.
    pub threads: usize,
    /// Where chains report progress, and what stops them.
    pub pulse: &'a Pulse,
}

/// How a drive ends.
pub type Driven = Result<Ending, RunError<RunFileError>>;

/// Drives the chains of a run. It records states of the scene; if the run has a requirement, their log constraint
/// includes its factor.
pub trait Drive {
    /// A name for what is required beyond the scenario, for the manifest; `None` if nothing is.
    fn requirement(&self) -> Option<String>;

    /// Drives the chains, and passes their records to `sink`.
    ///
    /// # Errors
    /// As [`plaus_mcmc::run_some()`].
    fn drive<K: Sink<Draw, Outcome, Error = RunFileError>>(
        &self,
        scene: &Arc<Stage>,
        moves: &Mixture<Stage>,
        journey: Journey<'_>,
        sink: &mut K,
    ) -> Driven;
}

/// The scene alone.
#[derive(Debug, Clone, Copy, Default)]
pub struct Alone;

impl Drive for Alone {
    fn requirement(&self) -> Option<String> {
        None
    }

    fn drive<K: Sink<Draw, Outcome, Error = RunFileError>>(
        &self,
        scene: &Arc<Stage>,
        moves: &Mixture<Stage>,
        journey: Journey<'_>,
        sink: &mut K,
    ) -> Driven {
        let Journey { plan, chains, starts, threads, pulse } = journey;
        plaus_mcmc::run_some(&**scene, moves, plan, chains, starts, threads, sink, pulse)
    }
}

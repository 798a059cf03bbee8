//! How the chains of a run are driven: by the scene alone, or under something more that is asked of it.

use crate::error::RunFileError;
use crate::{Draw, Outcome};
use plaus_mcmc::{Ending, Mixture, Plan, Pulse, RunError, Sink, Start};
use plaus_scenes::Stage;
use std::ops::Range;
use std::sync::Arc;

/// Where the chains of a scene go on from.
pub(crate) type Starts = Vec<Start<Draw, Outcome>>;

/// What of a run is not in its scene.
pub struct Journey<'a> {
    /// How long, how often, from which seed.
    pub plan: Plan,
    /// Which of the plan's chains: all, or those of a piece.
    pub chains: Range<u32>,
    /// Where the chains go on from; empty for a new run.
    pub starts: Starts,
    /// Threads; 0 is one a core.
    pub threads: usize,
    /// What the chains report to, and are stopped by.
    pub pulse: &'a Pulse,
}

/// How a drive ends.
pub type Driven = Result<Ending, RunError<RunFileError>>;

/// Drives the chains of a run. What it records are states of the scene; their log constraint may hold more than the
/// scene's own, where the run has a requirement.
pub trait Drive {
    /// What is required beyond the scenario, in a word, for the manifest; `None` where nothing is, and states are the
    /// scene's own.
    fn requirement(&self) -> Option<String>;

    /// Drives the chains, and hands what they record to `sink`.
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

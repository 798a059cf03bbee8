//! Watching a run while it is sampled.

use crate::folder::Folder;
use crate::gauge::Mixing;
use crate::manifest::Manifest;
use plaus_mcmc::{Control, Progress, Pulse};
use std::sync::Arc;

/// Watches a run while it is sampled, and may stop it.
pub trait Watch {
    /// Called before anything of a new run is simulated, with what a user should know of its world
    /// ([`notes`](plaus_scenes::Scene::notes)).
    fn noted(&mut self, _notes: &[String]) {}

    /// Called before the first round, when each chain has already done `done` iterations.
    fn begin(&mut self, _manifest: &Manifest, _done: u64) {}

    /// Called after each round; returns whether to continue.
    fn round(&mut self, progress: &Progress<'_>) -> Control;

    /// Whether the draws since the last checkpoint are worth a new one. The answers do not change the final bytes, but
    /// decide how much is lost if the process is killed.
    fn checkpoint_due(&mut self) -> bool {
        true
    }

    /// Called after a checkpoint was written.
    fn checkpoint_done(&mut self) {}

    /// The pulse to which the chains report while they work, and which can stop them.
    fn pulse(&self) -> Arc<Pulse> {
        Arc::default()
    }

    /// Whether to keep in memory what [`Watch::mixing`] needs.
    fn looks_at_mixing(&self) -> bool {
        false
    }

    /// Whether to find out now how well the outcomes mix; asked after each round if [`Watch::looks_at_mixing`] returns
    /// true.
    fn mixing_due(&mut self) -> bool {
        false
    }

    /// Called with what was found; `None` if there is too little to tell.
    fn mixing(&mut self, _mixing: Option<Mixing>) {}

    /// Called repeatedly while another process writes the run that is to be continued; returns whether to wait.
    fn locked(&mut self, _folder: &Folder) -> bool {
        false
    }
}

/// Watches nothing: runs to the end, with a checkpoint after every round.
#[derive(Debug, Clone, Copy, Default)]
pub struct Unwatched;

impl Watch for Unwatched {
    fn round(&mut self, _: &Progress<'_>) -> Control {
        Control::Continue
    }
}

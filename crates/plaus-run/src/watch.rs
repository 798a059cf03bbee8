//! Watching a run while it is sampled.

use crate::folder::Folder;
use crate::gauge::Mixing;
use crate::manifest::Manifest;
use plaus_mcmc::{Control, Progress, Pulse};
use std::sync::Arc;

/// Watches a run while it is sampled, and may stop it.
pub trait Watch {
    /// Called before the first round, when each chain has already done `done` iterations.
    fn begin(&mut self, _manifest: &Manifest, _done: u64) {}

    /// Called after each round; returns whether to continue.
    fn round(&mut self, progress: &Progress<'_>) -> Control;

    /// Whether what was sampled since the last checkpoint is worth a new one. The final bytes do not depend on the
    /// answers, but the loss of a killed process does.
    fn checkpoint_due(&mut self) -> bool {
        true
    }

    /// Called after a checkpoint was written.
    fn checkpoint_done(&mut self) {}

    /// What the chains report to while they are at work, and are stopped by.
    fn pulse(&self) -> Arc<Pulse> {
        Arc::default()
    }

    /// Whether to keep, in memory, what [`Watch::mixing`] takes.
    fn looks_at_mixing(&self) -> bool {
        false
    }

    /// Whether to find out now how well the outcomes mix; asked after each round where [`Watch::looks_at_mixing`] says
    /// so.
    fn mixing_due(&mut self) -> bool {
        false
    }

    /// Called with what was found; `None` if there is too little to tell.
    fn mixing(&mut self, _mixing: Option<Mixing>) {}

    /// Called again and again while another process writes the run that is to be gone on with; says whether to wait.
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

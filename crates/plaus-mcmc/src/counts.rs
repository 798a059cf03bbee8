//! How iterations ended, and how often.

use serde::{Deserialize, Serialize};

/// How an iteration ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Decision {
    /// The move had nothing to change.
    Stayed,
    /// The candidate has prior density 0, or could not be undone: rejected before any simulation.
    RejectedByPrior,
    /// The simulation stopped early, certain to be rejected.
    RejectedEarly,
    /// Rejected after a whole simulation.
    Rejected,
    /// Accepted.
    Accepted,
}

/// How often a move ended in each way.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct MoveCounts {
    /// Iterations that had nothing to change.
    pub stayed: u64,
    /// Candidates of prior density 0.
    pub rejected_by_prior: u64,
    /// Candidates whose simulation stopped early.
    pub rejected_early: u64,
    /// Candidates rejected after a whole simulation.
    pub rejected: u64,
    /// Candidates accepted.
    pub accepted: u64,
}

impl MoveCounts {
    /// Iterations in which the move was made.
    #[must_use]
    pub fn made(&self) -> u64 {
        self.stayed + self.rejected_by_prior + self.rejected_early + self.rejected + self.accepted
    }

    /// Accepted share of the iterations in which the move was made, in [0, 1]; 0 if it never was.
    #[must_use]
    pub fn acceptance(&self) -> f64 {
        if self.made() == 0 { 0.0 } else { self.accepted as f64 / self.made() as f64 }
    }

    /// Adds another chain's counts.
    pub fn add(&mut self, other: &Self) {
        self.stayed += other.stayed;
        self.rejected_by_prior += other.rejected_by_prior;
        self.rejected_early += other.rejected_early;
        self.rejected += other.rejected;
        self.accepted += other.accepted;
    }

    /// The counts since `earlier`, an earlier state of these counts.
    #[must_use]
    pub fn since(&self, earlier: &Self) -> Self {
        Self {
            stayed: self.stayed - earlier.stayed,
            rejected_by_prior: self.rejected_by_prior - earlier.rejected_by_prior,
            rejected_early: self.rejected_early - earlier.rejected_early,
            rejected: self.rejected - earlier.rejected,
            accepted: self.accepted - earlier.accepted,
        }
    }

    pub(crate) fn count(&mut self, decision: Decision) {
        *match decision {
            Decision::Stayed => &mut self.stayed,
            Decision::RejectedByPrior => &mut self.rejected_by_prior,
            Decision::RejectedEarly => &mut self.rejected_early,
            Decision::Rejected => &mut self.rejected,
            Decision::Accepted => &mut self.accepted,
        } += 1;
    }
}

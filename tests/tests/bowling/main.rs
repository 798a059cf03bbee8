//! Bowling is sampled exactly: the prior is that of the paper's appendix A, every move leaves prior and target
//! invariant, and wrong twins of the moves do not.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

mod configuration;
mod mirror;
mod moves;
mod physics;
mod pins;
mod prior;
mod shots;
mod straight;
mod verdict;

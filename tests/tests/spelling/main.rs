//! The balls that spell are sampled exactly: the prior is that of the paper's appendix B, every move leaves prior and
//! target invariant, and wrong twins of the moves do not. Work that a simulation saves changes no bit.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

mod brute_force;
mod configuration;
mod drops;
mod moves;
mod prior;
mod savings;
mod straight;
mod twins;
mod watch;

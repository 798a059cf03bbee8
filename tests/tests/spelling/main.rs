//! The balls that spell are sampled exactly: the prior is what the paper's appendix B says, every move leaves prior and
//! target as they are, wrong twins of the moves do not, and what a simulation saves changes no bit.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

mod brute_force;
mod configuration;
mod moves;
mod prior;
mod savings;
mod straight;
mod twins;

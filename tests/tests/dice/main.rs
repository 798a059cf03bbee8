//! Dice on a random table are sampled exactly: the prior is what the configuration says, every move leaves prior and
//! target as they are, wrong twins of the moves do not, and a table made only where a die comes near gives the same
//! chain as one that is whole from the start.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

mod configuration;
mod lazy;
mod moves;
mod plain;
mod prior;
mod trips;
mod twins;

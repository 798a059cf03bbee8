//! Dice on a random table are sampled exactly. The prior is that of the configuration; every move leaves prior and
//! target invariant, and wrong twins of the moves do not. A table that is made only where a die comes near gives the
//! same chain as a table that is whole from the start.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

mod configuration;
mod lazy;
mod moves;
mod plain;
mod prior;
mod trips;
mod twins;

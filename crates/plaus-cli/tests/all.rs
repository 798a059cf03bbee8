//! All tests of the command from outside, as one program.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

mod common;

mod accuracy;
mod adapting;
mod animations;
mod bad_input;
mod chance;
mod every_format;
mod everyday;
mod failing_draws;
mod first_hour;
#[cfg(unix)]
mod jobs;
mod jobs_of_chances;
mod moving;
mod mutated;
mod output;
mod own_shapes;
#[cfg(unix)]
mod physics;
mod pictures;
mod pieces;
#[cfg(unix)]
mod same_bytes;
mod tempering;
mod usd;
mod while_adapting;

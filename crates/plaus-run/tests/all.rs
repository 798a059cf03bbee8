//! All tests of runs from outside, as one program.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

mod common;

mod beside;
mod damaged;
mod killed;
mod merged;
mod mixing;
mod refused;
mod ways;

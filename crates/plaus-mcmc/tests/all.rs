//! All tests of the sampler from outside, as one program.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

mod toys;
mod weigh;

mod adapt;
mod arviz_reference;
mod chance;
mod check_balls;
mod check_ring;
mod check_vertices;
mod diagnose_properties;
mod engine_chain;
mod engine_run;
mod failing;
mod hidden;
mod independent;
mod learned;
mod library;
mod replicas;

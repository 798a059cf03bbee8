//! A chain with all savings, beside its twin that simulates every candidate from scratch: they have the same states,
//! bit by bit, for as many iterations as asked.
//!
//!     cargo run --release -p plaus-scenes --example spelling_twin -- scenarios/spelling-hi.toml 100000 [key=value ...]
#![allow(clippy::print_stdout, reason = "a checking program: it prints")]

use plaus_dist::Seed;
use plaus_mcmc::check::early_exit;
use plaus_scenes::spelling::Spelling;
use plaus_scenes::{Scenario, Scene, World};
use std::sync::Arc;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut args = std::env::args().skip(1);
    let path = args.next().unwrap_or_else(|| "scenarios/spelling-hi.toml".into());
    let iterations: u64 = args.next().map_or(Ok(200), |text| text.parse())?;
    let overrides: Vec<String> = args.collect();
    let scenario = Scenario::read(&path, &std::fs::read_to_string(&path)?, &overrides)?;
    let World::Spelling(config) = &scenario.world else { return Err("this checks words only".into()) };
    let scene = Spelling::new(config)?;
    let moves = Arc::new(scene.moves(&scenario.sampler.rules)?);
    let report = early_exit(&scene, moves, Seed(scenario.sampler.seed), iterations)?;
    println!("{path} {overrides:?}: {report}");
    if report.passed() { Ok(()) } else { Err("the savings changed a state".into()) }
}

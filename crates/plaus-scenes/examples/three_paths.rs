//! Three ways in which a ball can come to rest where it should:
//! `cargo run -p plaus-scenes --example three_paths [SCENARIO]`.

use plaus_dist::Seed;
use plaus_mcmc::{Chain, Goal};
use plaus_scenes::ball2d::Ball2d;
use plaus_scenes::scenario::{ScenarioError, template};
use plaus_scenes::{Scenario, Scene, World};
use std::error::Error;

/// Number of ways looked for.
const WANTED: usize = 3;
/// Iterations between two looks, because neighbouring states of a chain are alike.
const STRIDE: u64 = 100;
/// Iterations within which the ways must be found.
const PATIENCE: u64 = 100_000;

fn main() -> Result<(), Box<dyn Error>> {
    let (name, text) = match std::env::args().nth(1) {
        Some(path) => (path.clone(), ScenarioError::decode(&path, std::fs::read(&path)?)?),
        None => ("the default".into(), template("ball2d").unwrap_or_default()),
    };
    let scenario = Scenario::read(&name, &text, &[])?;
    #[allow(irrefutable_let_patterns, reason = "there may be more scenes some day")]
    let World::Ball2d(config) = &scenario.world else { return Err("this example draws paths of ball2d only".into()) };

    let ball = Ball2d::new(config)?;
    let moves = ball.moves(&scenario.sampler.rules)?;
    let mut chain = Chain::start(&ball, &moves, Seed(scenario.sampler.seed).chain(0))?;
    let mut seen = Vec::new();
    while seen.len() < WANTED && chain.iteration() < PATIENCE {
        for _ in 0..STRIDE {
            chain.step()?;
        }
        let Some(class) = ball.class(chain.state().by_ref()).filter(|class| !seen.contains(class)) else { continue };
        seen.push(class);
        show(&ball, &chain);
    }
    Ok(())
}

#[allow(clippy::print_stdout, reason = "an example talks to its reader")]
fn show(ball: &Ball2d, chain: &Chain<'_, Ball2d>) {
    let list = |values: &[f64]| values.iter().map(|value| format!("{value:7.2}")).collect::<String>();
    let state = chain.state();
    println!("iteration {}, log p = {:.2}", chain.iteration(), state.log_p().value());
    println!("  bounces and rest at x/D:  {}", list(&ball.path(&state.draw)));
    println!("  normals lean by degrees:  {}", list(&state.draw.0));
}

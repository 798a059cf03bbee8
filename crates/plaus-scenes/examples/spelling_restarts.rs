//! How often parallel tempering restarts a word from a fresh draw of the prior, and how many full words come of it.
//!
//!     cargo run --release -p plaus-scenes --example spelling_restarts -- scenarios/spelling-hi.toml 8 20 60 [key=value ...]
//!
//! with 8 rungs, 20 iterations between swaps, for 60 seconds of one core.
#![allow(clippy::print_stdout, reason = "a measuring program: it prints")]

mod shared;

use plaus_dist::Seed;
use plaus_mcmc::view::lend;
use plaus_mcmc::{Goal, Ladder, Mixture, Replicas, SolutionClass, Tempered};
use plaus_scenes::spelling::{ChangeAll, Spelling};
use plaus_scenes::{Rules, Scenario, Scene, World};
use shared::seconds;
use std::collections::BTreeSet;
use std::sync::Arc;

type Result<T> = std::result::Result<T, Box<dyn std::error::Error + Send + Sync>>;
type Rung<'a> = Tempered<'a, Spelling>;

fn rungs<'a>(scene: &'a Spelling, ladder: &Ladder) -> Result<(Vec<Rung<'a>>, Vec<Mixture<Rung<'a>>>)> {
    let moves = Arc::new(scene.moves(&Rules::exact())?);
    let fresh: Arc<Mixture<Spelling>> = Arc::new(Mixture::of(Box::new(ChangeAll::default())));
    let lent = |&beta: &f64| Ok(lend::<Rung<'a>>(Arc::clone(if beta == 0.0 { &fresh } else { &moves }))?);
    let rungs = ladder.betas().iter().map(|&beta| Ok(Tempered::new(scene, beta)?)).collect::<Result<_>>()?;
    Ok((rungs, ladder.betas().iter().map(lent).collect::<Result<_>>()?))
}

/// A ladder spaced by what a few short runs reject.
fn adapt(scene: &Spelling, count: usize, iterations: u64, seed: u64) -> Result<Ladder> {
    let mut ladder = Ladder::even(count);
    for pass in 0..4_u64 {
        let (rungs, moves) = rungs(scene, &ladder)?;
        let mut replicas = Replicas::start(&rungs, &moves, Seed(seed), 1000 * (pass + 1))?;
        for _ in 0..(50 << pass) {
            replicas.round(iterations)?;
        }
        let rejected = replicas.rejected();
        println!("pass {pass}: barrier {:.2}, rejected {rejected:.2?}", Ladder::barrier(&rejected));
        ladder = ladder.adapted(&rejected, count);
    }
    Ok(ladder)
}

fn measure(scene: &Spelling, [count, iterations, limit]: [u64; 3], seed: u64) -> Result<()> {
    let ladder = adapt(scene, count as usize, iterations, seed)?;
    println!("ladder {:.4?}", ladder.betas());
    let (rungs, moves) = rungs(scene, &ladder)?;
    let begin = seconds();
    let mut replicas = Replicas::start(&rungs, &moves, Seed(seed), 0)?;
    let (mut distinct, mut full) = (BTreeSet::<SolutionClass>::new(), 0_u64);
    // Restarts of which a full word came before the next one.
    let (mut restarts, mut pending, mut fruitful) = (0, false, 0_u64);
    while seconds() - begin < limit as f64 {
        replicas.round(iterations)?;
        if replicas.restarts() > restarts {
            (restarts, pending) = (replicas.restarts(), true);
        }
        // A rung's state is one of the scene, but for the weight of its constraint.
        let class = replicas.top().and_then(|state| scene.class(state));
        if let Some(class) = class {
            full += 1;
            distinct.insert(class);
            fruitful += u64::from(std::mem::take(&mut pending));
        }
    }
    let minutes = (seconds() - begin) / 60.0;
    let rejected = replicas.rejected();
    println!("{} rounds, rejected {rejected:.2?}, barrier {:.2}", replicas.rounds(), Ladder::barrier(&rejected));
    println!(
        "restarts a minute {:.1}, round trips {:.1}",
        restarts as f64 / minutes,
        replicas.round_trips() as f64 / minutes
    );
    println!(
        "restarts a minute that brought a full word {:.1}; distinct full words at the end of a round, a minute {:.0}; share full {:.3}",
        fruitful as f64 / minutes,
        distinct.len() as f64 / minutes,
        full as f64 / replicas.rounds() as f64
    );
    Ok(())
}

fn main() -> Result<()> {
    let mut args = std::env::args().skip(1);
    let path = args.next().unwrap_or_else(|| "scenarios/spelling-hi.toml".into());
    let mut number = |default| args.next().map_or(Ok(default), |text| text.parse::<u64>());
    let numbers = [number(8)?, number(20)?, number(2)?];
    let overrides: Vec<String> = args.collect();
    let scenario = Scenario::read(&path, &std::fs::read_to_string(&path)?, &overrides)?;
    let World::Spelling(config) = &scenario.world else { return Err("this measures words only".into()) };
    let scene = Spelling::new(config)?;
    // One core: replicas take turns.
    rayon::ThreadPoolBuilder::new().num_threads(1).build()?.install(|| measure(&scene, numbers, scenario.sampler.seed))
}

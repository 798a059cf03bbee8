//! How often parallel tempering restarts a word from a fresh draw of the prior, and how many full words come of it.
//!
//!     cargo run --release -p plaus-scenes --example spelling_restarts -- \
//!         scenarios/spelling-hi.toml 8 20 60 [key=value ...]
//!
//! with 8 rungs, 20 iterations between swaps, for 60 seconds of one core after a warm-up of 6,000 iterations.
#![allow(clippy::print_stdout, reason = "a measuring program: it prints")]

mod shared;

use plaus_dist::Seed;
use plaus_mcmc::{Course, Goal, Ladder, Mixture, Redraw, Replicas, SolutionClass, Tempering};
use plaus_scenes::spelling::Spelling;
use plaus_scenes::{Rules, Scenario, Scene, World};
use shared::seconds;
use std::collections::BTreeSet;

type Result<T> = std::result::Result<T, Box<dyn std::error::Error + Send + Sync>>;

fn measure(scene: &Spelling, [rungs, every, limit]: [u64; 3], seed: u64) -> Result<()> {
    // The quick run of the tests adapts little; it has no time.
    let warmup = if limit < 10 { 400 } else { 6_000 };
    let (moves, fresh) = (scene.moves(&Rules::exact())?, Mixture::of(Box::new(Redraw)));
    let tempering = Tempering { rungs: rungs as u32, swap_every: every, warmup };
    let course = Course { target: scene, moves: &moves, fresh: &fresh, tempering };
    let mut replicas = Replicas::start(course, Seed(seed), 0)?;
    replicas.advance(warmup + 1, |_, _| ())?;
    println!("ladder {:.4?}", replicas.climb().ladder().betas());
    let begin = seconds();
    let (mut distinct, mut full, mut iterations) = (BTreeSet::<SolutionClass>::new(), 0_u64, 0_u64);
    // Restarts of which a full word came before the next one.
    let (mut restarts, mut pending, mut fruitful) = (0, false, 0_u64);
    while seconds() - begin < limit as f64 {
        replicas.advance(replicas.iteration() + every, |chain, _| {
            iterations += 1;
            if let Some(class) = scene.class(chain.state()) {
                full += 1;
                distinct.insert(class);
                fruitful += u64::from(std::mem::take(&mut pending));
            }
        })?;
        if replicas.climb().restarts() > restarts {
            (restarts, pending) = (replicas.climb().restarts(), true);
        }
    }
    let minutes = (seconds() - begin) / 60.0;
    let climb = replicas.climb();
    let rejected = climb.rejected();
    println!("{iterations} iterations, rejected {rejected:.2?}, barrier {:.2}", Ladder::barrier(&rejected));
    println!(
        "restarts a minute {:.1}, round trips {:.1}",
        restarts as f64 / minutes,
        climb.round_trips() as f64 / minutes
    );
    println!(
        "restarts a minute that brought a full word before the next {:.1}; distinct full words a minute {:.0}; share full {:.3}",
        fruitful as f64 / minutes,
        distinct.len() as f64 / minutes,
        full as f64 / iterations as f64
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

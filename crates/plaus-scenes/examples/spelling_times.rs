//! How long words take: time an iteration, to the first full word, and distinct full words a minute, over some seeds.
//! Times are those of one core.
//!
//!     cargo run --release -p plaus-scenes --example spelling_times -- \
//!         scenarios/spelling-hi.toml 20 20000 [key=value ...]
#![allow(clippy::print_stdout, reason = "a measuring program: it prints")]

mod shared;

use plaus_dist::Seed;
use plaus_mcmc::{Chain, Goal, Mixture, MoveCounts, SolutionClass};
use plaus_scenes::spelling::{Savings, Spelling};
use plaus_scenes::{Scenario, Scene, World};
use shared::seconds;
use std::collections::BTreeSet;

type Result<T> = std::result::Result<T, Box<dyn std::error::Error>>;

#[derive(Default)]
struct Run {
    /// Iteration and second of the first full word.
    first: Option<(u64, f64)>,
    seconds: f64,
    full: u64,
    classes: BTreeSet<SolutionClass>,
    counts: Vec<MoveCounts>,
    /// Every hundredth state's bins, from the first full word on.
    bins: Vec<Vec<Option<u16>>>,
}

/// Share of balls in one bin both before and `lag` hundreds of iterations later, among those in a bin before, over all
/// such pairs of states.
fn overlap(runs: &[Run], lag: usize) -> f64 {
    let (mut same, mut all) = (0_u64, 0_u64);
    for pair in runs.iter().flat_map(|run| run.bins.iter().zip(run.bins.iter().skip(lag))) {
        for (before, after) in pair.0.iter().zip(pair.1).filter(|(before, _)| before.is_some()) {
            (same, all) = (same + u64::from(before == after), all + 1);
        }
    }
    same as f64 / all as f64
}

fn run(scene: &Spelling, moves: &Mixture<Spelling>, seed: u64, iterations: u64) -> Result<Run> {
    let begin = seconds();
    let mut chain = Chain::start(scene, moves, Seed(seed).chain(0))?;
    let mut run = Run::default();
    for iteration in 1..=iterations {
        chain.step()?;
        if run.first.is_some() && iteration.is_multiple_of(100) {
            run.bins.push(chain.state().outcome.bins.clone());
        }
        let Some(class) = scene.class(chain.state()) else { continue };
        run.first.get_or_insert_with(|| (iteration, seconds() - begin));
        run.full += 1;
        run.classes.insert(class);
    }
    run.seconds = seconds() - begin;
    run.counts = chain.counts().to_vec();
    Ok(run)
}

fn quantile(sorted: &[f64], q: f64) -> f64 {
    sorted.get(((sorted.len() as f64 * q).ceil() as usize).saturating_sub(1)).copied().unwrap_or(f64::NAN)
}

fn main() -> Result<()> {
    let mut args = std::env::args().skip(1);
    let path = args.next().unwrap_or_else(|| "scenarios/spelling-hi.toml".into());
    let seeds: u64 = args.next().map_or(Ok(2), |text| text.parse())?;
    let iterations: u64 = args.next().map_or(Ok(500), |text| text.parse())?;
    let (flags, overrides): (Vec<String>, Vec<String>) = args.partition(|arg| arg == "--plain");
    let scenario = Scenario::read(&path, &std::fs::read_to_string(&path)?, &overrides)?;
    let World::Spelling(config) = &scenario.world else { return Err("this measures words only".into()) };
    let scene = Spelling::new(config)?.with_savings(if flags.is_empty() { Savings::ALL } else { Savings::NONE });
    let moves = scene.moves(&scenario.sampler.rules)?;
    let runs: Vec<Run> = (0..seeds).map(|seed| run(&scene, &moves, seed, iterations)).collect::<Result<_>>()?;
    let sorted = |value: &dyn Fn(&Run) -> f64| {
        let mut values: Vec<f64> = runs.iter().map(value).collect();
        values.sort_by(f64::total_cmp);
        values
    };
    let first = sorted(&|run| run.first.map_or(f64::INFINITY, |first| first.1));
    let when = sorted(&|run| run.first.map_or(f64::INFINITY, |first| first.0 as f64));
    let whole = sorted(&|run| run.seconds);
    let share = sorted(&|run| run.full as f64 / iterations as f64);
    let distinct = sorted(&|run| 60.0 * run.classes.len() as f64 / run.seconds);
    println!("{seeds} seeds of {iterations} iterations, {overrides:?}");
    println!("{iterations} iterations: median {:.2} s, worst {:.2} s", quantile(&whole, 0.5), quantile(&whole, 1.0));
    for (what, values) in [("s", &first), ("iterations", &when)] {
        let at = |q| quantile(values, q);
        println!(
            "first full word, {what}: median {:.4}, 90% {:.4}, 95% {:.4}, worst {:.4}",
            at(0.5),
            at(0.9),
            at(0.95),
            at(1.0)
        );
    }
    println!(
        "full iterations: median {:.3}; distinct full words a minute: median {:.0}, least {:.0}",
        quantile(&share, 0.5),
        quantile(&distinct, 0.5),
        quantile(&distinct, 0.0)
    );
    let overlaps = [1, 10, 100].map(|lag| overlap(&runs, lag));
    println!("balls still or again in their bins after 100, 1,000, 10,000 iterations: {overlaps:.3?}");
    for (index, name) in moves.names().iter().enumerate() {
        let mut all = MoveCounts::default();
        runs.iter().for_each(|run| all.add(&run.counts[index]));
        println!(
            "  {name:<16} made {:>8}, stayed {:>7}, early {:>7}, accepted {:.3}",
            all.made(),
            all.stayed,
            all.rejected_early,
            all.acceptance()
        );
    }
    Ok(())
}

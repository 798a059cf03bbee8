//! The effect of adapting scales in the warm-up: the same scenario without and with it, seed after seed, on one core.
//!
//!     cargo run --release -p plaus-scenes --example adapted -- scenarios/dice-one.toml 8 2000 10000 [key=value ...]
//!
//! Arguments: scenario, seeds, iterations of the warm-up and after it. Effective draws are computed over all seeds
//! together, so that chains that disagree count little. They are given for the outcomes; for the draw's variables, only
//! the median and the smallest. Times are processor time of this thread after the warm-up.
#![allow(clippy::print_stdout, reason = "a measuring program: it prints")]

mod shared;

use plaus_dist::Seed;
use plaus_mcmc::{Chain, Mixture, MoveCounts, MoveId, SolutionClass, diagnose};
use plaus_scenes::{Role, Scenario, Scene, Stage};
use shared::seconds;
use std::collections::BTreeSet;

type Result<T> = std::result::Result<T, Box<dyn std::error::Error>>;

struct Measure {
    scenario: Scenario,
    seeds: u64,
    warmup: u64,
    iterations: u64,
}

/// The results of all seeds.
struct Made {
    seconds: f64,
    /// Number of distinct solutions for each seed.
    distinct: Vec<usize>,
    satisfied: u64,
    /// For each scalar and each seed.
    columns: Vec<Vec<Vec<f64>>>,
    counts: Vec<MoveCounts>,
}

fn sorted(mut values: Vec<f64>) -> Vec<f64> {
    values.sort_by(f64::total_cmp);
    values
}

impl Measure {
    fn make<S: Scene>(&self, scene: &S, moves: &Mixture<S>, adapts: bool) -> Result<Made> {
        let width = scene.scalars().len();
        let counts = vec![MoveCounts::default(); moves.names().len()];
        let mut made =
            Made { seconds: 0.0, distinct: Vec::new(), satisfied: 0, columns: vec![Vec::new(); width], counts };
        let mut values = vec![0.0; width];
        for seed in 0..self.seeds {
            let until = if adapts { self.warmup } else { 0 };
            let mut chain = Chain::start(scene, moves, Seed(seed).chain(0))?.adapting(until);
            for _ in 1..self.warmup {
                chain.step()?;
            }
            let (before, begin) = (chain.counts().to_vec(), seconds());
            let (mut classes, mut rows) = (BTreeSet::<SolutionClass>::new(), vec![Vec::new(); width]);
            for _ in 0..self.iterations {
                chain.step()?;
                scene.write_scalars(chain.state().by_ref(), &mut values);
                rows.iter_mut().zip(&values).for_each(|(row, value)| row.push(*value));
                let class = scene.class(chain.state().by_ref());
                made.satisfied += u64::from(class.is_some());
                classes.extend(class);
            }
            made.seconds += seconds() - begin;
            made.distinct.push(classes.len());
            made.columns.iter_mut().zip(rows).for_each(|(column, row)| column.push(row));
            for ((sum, now), before) in made.counts.iter_mut().zip(chain.counts()).zip(&before) {
                sum.add(&now.since(before));
            }
            if let Some(scales) = chain.scales().filter(|_| seed < 3) {
                show(moves, scales, seed);
            }
        }
        Ok(made)
    }
}

/// Prints scales, and the share accepted at each.
fn show<S: Scene>(moves: &Mixture<S>, scales: &plaus_mcmc::Scales, seed: u64) {
    print!("  seed {seed}:");
    for (id, (_, kernel)) in (0..).map(MoveId).zip(moves.iter()) {
        for ((scale, value), adapted) in kernel.scales().iter().zip(scales.values(id)).zip(scales.adapted(id)) {
            let share = adapted.accepted() as f64 / adapted.tried().max(1) as f64;
            let value = value.map_or("as configured".to_owned(), |value| format!("{value:.2e}"));
            print!(" {} {} {value} ({share:.2})", kernel.name(), scale.name);
        }
    }
    println!();
}

impl Measure {
    fn of(&self, scene: &Stage) -> Result<()> {
        let moves = scene.moves(&self.scenario.sampler.rules)?;
        for adapts in [false, true] {
            println!("{}", if adapts { "with adaptation" } else { "without adaptation" });
            let made = self.make(scene, &moves, adapts)?;
            let per_second = |column: &Vec<Vec<f64>>| diagnose::ess_bulk(column).unwrap_or(f64::NAN) / made.seconds;
            let (mut draws, mut text) = (Vec::new(), String::new());
            for (scalar, column) in scene.scalars().iter().zip(&made.columns) {
                match scalar.role {
                    Role::Draw => draws.push(per_second(column)),
                    Role::Outcome => text += &format!(" {} {:.1}", scalar.name, per_second(column)),
                    Role::Detail => {}
                }
            }
            let (draws, total) = (sorted(draws), made.distinct.iter().sum::<usize>());
            println!(
                "  {:.2} s; effective draws a second:{text}; of the draw: median {:.2}, least {:.2}",
                made.seconds,
                draws[draws.len() / 2],
                draws[0]
            );
            let share = made.satisfied as f64 / (self.seeds * self.iterations) as f64;
            println!(
                "  distinct solutions a minute: {:.0}; satisfying: {share:.3}; distinct per seed {:?}",
                60.0 * total as f64 / made.seconds,
                made.distinct
            );
            let shares = moves.names().into_iter().zip(&made.counts);
            let shares: Vec<String> = shares.map(|(name, count)| format!("{name} {:.3}", count.acceptance())).collect();
            println!("  accepted: {}", shares.join(", "));
        }
        Ok(())
    }
}

fn main() -> Result<()> {
    let mut args = std::env::args().skip(1);
    let path = args.next().unwrap_or_else(|| "scenarios/dice-one.toml".into());
    let mut number = |default| args.next().map_or(Ok(default), |text| text.parse());
    let (seeds, warmup, iterations) = (number(4)?, number(1000)?, number(4000)?);
    let overrides: Vec<String> = args.collect();
    let scenario = Scenario::read(&path, &std::fs::read_to_string(&path)?, &overrides)?;
    println!("{path}, {overrides:?}: {seeds} seeds, {warmup} + {iterations} iterations");
    let scene = scenario.stage()?;
    Measure { scenario, seeds, warmup, iterations }.of(&scene)
}

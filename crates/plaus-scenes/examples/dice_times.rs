//! How long dice take: time per throw and per iteration, time to the first solution, distinct solutions per minute, and
//! R-hat over the seeds. Times are those of one core.
//!
//!     cargo run --release -p plaus-scenes --example dice_times -- \
//!         scenarios/dice-one.toml 20 20000 [key=value ...] [--first]
//!
//! With `--first` each seed stops at its first solution.
#![allow(clippy::print_stdout, reason = "a measuring program: it prints")]

mod shared;

use plaus_dist::{Purpose, Seed};
use plaus_mcmc::diagnose::rhat;
use plaus_mcmc::{Chain, Goal, Mixture, MoveCounts, SolutionClass, State, Target};
use plaus_scenes::dice::{Dice, End, Work};
use plaus_scenes::{Scenario, Scene, World};
use shared::seconds;
use std::collections::BTreeSet;

type Result<T> = std::result::Result<T, Box<dyn std::error::Error>>;

#[derive(Default)]
struct Run {
    /// Iteration and second of the first solution.
    first: Option<(u64, f64)>,
    seconds: f64,
    satisfied: u64,
    /// Largest number of constraints met at once.
    most: usize,
    classes: BTreeSet<SolutionClass>,
    counts: Vec<MoveCounts>,
    /// The scalars of every tenth state of the second half.
    columns: Vec<Vec<f64>>,
    changed: usize,
}

fn run(scene: &Dice, moves: &Mixture<Dice>, seed: u64, iterations: u64, stops: bool) -> Result<Run> {
    let names = scene.scalars().len();
    let begin = seconds();
    let mut chain = Chain::start(scene, moves, Seed(seed).chain(0))?;
    let mut run = Run { columns: vec![Vec::new(); names], ..Run::default() };
    let mut values = vec![0.0; names];
    for iteration in 1..=iterations {
        chain.step()?;
        if iteration > iterations / 2 && iteration.is_multiple_of(10) {
            scene.write_scalars(chain.state().by_ref(), &mut values);
            run.columns.iter_mut().zip(&values).for_each(|(column, value)| column.push(*value));
        }
        run.most = run.most.max(chain.state().outcome.marks.iter().filter(|mark| mark.met).count());
        let Some(class) = scene.class(chain.state().by_ref()) else { continue };
        run.first.get_or_insert_with(|| (iteration, seconds() - begin));
        run.satisfied += 1;
        run.classes.insert(class);
        if stops {
            break;
        }
    }
    run.seconds = seconds() - begin;
    run.counts = chain.counts().to_vec();
    println!("seed {seed}: first solution {:?} (iteration, s), {:.1} s in all", run.first, run.seconds);
    run.changed = chain.state().draw.tables.iter().map(|table| table.changed()).sum();
    Ok(run)
}

fn quantile(sorted: &[f64], q: f64) -> f64 {
    sorted.get(((sorted.len() as f64 * q).ceil() as usize).saturating_sub(1)).copied().unwrap_or(f64::NAN)
}

fn sorted(mut values: Vec<f64>) -> Vec<f64> {
    values.sort_by(f64::total_cmp);
    values
}

/// Throws from the prior: time, how they end, and the spread of where they come to rest.
fn throws(scene: &Dice, count: usize) -> Result<()> {
    let mut stream = Seed(1).chain(0).at(0, Purpose::START);
    let mut work = Work::default();
    let (mut times, mut ends, mut met, mut impacts) = (Vec::new(), [0_u64; 3], 0_u64, 0);
    let (mut x, mut y, mut last) = (Vec::new(), Vec::new(), Vec::new());
    let mut faces = [0_u64; 7];
    for _ in 0..count {
        let draw = scene.start(&mut stream);
        if scene.log_prior(&draw)?.is_zero() {
            continue;
        }
        let begin = seconds();
        let state = State::evaluate(scene, draw, &mut work)?;
        times.push((seconds() - begin) / scene.config().dice as f64);
        for trip in &state.outcome.trips {
            ends[match trip.end {
                End::AtRest => 0,
                End::Left => 1,
                End::Unfinished => 2,
            }] += 1;
            met += u64::from(trip.met);
            impacts += trip.impacts.len();
            x.push(trip.position.x * 1e3);
            y.push(trip.position.y * 1e3);
            last.push(trip.time);
        }
        state.outcome.faces.iter().for_each(|face| faces[usize::from(*face)] += 1);
    }
    let (times, x, y, last) = (sorted(times), sorted(x), sorted(y), sorted(last));
    let at = |values: &[f64]| [0.05, 0.5, 0.95].map(|q| quantile(values, q));
    // The clock's ticks are longer than a throw.
    println!(
        "{} draws of the prior: {:.1} µs a die in the mean",
        times.len(),
        1e6 * times.iter().sum::<f64>() / times.len() as f64
    );
    println!(
        "  at rest, left, unfinished {ends:?}; met another {met}; impacts {:.1}; faces {faces:?}",
        impacts as f64 / (count as f64 * f64::from(scene.config().dice))
    );
    println!("  rest x {:.0?} mm, y {:.0?} mm, after {:.2?} s", at(&x), at(&y), at(&last));
    Ok(())
}

fn main() -> Result<()> {
    let mut args = std::env::args().skip(1);
    let path = args.next().unwrap_or_else(|| "scenarios/dice-one.toml".into());
    let seeds: u64 = args.next().map_or(Ok(2), |text| text.parse())?;
    let iterations: u64 = args.next().map_or(Ok(300), |text| text.parse())?;
    let (flags, overrides): (Vec<String>, Vec<String>) = args.partition(|arg| arg == "--first");
    let stops = !flags.is_empty();
    let scenario = Scenario::read(&path, &std::fs::read_to_string(&path)?, &overrides)?;
    let World::Dice(config) = &scenario.world else { return Err("this measures dice only".into()) };
    let scene = Dice::new(config)?;
    let moves = scene.moves(&scenario.sampler.rules)?;
    throws(&scene, (iterations as usize / 10).clamp(20, 2000))?;
    let runs: Vec<Run> = (0..seeds).map(|seed| run(&scene, &moves, seed, iterations, stops)).collect::<Result<_>>()?;
    let of = |value: &dyn Fn(&Run) -> f64| sorted(runs.iter().map(value).collect());
    let first = of(&|run| run.first.map_or(f64::INFINITY, |first| first.1));
    let when = of(&|run| run.first.map_or(f64::INFINITY, |first| first.0 as f64));
    let whole = of(&|run| run.seconds);
    let share = of(&|run| run.satisfied as f64 / iterations as f64);
    let distinct = of(&|run| 60.0 * run.classes.len() as f64 / run.seconds);
    println!("{seeds} seeds of {iterations} iterations, {overrides:?}");
    println!("{iterations} iterations: median {:.2} s, worst {:.2} s", quantile(&whole, 0.5), quantile(&whole, 1.0));
    for (what, values) in [("s", &first), ("iterations", &when)] {
        println!(
            "first solution, {what} (50, 90, 95, 100%): {:.4?}",
            [0.5, 0.9, 0.95, 1.0].map(|q| quantile(values, q))
        );
    }
    println!(
        "solutions among iterations: median {:.3}; distinct solutions a minute: median {:.0}, least {:.0}; most constraints met {:?}",
        quantile(&share, 0.5),
        quantile(&distinct, 0.5),
        quantile(&distinct, 0.0),
        runs.iter().map(|run| run.most).collect::<Vec<_>>()
    );
    println!("changed control points at the end: {:?}", runs.iter().map(|run| run.changed).collect::<Vec<_>>());
    for (k, scalar) in scene.scalars().iter().enumerate() {
        let columns: Vec<&[f64]> = runs.iter().map(|run| run.columns[k].as_slice()).collect();
        if let Ok(Some(rhat)) = rhat(&columns) {
            print!("{} {rhat:.3}, ", scalar.name);
        }
    }
    println!("R-hat over the seeds");
    for (index, name) in moves.names().iter().enumerate() {
        let mut all = MoveCounts::default();
        runs.iter().for_each(|run| all.add(&run.counts[index]));
        let (early, prior) = (all.rejected_early, all.rejected_by_prior);
        println!(
            "  {name:<12} made {:>8}, early {early:>7}, prior {prior:>6}, accepted {:.3}",
            all.made(),
            all.acceptance()
        );
    }
    Ok(())
}

//! The cost of an iteration of the 2D ball, and where the time goes: `cargo bench -p plaus-benches --bench ball2d`.
//!
//! `run` is the whole engine with all bookkeeping: counts, hits, classes of solutions, records. Its parts are timed on
//! the draws of a real chain. The last lines give iterations per second and the simulator's share, from one process, so
//! that a busy machine slows all of them.
#![allow(missing_docs, clippy::print_stdout, clippy::disallowed_methods, clippy::unwrap_used)]

use criterion::{Criterion, Throughput, criterion_group};
use plaus_dist::{LogPotential, Seed};
use plaus_mcmc::{Block, Chain, Control, Mixture, Plan, Progress, Sink, Snapshot, Target, run};
use plaus_scenes::ball2d::{Ball2d, Config, Normals, Rest};
use plaus_scenes::{Moves, Rules, Scene};
use std::convert::Infallible;
use std::hint::black_box;
use std::time::Instant;

const ITERATIONS: u64 = 100_000;

/// Accepts everything and keeps nothing.
struct Drop;

impl Sink<Normals, Rest> for Drop {
    type Error = Infallible;
    fn block(&mut self, _: u32, block: Block<Normals, Rest>, _: &Snapshot<Normals, Rest>) -> Result<(), Infallible> {
        black_box(block);
        Ok(())
    }
    fn round(&mut self, _: &Progress<'_>) -> Result<Control, Infallible> {
        Ok(Control::Continue)
    }
}

fn scene(moves: Moves) -> (Ball2d, Mixture<Ball2d>) {
    let scene = Ball2d::new(&Config { moves, ..Config::default() }).unwrap();
    let moves = scene.moves(&Rules::exact()).unwrap();
    (scene, moves)
}

fn sample(scene: &Ball2d, moves: &Mixture<Ball2d>) {
    let plan = Plan {
        seed: Seed(1),
        chains: 1,
        warmup: 0,
        iterations: ITERATIONS,
        thin: 1,
        block: 20_000,
        solutions: None,
        rungs: 1,
        adapt_rungs: false,
        swap_every: 1,
        adapt: false,
        weigh: false,
        settle: false,
        climbs: 0,
        sampled: false,
    };
    run(scene, moves, plan, Vec::new(), 1, &mut Drop).unwrap();
}

/// The draws around which a chain of the paper's move proposes.
fn draws() -> Vec<Normals> {
    let (scene, moves) = scene(Moves::Paper);
    let mut chain = Chain::start(&scene, &moves, Seed(1).chain(0)).unwrap();
    (0..1000)
        .map(|_| {
            (0..20).for_each(|_| {
                chain.step().unwrap();
            });
            chain.state().draw.clone()
        })
        .collect()
}

fn benches(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("run");
    group.sample_size(20).throughput(Throughput::Elements(ITERATIONS));
    for (name, kind) in [("paper", Moves::Paper), ("mixed", Moves::Mixed)] {
        let (scene, moves) = scene(kind);
        group.bench_function(name, |bencher| bencher.iter(|| sample(&scene, &moves)));
    }
    group.finish();
    let (scene, draws) = (scene(Moves::Paper).0, draws());
    let mut group = criterion.benchmark_group("parts");
    group.throughput(Throughput::Elements(draws.len() as u64));
    group.bench_function("simulate", |bencher| bencher.iter(|| simulate(&scene, &draws)));
    group.bench_function("log_prior", |bencher| {
        bencher.iter(|| draws.iter().map(|draw| scene.log_prior(draw).unwrap().value()).sum::<f64>());
    });
    group.finish();
}

fn simulate(scene: &Ball2d, draws: &[Normals]) {
    for draw in draws {
        black_box(scene.simulate(black_box(draw), None, LogPotential::ZERO, &mut ()).unwrap());
    }
}

/// Nanoseconds for each of the `count` things that a call of `work` handles: the smallest of ten measurements.
fn nanoseconds(count: usize, mut work: impl FnMut()) -> f64 {
    let once = |work: &mut dyn FnMut()| {
        let start = Instant::now();
        work();
        start.elapsed().as_secs_f64()
    };
    (0..10).map(|_| once(&mut work)).fold(f64::INFINITY, f64::min) * 1e9 / count as f64
}

fn summary() {
    let draws = draws();
    for (name, kind) in [("paper", Moves::Paper), ("mixed", Moves::Mixed)] {
        let (scene, moves) = scene(kind);
        let iteration = nanoseconds(ITERATIONS as usize, || sample(&scene, &moves));
        let simulation = nanoseconds(100 * draws.len(), || (0..100).for_each(|_| simulate(&scene, &draws)));
        println!(
            "{name}: {iteration:.0} ns an iteration, {:.2} million a second; one simulation {simulation:.0} ns, {:.0}% of it",
            1e3 / iteration,
            100.0 * simulation / iteration
        );
    }
}

criterion_group!(group, benches);

fn main() {
    group();
    summary();
    Criterion::default().configure_from_args().final_summary();
}

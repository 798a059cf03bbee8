//! What a simulation of ten marbles over bins costs, and its parts: `cargo bench -p plaus-sim --bench marbles`.
#![allow(missing_docs, clippy::unwrap_used)]

use criterion::{BatchSize, Criterion, criterion_group, criterion_main};
use plaus_dist::{Purpose, Seed, open_unit};
use plaus_sim::marbles::Start;
use plaus_sim::trace::Trace;
use plaus_sim::worlds::{Bins, drops};
use plaus_sim::{Accuracy, Preset, Scratch};
use std::hint::black_box;

fn starts(bins: &Bins, run: u64) -> Vec<Start> {
    let mut stream = Seed(7).chain(0).at(run, Purpose::START);
    drops(bins, 10, 0.1, || open_unit(&mut stream))
}

fn marbles(c: &mut Criterion) {
    let bins = Bins::default();
    for preset in Preset::ALL {
        let world = bins.world(10, Accuracy::preset(preset), 2.0).unwrap();
        let states: Vec<_> = (0..64).map(|run| world.state(&starts(&bins, run)).unwrap()).collect();
        let (mut scratch, mut state, mut next) = (Scratch::default(), states[0].clone(), 0);
        // One sample goes on to the next of 64 draws, so that the mean is one over draws.
        c.bench_function(&format!("ten marbles, {}", preset.name()), |b| {
            b.iter(|| {
                next = (next + 1) % states.len();
                state.clone_from(&states[next]);
                black_box(world.run(&mut state, &mut scratch, 2.0, &mut ()))
            });
        });
        if preset == Preset::Standard {
            c.bench_function("ten marbles, standard, traced", |b| {
                b.iter_batched_ref(
                    Trace::default,
                    |trace| {
                        next = (next + 1) % states.len();
                        state.clone_from(&states[next]);
                        black_box(world.run(&mut state, &mut scratch, 2.0, trace))
                    },
                    BatchSize::SmallInput,
                );
            });
        }
    }
    let mut world = bins.world(10, Accuracy::default(), 2.0).unwrap();
    let mut stream = Seed(8).chain(0).at(0, Purpose::START);
    let moved = bins.perturbed(0.0001, || open_unit(&mut stream));
    c.bench_function("move 48 vertices", |b| b.iter(|| world.move_vertices(black_box(&moved)).unwrap()));
    let start = world.state(&starts(&bins, 0)).unwrap();
    let mut state = start.clone();
    c.bench_function("go back to a saved state", |b| b.iter(|| state.clone_from(black_box(&start))));
}

criterion_group!(benches, marbles);
criterion_main!(benches);

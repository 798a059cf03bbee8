//! The cost of a simulation of ten marbles over bins, and of its parts: `cargo bench -p plaus-benches --bench marbles`.
#![allow(missing_docs, clippy::unwrap_used)]

use criterion::{BatchSize, Criterion, criterion_group, criterion_main};
use glam::DVec3;
use plaus_dist::{Purpose, Seed, open_unit};
use plaus_scenes::spelling::{Bins, drops};
use plaus_sim::marbles::{MarbleSpec, MarbleWorld, Marbles, Start};
use plaus_sim::rigid::{self, BodySpec, RigidWorld, RigidWorldDesc, StaticShape};
use plaus_sim::scenery::{Mesh, Plane, Scenery};
use plaus_sim::shape::Shape;
use plaus_sim::trace::Trace;
use plaus_sim::{Accuracy, Law, Laws, Material, Preset, Scratch};
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
        // Each sample continues with the next of 64 draws, so that the mean is one over draws.
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

/// The same ball on the same floor, as a marble and as a turning body: a world costs only what it models.
fn kinds(c: &mut Criterion) {
    let (radius, law, accuracy) = (0.006, Law::new(0.3, 0.5), Accuracy::default());
    let floor = || Plane::new(DVec3::ZERO, DVec3::Z, Material(0)).unwrap();
    let (position, velocity) = (DVec3::new(0.0, 0.0, 0.07), DVec3::new(0.4, 0.0, 0.0));
    let gravity = DVec3::new(0.0, 0.0, -9.81);
    let marbles = Marbles::new(MarbleWorld {
        specs: vec![MarbleSpec::solid(radius, 0.0023, Material(0))],
        laws: Laws::uniform(law).unwrap(),
        scenery: Scenery::new(vec![floor()], Mesh::new(Vec::new(), &[], 0.0).unwrap(), Vec::new(), radius).unwrap(),
        gravity,
        accuracy,
        duration: 2.0,
    })
    .unwrap();
    let start = marbles.state(&[Start { velocity, ..Start::at_rest(position) }]).unwrap();
    let (mut state, mut scratch) = (start.clone(), Scratch::default());
    c.bench_function("one ball, as a marble", |b| {
        b.iter(|| {
            state.clone_from(&start);
            black_box(marbles.run(&mut state, &mut scratch, 2.0, &mut ()))
        });
    });
    let rigid = RigidWorld::new(RigidWorldDesc {
        bodies: vec![BodySpec::solid(Shape::Ball(radius), 2500.0, Material(0))],
        parts: vec![StaticShape::Plane(floor())],
        laws: Laws::uniform(law).unwrap(),
        gravity,
        accuracy,
        skin: 1.0,
        sink: f64::NEG_INFINITY,
        duration: 2.0,
    })
    .unwrap();
    let start = rigid.state(&[rigid::Start { velocity, ..rigid::Start::at_rest(position) }]).unwrap();
    let (mut state, mut scratch) = (start.clone(), Scratch::default());
    c.bench_function("one ball, as a turning body", |b| {
        b.iter(|| {
            state.clone_from(&start);
            black_box(rigid.run(&mut state, &mut scratch, 2.0, &mut ()))
        });
    });
}

criterion_group!(benches, marbles, kinds);
criterion_main!(benches);

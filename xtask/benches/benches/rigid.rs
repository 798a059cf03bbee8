//! The cost of throws of a die and of bowling shots: `cargo bench -p plaus-benches --bench rigid`.
#![allow(missing_docs, clippy::unwrap_used)]

#[path = "../../../crates/plaus-sim/tests/common/bumps.rs"]
mod bumps;

use bumps::noise;
use criterion::{Criterion, criterion_group, criterion_main};
use glam::DVec3;
use plaus_dist::{Purpose, Seed, open_unit};
use plaus_scenes::bowling::Alley;
use plaus_sim::worlds::DieOnTable;
use plaus_sim::{Accuracy, Preset, Scratch};
use std::hint::black_box;

fn throws(c: &mut Criterion) {
    for (name, bumps) in [("flat", 0.0), ("bumpy", 0.1)] {
        for preset in [Preset::Draft, Preset::Standard, Preset::Fine] {
            let die = DieOnTable { bumps, accuracy: Accuracy::preset(preset), ..DieOnTable::default() };
            let mut stream = Seed(1).chain(0).at(0, Purpose::START);
            let starts: Vec<_> = (0..256).map(|_| die.throw(|| open_unit(&mut stream))).collect();
            let (mut scratch, mut next) = (Scratch::default(), 0);
            c.bench_function(&format!("a die on a {name} table, {}", preset.name()), |b| {
                b.iter(|| {
                    next = (next + 1) % starts.len();
                    // The table is new for each throw, as it is for a sampler.
                    let world = die.world(noise).unwrap();
                    let mut state = world.state(&starts[next..=next]).unwrap();
                    black_box(world.run(&mut state, &mut scratch, 20.0, &mut ()))
                });
            });
        }
    }
}

fn shots(c: &mut Criterion) {
    for preset in [Preset::Draft, Preset::Standard] {
        let alley = Alley { accuracy: Accuracy::preset(preset), ..Alley::default() };
        let world = alley.world().unwrap();
        let states: Vec<_> = (0..32)
            .map(|k| {
                let velocity = DVec3::new(-0.01 * f64::from(k), 7.5, 0.0);
                let spin = DVec3::new(-velocity.y, velocity.x, 0.0) / alley.ball_radius;
                world.state(&alley.starts(2.0, 0.02 + 0.004 * f64::from(k), velocity, spin).unwrap()).unwrap()
            })
            .collect();
        let (mut scratch, mut next) = (Scratch::default(), 0);
        c.bench_function(&format!("ten pins and a ball, {}", preset.name()), |b| {
            b.iter(|| {
                next = (next + 1) % states.len();
                let mut state = states[next].clone();
                black_box(world.run(&mut state, &mut scratch, 5.0, &mut ()))
            });
        });
    }
}

criterion_group!(benches, throws, shots);
criterion_main!(benches);

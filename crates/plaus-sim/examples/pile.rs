//! A cube of 6³ balls falls onto a floor (SimBenchmark's "666"). Prints how far balls overlap, and what the pile costs.
//!
//! `cargo run --release -p plaus-sim --example pile -- [seconds] [preset]`
#![allow(
    clippy::disallowed_methods,
    clippy::print_stdout,
    clippy::unwrap_used,
    reason = "a measuring program: it reads the clock and prints"
)]

use glam::DVec3;
use plaus_dist::{Purpose, Seed, open_unit};
use plaus_sim::marbles::{Marble, MarbleSpec, MarbleWorld, Marbles, Start};
use plaus_sim::scenery::{Mesh, Plane, Scenery};
use plaus_sim::{Accuracy, Law, Laws, Material, Preset, Scratch, State};
use std::time::Instant;

const SIDE: u32 = 6;
const RADIUS: f64 = 0.1;

fn world(preset: Preset) -> Marbles {
    let ball = Material(0);
    let floor = Plane::new(DVec3::ZERO, DVec3::Z, ball).unwrap();
    Marbles::new(MarbleWorld {
        specs: vec![MarbleSpec::solid(RADIUS, 1.0, ball); SIDE.pow(3) as usize],
        laws: Laws::uniform(Law::new(0.3, 0.5)).unwrap(),
        scenery: Scenery::new(vec![floor], Mesh::new(Vec::new(), &[], 0.0).unwrap(), Vec::new(), RADIUS).unwrap(),
        gravity: DVec3::new(0.0, 0.0, -9.81),
        accuracy: Accuracy::preset(preset),
        duration: 60.0,
    })
    .unwrap()
}

/// Gaps of 0.01 between balls, each off by up to 0.0005 per axis.
fn starts() -> Vec<Start> {
    let mut stream = Seed(1).chain(0).at(0, Purpose::START);
    let mut noise = || 0.001 * (open_unit(&mut stream) - 0.5);
    (0..SIDE.pow(3))
        .map(|k| {
            let cell = [k % SIDE, k / SIDE % SIDE, k / SIDE / SIDE].map(f64::from);
            let off = DVec3::new(noise(), noise(), noise());
            Start::at_rest(DVec3::from_array(cell) * 0.21 + DVec3::Z + off)
        })
        .collect()
}

/// Deepest overlaps of two balls over the radius: in lasting contact, where one of their steps begins; in lasting
/// contact, now; other pairs, now.
fn deepest(state: &State<Marble>) -> [f64; 3] {
    let mut worst = [0.0_f64; 3];
    let bodies = state.bodies();
    let depth = |a: DVec3, b: DVec3| 2.0 - (a - b).length() / RADIUS;
    for (k, a) in bodies.iter().enumerate() {
        for (j, b) in bodies[..k].iter().enumerate() {
            let now = depth(a.path.at(state.time()), b.path.at(state.time()));
            if !state.links().contains(j as u32, k as u32) {
                worst[2] = worst[2].max(now);
                continue;
            }
            worst[1] = worst[1].max(now);
            if a.path.t == b.path.t {
                worst[0] = worst[0].max(depth(a.path.x, b.path.x));
            }
        }
    }
    worst
}

fn main() {
    let mut args = std::env::args().skip(1);
    let end: f64 = args.next().map_or(0.6, |a| a.parse().unwrap());
    let name = args.next().unwrap_or("standard".into());
    let world = world(Preset::ALL.into_iter().find(|p| p.name() == name).unwrap());
    let mut state = world.state(&starts()).unwrap();
    let (mut scratch, mut spent) = (Scratch::default(), 0.0);
    println!(
        "{:>6} {:>8} {:>6} {:>10} {:>10} {:>10} {:>9}",
        "s", "events", "links", "at begin", "lasting", "others", "ms so far"
    );
    let steps = (end / 0.05).round() as u32;
    for k in 1..=steps {
        let clock = Instant::now();
        let outcome = world.run(&mut state, &mut scratch, 0.05 * f64::from(k), &mut ()).unwrap();
        spent += clock.elapsed().as_secs_f64();
        let [begin, lasting, others] = deepest(&state);
        println!(
            "{:>6.2} {:>8} {:>6} {begin:>10.1e} {lasting:>10.1e} {others:>10.1e} {:>9.1} {outcome:?}",
            state.time(),
            state.counts().events,
            state.links().len(),
            1e3 * spent
        );
    }
}

//! Many bodies: the cost of an event when they are far apart, and balls poured into a box.
//! `cargo run --release -p plaus-sim --example crowd -- 1000`; 50 balls by default.

#![allow(clippy::print_stdout, reason = "an example prints")]
#![allow(clippy::disallowed_methods, reason = "it measures time")]

use glam::DVec3;
use plaus_sim::rigid::{BodySpec, Phase, RigidWorld, RigidWorldDesc, Start, StaticShape};
use plaus_sim::scenery::Plane;
use plaus_sim::shape::Shape;
use plaus_sim::{Accuracy, Law, Laws, Material, Scratch, WorldError};
use std::time::Instant;

const M: Material = Material(0);
const R: f64 = 0.01;

fn world(n: usize, parts: Vec<StaticShape>, restitution: f64) -> Result<RigidWorld, WorldError> {
    RigidWorld::new(RigidWorldDesc {
        bodies: vec![BodySpec::solid(Shape::Ball(R), 2500.0, M); n],
        parts,
        laws: Laws::uniform(Law::new(0.3, restitution).with_resistance(0.01, 0.01))?,
        gravity: DVec3::new(0.0, 0.0, -9.81),
        accuracy: Accuracy::default(),
        skin: 1.0,
        sink: f64::NEG_INFINITY,
        duration: 100.0,
    })
}

fn plane(at: DVec3, normal: DVec3) -> Result<StaticShape, WorldError> {
    Ok(StaticShape::Plane(Plane::new(at, normal, M)?))
}

/// A number in [0, 1) for two integers.
fn noise(i: usize, k: usize) -> f64 {
    (i as f64 * 0.754_877_666_246_692_8 + k as f64 * 0.569_840_290_998_053_3) % 1.0
}

fn main() -> Result<(), WorldError> {
    println!("bodies that bounce, each on its own square");
    for n in [10, 100, 1000, 10_000] {
        let world = world(n, vec![plane(DVec3::ZERO, DVec3::Z)?], 1.0)?;
        let side = (n as f64).sqrt().ceil() as usize;
        let start = |k: usize| {
            let square = DVec3::new((k % side) as f64, (k / side) as f64, 0.0) * (10.0 * R);
            Start::at_rest(square + DVec3::Z * (R + 0.1 + 0.1 * noise(k, 1)))
        };
        let starts: Vec<Start> = (0..n).map(start).collect();
        let begin = Instant::now();
        let mut state = world.state(&starts)?;
        let made = begin.elapsed().as_secs_f64();
        let begin = Instant::now();
        world.run(&mut state, &mut Scratch::default(), 2.0, &mut ())?;
        let (time, events) = (begin.elapsed().as_secs_f64(), state.counts().events);
        println!(
            "  {n:>6}: start {:.2} µs a body, {:.2} µs an event ({events} events)",
            1e6 * made / n as f64,
            1e6 * time / events as f64
        );
    }
    let n: usize = std::env::args().nth(1).and_then(|n| n.parse().ok()).unwrap_or(50);
    let half = 0.1;
    let mut parts = vec![plane(DVec3::ZERO, DVec3::Z)?];
    for n in [DVec3::X, -DVec3::X, DVec3::Y, -DVec3::Y] {
        parts.push(plane(n * -half, n)?);
    }
    let world = world(n, parts, 0.5)?;
    let start = |k: usize| {
        let (layer, place) = (k / 49, k % 49);
        let at = DVec3::new((place % 7) as f64 - 3.0, (place / 7) as f64 - 3.0, 0.0) * (2.4 * R);
        let jitter = DVec3::new(noise(k, 0) - 0.5, noise(k, 1) - 0.5, 0.0) * (0.3 * R);
        Start::at_rest(at + jitter + DVec3::Z * (2.4 * R * (layer as f64 + 1.0)))
    };
    let starts: Vec<Start> = (0..n).map(start).collect();
    let mut state = world.state(&starts)?;
    let (begin, mut scratch) = (Instant::now(), Scratch::default());
    for tenth in 1..=10 {
        let outcome = world.run(&mut state, &mut scratch, 0.1 * f64::from(tenth), &mut ())?;
        let deepest = state.bodies().iter().enumerate().map(|(k, b)| world.depth(k, b)).fold(0.0, f64::max);
        let resting = state.bodies().iter().filter(|b| b.phase == Phase::Rest).count();
        let (events, links) = (state.counts().events, state.links().len());
        println!(
            "  {n} balls, {:.1} s of motion: {:.1} s, {events} events, {links} contacts, {resting} at rest, {:.1e} r deep, {outcome:?}",
            0.1 * f64::from(tenth),
            begin.elapsed().as_secs_f64(),
            deepest / R
        );
        if begin.elapsed().as_secs_f64() > 60.0 {
            println!("  given up");
            break;
        }
    }
    Ok(())
}

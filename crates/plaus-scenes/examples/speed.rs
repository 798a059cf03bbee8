//! How long single simulations of small worlds take, in processor time: mean, median and the longest, with the number
//! of its draw; and an iteration of the 2D ball's chain.
//!
//!     cargo run --release -p plaus-scenes --example speed -- [WORLD] [DRAWS] [FIRST] [PRESET]
//!
//! WORLD is `shot`, `flat`, `bumpy`, `marbles`, `coin`, `track`, `ball` or `all`. Draw k does not depend on FIRST, so a
//! slow draw can be made alone, for a profile or to count instructions.
#![allow(clippy::print_stdout, reason = "an example reports to the terminal")]

#[path = "../../plaus-sim/examples/measure/mod.rs"]
mod measure;
mod shared;

use glam::{DQuat, DVec3};
use measure::noise;
use plaus_dist::{Purpose, Seed, Stream, math, open_unit};
use plaus_mcmc::Chain;
use plaus_scenes::ball2d::{Ball2d, Config};
use plaus_scenes::bowling::Alley;
use plaus_scenes::spelling::{Bins, drops};
use plaus_scenes::{Rules, Scene};
use plaus_sim::rigid::{BodySpec, RigidScratch, RigidWorld, RigidWorldDesc, Start, StaticShape};
use plaus_sim::scenery::{Heights, Plane};
use plaus_sim::shape::{Frustum, Shape};
use plaus_sim::worlds::DieOnTable;
use plaus_sim::{Accuracy, Law, Laws, Material, Preset, Scratch};
use shared::seconds;
use std::error::Error;
use std::sync::Arc;

type Result<T> = std::result::Result<T, Box<dyn Error>>;

/// Simulates the k-th draw; returns the number of events.
type Run = Box<dyn FnMut(u64) -> Result<u64>>;

const NAMES: [&str; 7] = ["shot", "flat", "bumpy", "marbles", "coin", "track", "ball"];

/// Iterations of a chain that count as one draw.
const STRETCH: u64 = 1000;

fn main() -> Result<()> {
    let mut args = std::env::args().skip(1);
    let asked = args.next().unwrap_or("all".into());
    let draws: u64 = args.next().map_or(Ok(20), |a| a.parse())?;
    let first: u64 = args.next().map_or(Ok(0), |a| a.parse())?;
    let preset = args.next().unwrap_or("standard".into());
    let preset = Preset::ALL.into_iter().find(|p| p.name() == preset).ok_or("no such preset")?;
    if asked != "all" && !NAMES.contains(&asked.as_str()) {
        return Err(format!("no world is called {asked}: there are {}", NAMES.join(", ")).into());
    }
    println!("world      mean ms   median      p99  longest  of draw  events");
    for name in NAMES.into_iter().filter(|name| asked == "all" || asked == *name) {
        let mut run = world(name, Accuracy::preset(preset))?;
        let (mut times, mut events) = (Vec::new(), 0);
        for k in first..first + draws {
            let begin = seconds();
            events += run(k)?;
            times.push((1e3 * (seconds() - begin), k));
        }
        let mean = times.iter().map(|t| t.0).sum::<f64>() / draws as f64;
        times.sort_by(|a, b| a.0.total_cmp(&b.0));
        let at = |part: f64| times[((draws - 1) as f64 * part) as usize].0;
        let longest = times[times.len() - 1];
        println!(
            "{name:8} {mean:9.4} {:8.4} {:8.4} {:8.3} {:8} {:7}",
            at(0.5),
            at(0.99),
            longest.0,
            longest.1,
            events / draws
        );
    }
    Ok(())
}

fn stream(k: u64) -> Stream {
    Seed(7).chain(3).at(k, Purpose::START)
}

fn world(name: &str, accuracy: Accuracy) -> Result<Run> {
    Ok(match name {
        "shot" => shots(accuracy)?,
        "flat" => die(accuracy, 0.0),
        "bumpy" => die(accuracy, 0.1),
        "marbles" => marbles(accuracy)?,
        "coin" => coin(accuracy)?,
        "track" => track(accuracy)?,
        _ => ball()?,
    })
}

/// A world of turning bodies, in which each draw has other starts.
fn thrown(world: RigidWorld, until: f64, starts: impl Fn(&mut Stream) -> Result<Vec<Start>> + 'static) -> Run {
    let mut scratch = Scratch::<RigidScratch>::default();
    Box::new(move |k| {
        let mut state = world.state(&starts(&mut stream(k))?)?;
        world.run(&mut state, &mut scratch, until, &mut ())?;
        Ok(state.counts().events)
    })
}

/// Shots at ten pins from 2 m, rolling towards the pocket at −1 to 6 degrees, as in `cargo xtask tradeoff`; 5 s.
fn shots(accuracy: Accuracy) -> Result<Run> {
    let alley = Alley { accuracy, ..Alley::default() };
    Ok(thrown(alley.world()?, 5.0, move |stream| {
        let mut between = |low: f64, high: f64| low + (high - low) * open_unit(stream);
        let (angle, speed) = (between(-0.02, 0.1), between(7.0, 8.5));
        let velocity = DVec3::new(-angle * speed, speed, 0.0);
        let spin = DVec3::new(-velocity.y, velocity.x, 0.0) / alley.ball_radius;
        Ok(alley.starts(2.0, between(0.0, 0.1) + angle * 2.0, velocity, spin)?)
    }))
}

/// Throws of a die, each onto a new table, as for a sampler.
fn die(accuracy: Accuracy, bumps: f64) -> Run {
    let die = DieOnTable { bumps, accuracy, ..DieOnTable::default() };
    let mut scratch = Scratch::<RigidScratch>::default();
    Box::new(move |k| {
        let mut stream = stream(k);
        let world = die.world(noise)?;
        let mut state = world.state(&[die.throw(|| open_unit(&mut stream))])?;
        world.run(&mut state, &mut scratch, 20.0, &mut ())?;
        Ok(state.counts().events)
    })
}

/// Ten marbles over bins; 2 s.
fn marbles(accuracy: Accuracy) -> Result<Run> {
    let bins = Bins::default();
    let world = bins.world(10, accuracy, 2.0)?;
    let mut scratch = Scratch::default();
    Ok(Box::new(move |k| {
        let mut stream = stream(k);
        let mut state = world.state(&drops(&bins, 10, 0.1, || open_unit(&mut stream)))?;
        world.run(&mut state, &mut scratch, 2.0, &mut ())?;
        Ok(state.counts().events)
    }))
}

/// Tosses of the thick coin of `cargo xtask tradeoff`, to rest.
fn coin(accuracy: Accuracy) -> Result<Run> {
    let metal = Material(0);
    let world = RigidWorld::new(RigidWorldDesc {
        bodies: vec![BodySpec::solid(Frustum::cylinder(0.012, 0.0084)?.into(), 8000.0, metal)],
        parts: vec![StaticShape::Plane(Plane::new(DVec3::ZERO, DVec3::Z, metal)?)],
        laws: Laws::uniform(Law::new(0.3, 0.4).with_resistance(0.05, 0.05))?,
        accuracy,
        ..RigidWorldDesc::default()
    })?;
    Ok(thrown(world, 10.0, |stream| {
        let mut between = |low: f64, high: f64| low + (high - low) * open_unit(stream);
        let mut three = |most: f64| DVec3::new(between(-most, most), between(-most, most), between(-most, most));
        let (velocity, spin, place, turn) = (three(0.5), three(30.0), three(0.1), three(3.0));
        let position = DVec3::new(0.0, 0.0, 0.3 + place.z);
        Ok(vec![Start { position, velocity, spin, orientation: DQuat::from_scaled_axis(turn), time: 0.0 }])
    }))
}

/// A ball on the winding track of `cargo xtask tradeoff`, 20,000 triangles; 5 s.
fn track(accuracy: Accuracy) -> Result<Run> {
    let wood = Material(0);
    let height = |x: f64, y: f64| {
        let off = y - 0.012 * math::sin(10.0 * x);
        0.5 * off * off / 0.06 - 0.04 * x
    };
    let row = |j: u32| {
        let y = (f64::from(j) - 5.0) * 0.008;
        (0..=1000).map(|i| height((f64::from(i) - 500.0) * 0.004, y)).collect()
    };
    let heights = Heights::new([0.004, 0.008], &(0..=10).map(row).collect::<Vec<_>>())?;
    let world = RigidWorld::new(RigidWorldDesc {
        bodies: vec![BodySpec::solid(Shape::Ball(0.01), 2500.0, wood)],
        parts: vec![StaticShape::Mesh(Arc::new(heights.mesh(DVec3::ZERO, DQuat::IDENTITY, wood)?))],
        laws: Laws::uniform(Law::new(0.3, 0.2))?,
        accuracy,
        ..RigidWorldDesc::default()
    })?;
    Ok(thrown(world, 5.0, move |stream| {
        let mut between = |low: f64, high: f64| low + (high - low) * open_unit(stream);
        let x = -2.0 + between(0.05, 0.1);
        let y = 0.012 * math::sin(10.0 * x) + between(-0.015, 0.015);
        Ok(vec![Start::at_rest(DVec3::new(x, y, height(x, y) + 0.0115))])
    }))
}

/// Stretches of a thousand iterations of the 2D ball's chain with the default moves: ms are µs for each iteration.
fn ball() -> Result<Run> {
    let scene = Box::leak(Box::new(Ball2d::new(&Config::default())?));
    let moves = Box::leak(Box::new(scene.moves(&Rules::exact())?));
    let mut chain = Chain::start(scene, moves, Seed(1).chain(0))?;
    Ok(Box::new(move |_| {
        for _ in 0..STRETCH {
            chain.step()?;
        }
        Ok(0)
    }))
}

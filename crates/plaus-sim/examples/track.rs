//! A ball on a winding track of 20,000 triangles, as a marble and as a turning body: how long 5 s of motion take.
//! `cargo run --release -p plaus-sim --example track -- [RUNS] [PRESET] [marble|turning]`.
#![allow(clippy::print_stdout, reason = "a measuring program: it prints")]
#![allow(clippy::disallowed_methods, reason = "it measures time")]

use plaus_dist::math;
use plaus_sim::glam::{DQuat, DVec3};
use plaus_sim::marbles::{self, MarbleSpec, MarbleWorld, Marbles};
use plaus_sim::rigid::{self, BodySpec, RigidWorld, RigidWorldDesc, StaticShape};
use plaus_sim::scenery::{Heights, Scenery};
use plaus_sim::shape::Shape;
use plaus_sim::{Accuracy, Law, Laws, Material, Preset, Scratch};
use std::error::Error;
use std::sync::Arc;
use std::time::Instant;

const RADIUS: f64 = 0.01;

/// Height of the track: it falls by 4 % along x, and winds.
fn height(x: f64, y: f64) -> f64 {
    let off = y - 0.012 * math::sin(10.0 * x);
    0.5 * off * off / 0.06 - 0.04 * x
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut args = std::env::args().skip(1);
    let runs: u32 = args.next().map_or(Ok(3), |a| a.parse())?;
    let name = args.next().unwrap_or("standard".into());
    let preset = Preset::ALL.into_iter().find(|p| p.name() == name).ok_or("draft, standard, fine or reference")?;
    let kind = args.next();
    let is_asked = |name: &str| kind.as_deref().is_none_or(|kind| kind == name);
    let (wood, law) = (Material(0), Law::new(0.3, 0.2));
    let row = |j: u32| {
        let y = (f64::from(j) - 5.0) * 0.008;
        (0..=1000).map(|i| height((f64::from(i) - 500.0) * 0.004, y)).collect()
    };
    let heights = Heights::new([0.004, 0.008], &(0..=10).map(row).collect::<Vec<_>>())?;
    let mesh = heights.mesh(DVec3::ZERO, DQuat::IDENTITY, wood)?;
    let loose = Marbles::new(MarbleWorld {
        specs: vec![MarbleSpec::solid(RADIUS, 0.0105, wood)],
        laws: Laws::uniform(law)?,
        scenery: Scenery::new(Vec::new(), mesh.clone(), Vec::new(), RADIUS)?,
        accuracy: Accuracy::preset(preset),
        ..MarbleWorld::default()
    })?;
    let turning = RigidWorld::new(RigidWorldDesc {
        bodies: vec![BodySpec::solid(Shape::Ball(RADIUS), 2500.0, wood)],
        parts: vec![StaticShape::Mesh(Arc::new(mesh))],
        laws: Laws::uniform(law)?,
        accuracy: Accuracy::preset(preset),
        ..RigidWorldDesc::default()
    })?;
    for run in 0..runs {
        let (x, off) = (-1.93, 0.01 * math::sin(f64::from(run)));
        let y = 0.012 * math::sin(10.0 * x) + off;
        let at = DVec3::new(x, y, height(x, y) + 1.15 * RADIUS);

        if is_asked("marble") {
            let mut state = loose.state(&[marbles::Start::at_rest(at)])?;
            let clock = Instant::now();
            loose.run(&mut state, &mut Scratch::default(), 5.0, &mut ())?;
            let (time, end) = (clock.elapsed(), loose.at(0, &state.bodies()[0], 5.0).path.x);
            println!("marble:  {:8.3} ms, {:?}, ends at x {:.4} m", 1e3 * time.as_secs_f64(), state.counts(), end.x);
        }
        if is_asked("turning") {
            let mut state = turning.state(&[rigid::Start::at_rest(at)])?;
            let clock = Instant::now();
            turning.run(&mut state, &mut Scratch::default(), 5.0, &mut ())?;
            let (time, end) = (clock.elapsed(), turning.at(0, &state.bodies()[0], 5.0).path.x);
            println!("turning: {:8.3} ms, {:?}, ends at x {:.4} m", 1e3 * time.as_secs_f64(), state.counts(), end.x);
        }
    }
    Ok(())
}

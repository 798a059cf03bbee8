//! A ball that falls, bounces and rests, against the exact answer:
//! `cargo run -p plaus-sim --example bouncing_ball -- [PATH]`.
#![allow(clippy::print_stdout, reason = "an example: it prints")]

mod measure;

use glam::DVec3;
use plaus_sim::marbles::{MarbleSpec, MarbleWorld, Marbles, Start};
use plaus_sim::scenery::{Mesh, Plane, Scenery};
use plaus_sim::trace::Trace;
use plaus_sim::{Accuracy, Law, Laws, Material, Preset, Scratch};
use std::error::Error;

fn main() -> Result<(), Box<dyn Error>> {
    let (radius, height, restitution, g) = (0.1, 1.0, 0.7, 9.81_f64);
    let rubber = Material(0);
    let floor = Plane::new(DVec3::ZERO, DVec3::Z, rubber)?;
    let world = Marbles::new(MarbleWorld {
        specs: vec![MarbleSpec::solid(radius, 0.5, rubber)],
        laws: Laws::uniform(Law::new(0.3, restitution))?,
        scenery: Scenery::new(vec![floor], Mesh::new(Vec::new(), &[], 0.0)?, Vec::new(), radius)?,
        gravity: DVec3::new(0.0, 0.0, -g),
        accuracy: Accuracy::preset(Preset::Fine),
        duration: 20.0,
    })?;
    let mut state = world.state(&[Start::at_rest(DVec3::new(0.0, 0.0, radius + height))])?;
    let mut trace = Trace::default();
    let outcome = world.run(&mut state, &mut Scratch::default(), 20.0, &mut trace)?;

    println!("{:>6} {:>12} {:>12} {:>14}", "bounce", "time in s", "exact", "approach m/s");
    let fall = (2.0 * height / g).sqrt();
    let mut exact = fall;
    let mut flight = 2.0 * fall;
    for (k, impact) in trace.impacts.iter().take(8).enumerate() {
        println!("{:>6} {:>12.9} {:>12.9} {:>14.6}", k + 1, impact.time, exact, impact.approach);
        flight *= restitution;
        exact += flight;
    }
    let end = fall * (1.0 + restitution) / (1.0 - restitution);
    println!(
        "{outcome:?} at {:.6} s after {} impacts; infinitely many would end at {end:.6} s",
        state.bodies()[0].path.t,
        trace.impacts.len()
    );
    let path = std::env::args().nth(1).unwrap_or("target/bouncing_ball.json".into());
    measure::write_trace(&path, &trace)?;
    println!("wrote {path}: {} motions and all impacts", trace.motions[0].len());
    Ok(())
}

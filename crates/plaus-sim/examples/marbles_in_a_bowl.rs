//! Marbles that roll to rest in a bowl: `cargo run -p plaus-sim --example marbles_in_a_bowl -- [PATH]`.
#![allow(clippy::print_stdout, reason = "an example: it prints")]

mod measure;

use glam::DVec3;
use plaus_sim::marbles::{MarbleSpec, MarbleWorld, Marbles, Start};
use plaus_sim::scenery::{Aabb, Dome, Mesh, Scenery};
use plaus_sim::trace::Trace;
use plaus_sim::{Accuracy, Law, Laws, Material, Scratch};
use std::error::Error;

fn main() -> Result<(), Box<dyn Error>> {
    let (count, radius, glass, wood) = (7, 0.008, Material(0), Material(1));
    let depth = 0.15;
    let clip = Aabb { min: DVec3::splat(-depth), max: DVec3::splat(depth) };
    let bowl = Dome::new(DVec3::new(0.0, 0.0, depth), depth, true, clip, wood)?;
    let mut laws = Laws::new(2, Law::new(0.3, 0.6).with_resistance(0.01, 0.01))?;
    laws.set(glass, glass, Law::new(0.1, 0.9))?;
    let world = Marbles::new(MarbleWorld {
        specs: vec![MarbleSpec::solid(radius, 0.0054, glass); count],
        laws,
        scenery: Scenery::new(Vec::new(), Mesh::new(Vec::new(), &[], 0.0)?, vec![bowl], radius)?,
        gravity: DVec3::new(0.0, 0.0, -9.81),
        accuracy: Accuracy::default(),
        duration: 20.0,
    })?;
    let start = |k: usize| {
        let along = k as f64 / count as f64 - 0.5;
        Start { time: 0.2 * k as f64, ..Start::at_rest(DVec3::new(0.12 * along, 0.05 - 0.1 * along * along, 0.14)) }
    };
    let mut state = world.state(&(0..count).map(start).collect::<Vec<_>>())?;
    let mut trace = Trace::default();
    let outcome = world.run(&mut state, &mut Scratch::default(), 20.0, &mut trace)?;

    println!(
        "{:>6} {:>9} {:>9} {:>9} {:>8} {:>8}  phase",
        "marble", "x in mm", "y in mm", "z in mm", "impacts", "motions"
    );
    for (k, marble) in state.bodies().iter().enumerate() {
        let x = marble.path.at(state.time()) * 1000.0;
        let impacts =
            trace.impacts.iter().filter(|i| i.body == k || i.other == plaus_sim::mechanics::Other::Body(k)).count();
        println!(
            "{k:>6} {:>9.3} {:>9.3} {:>9.3} {impacts:>8} {:>8}  {:?}",
            x.x,
            x.y,
            x.z,
            trace.motions[k].len(),
            marble.phase
        );
    }
    println!("{outcome:?} at {:.3} s; {:?}", state.time(), state.counts());
    let path = std::env::args().nth(1).unwrap_or("target/marbles_in_a_bowl.json".into());
    measure::write_trace(&path, &trace)?;
    println!("wrote {path}");
    Ok(())
}

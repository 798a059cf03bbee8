//! Times shots that are drawn from the prior, and counts what they leave: `cargo run --release -p plaus-scenes --example bowling_shots -- [SCENARIO] [SHOTS]`.

#![allow(clippy::print_stdout, reason = "an example reports to the terminal")]

use plaus_dist::{Purpose, Seed};
mod shared;

use plaus_mcmc::{StateOf, Target};
use plaus_scenes::bowling::{Bowling, Work};
use plaus_scenes::registry::World;
use plaus_scenes::scenario::Scenario;
use shared::seconds;
use std::error::Error;

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let file = arguments.next().unwrap_or_else(|| "scenarios/bowling-strike.toml".into());
    let shots: u64 = arguments.next().map_or(Ok(20), |count| count.parse())?;
    // Examples may be run from anywhere in the workspace.
    let path = [file.clone(), format!("{}/../../{file}", env!("CARGO_MANIFEST_DIR"))];
    let text = path.iter().find_map(|path| std::fs::read_to_string(path).ok()).ok_or("no such scenario")?;
    let World::Bowling(config) = Scenario::read(&file, &text, &[])?.world else {
        return Err("not a bowling scenario".into());
    };
    let scene = Bowling::new(&config)?;
    let (mut work, mut times, mut satisfied, mut falls) = (Work::default(), Vec::new(), 0, [0; 11]);
    for shot in 0..shots {
        let draw = scene.start(&mut Seed(1).chain(shot).at(0, Purpose::START));
        let begin = seconds();
        let state = StateOf::<Bowling>::evaluate(&scene, draw, &mut work)?;
        times.push(((seconds() - begin) * 1e3, shot));
        satisfied += u32::from(scene.is_satisfied(&state.outcome));
        falls[state.outcome.pins.iter().filter(|fate| !fate.stands()).count()] += 1;
    }
    let total: f64 = times.iter().map(|time| time.0).sum();
    times.sort_by(|a, b| a.0.total_cmp(&b.0));
    let at = |share: f64| times[((shots as f64 - 1.0) * share) as usize];
    println!(
        "{shots} shots of {file}: mean {:.2} ms of processor time, median {:.2} ms, 90% within {:.2} ms, longest {:.2} ms (shot {})",
        total / shots as f64,
        at(0.5).0,
        at(0.9).0,
        at(1.0).0,
        at(1.0).1
    );
    println!("satisfied: {satisfied}; pins that fell, 0 to 10: {falls:?}");
    Ok(())
}

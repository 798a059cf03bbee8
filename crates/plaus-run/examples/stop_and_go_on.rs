//! A run that stops half-way, is continued, and is read back: `cargo run -p plaus-run --example stop_and_go_on`.
#![allow(clippy::print_stdout, reason = "an example shows what it does")]

use plaus_mcmc::{Control, Ending, Progress};
use plaus_run::{Diagnosis, Folder, More, Recipe, Run, Sampling, Unwatched, Watch};
use plaus_scenes::Scenario;
use plaus_scenes::scenario::template;

/// Stops at the first chance after half the iterations, as a user with Ctrl-C might.
struct Halfway {
    iterations: u64,
}

impl Watch for Halfway {
    fn round(&mut self, progress: &Progress<'_>) -> Control {
        if progress.end_iteration * 2 >= self.iterations { Control::Stop } else { Control::Continue }
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let place = tempfile::tempdir()?;
    let folder = Folder::new(place.path().join("ball2d"));
    let text = template("ball2d").ok_or("there is no such scene")?;
    let scenario = Scenario::read("ball2d.toml", &text, &["sampler.checkpoint_every=1000".to_owned()])?;
    let iterations = scenario.sampler.iterations;
    let recipe = Recipe { scenario, file: "ball2d.toml".into(), text, overrides: vec![], solutions: None };

    let ending = plaus_run::sample(&folder, &recipe, Sampling::new(0, &mut Halfway { iterations }))?;
    println!("first session: {ending:?}");
    let ending = plaus_run::resume(&folder, More::default(), Sampling::new(0, &mut Unwatched))?;
    println!("second session: {ending:?}");
    assert!(matches!(ending, Ending::Complete), "nothing stopped the second session");

    let run = Run::open(&folder)?;
    let diagnosis = Diagnosis::of(&run.reader()?, None)?;
    println!("{} draws of each chain", diagnosis.draws);
    for found in &diagnosis.scalars {
        if let Some(summary) = &found.summary {
            println!(
                "{:>8}: {:7.3} ± {:.3}, ESS {:.0}",
                found.scalar.name, summary.mean, summary.mcse_mean, summary.ess_bulk
            );
        }
    }
    Ok(())
}

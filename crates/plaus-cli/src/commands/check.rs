//! `plaus check`

use crate::console;
use crate::failure::{Failure, Outcome};
use crate::output;
use crate::scenario_file;
use crate::waiting::Waiting;
use crate::why;
use plaus_scenes::Scene;
use plaus_scenes::scenario::ScenarioError;
use std::path::PathBuf;

/// Which scenario.
#[derive(clap::Args)]
pub(crate) struct Args {
    /// Scenario file (TOML)
    scenario: PathBuf,
    /// Set any key of the scenario, e.g. `--set sigma_d=0.05`; may be given several times
    #[arg(long = "set", value_name = "KEY=VALUE")]
    overrides: Vec<String>,
    /// Draw N animations from the prior, and print how many of them meet each requirement
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..), allow_negative_numbers = true)]
    draws: Option<u64>,
    /// Print what `--draws` found as one JSON object, and nothing else
    #[arg(long, requires = "draws")]
    json: bool,
    /// Print nothing if the scenario is valid, except what `--draws` found
    #[arg(short, long)]
    quiet: bool,
}

impl Args {
    pub(super) fn run(self) -> Result<Outcome, Failure> {
        let recipe = scenario_file::read(&self.scenario, self.overrides, None)?;
        let name = self.scenario.display().to_string();
        let locate = |error| Failure::from(ScenarioError::locate(&name, &recipe.text, &error));
        let scene = recipe.scenario.stage().map_err(locate)?;
        // The manifest that a run would have, with the scene's moves.
        let manifest = recipe.manifest(&scene).map_err(|error| match error {
            plaus_run::Error::Config(error) => locate(error),
            other => other.into(),
        })?;
        if let Some(draws) = self.draws {
            let waiting = (!self.quiet).then(|| Waiting::on("drawing from the prior".to_owned()));
            let tally = why::of_prior(&scene, recipe.scenario.sampler.seed, draws);
            drop(waiting);
            let tally = tally.map_err(|error| Failure::Message(format!("{name}: {error}")))?;
            let text = if self.json { format!("{}\n", why::to_json(&tally)) } else { why::in_words(&tally, "draws") };
            output::print(&text)?;
            return Ok(Outcome::Done);
        }
        if !self.quiet {
            let scalars: Vec<&str> = manifest.scalars.iter().map(|scalar| scalar.name.as_str()).collect();
            console::note_line(&format!(
                "{name} is valid; moves: {}; scalars: {}",
                manifest.moves.join(", "),
                scalars.join(", ")
            ));
            scene.notes().iter().for_each(|note| console::note_line(note));
            console::note_line("With all keys in force:");
            output::print(&manifest.scenario.effective)?;
        }
        Ok(Outcome::Done)
    }
}

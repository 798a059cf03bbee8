//! `plaus check`

use crate::console;
use crate::failure::{Failure, Outcome};
use crate::output;
use crate::scenario_file;
use crate::why::{self, OfPrior};
use plaus_run::Manifest;
use plaus_scenes::scenario::ScenarioError;
use plaus_scenes::{Scene, Visitor};
use std::path::PathBuf;

/// Which scenario.
#[derive(clap::Args)]
pub(crate) struct Args {
    /// Scenario file (TOML)
    scenario: PathBuf,
    /// Set any key of the scenario, e.g. `--set sigma_d=0.05`; may be given several times
    #[arg(long = "set", value_name = "KEY=VALUE")]
    overrides: Vec<String>,
    /// Draw so many animations from the prior, and print how many of them meet each thing that is asked
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..), allow_negative_numbers = true)]
    draws: Option<u64>,
    /// Print what `--draws` found as one JSON object, and nothing else
    #[arg(long, requires = "draws")]
    json: bool,
    /// Print nothing where the scenario is valid, but what `--draws` found
    #[arg(short, long)]
    quiet: bool,
}

/// Makes the scene and its moves, and so the manifest a run would have, and says what is to be known of the world.
struct Try<'a>(&'a plaus_run::Recipe);

impl Visitor for Try<'_> {
    type Output = Result<(Manifest, Vec<String>), plaus_run::Error>;
    fn visit<S: Scene>(self, scene: S) -> Self::Output {
        Ok((self.0.manifest(&scene)?, scene.notes()))
    }
}

impl Args {
    pub(super) fn run(self) -> Result<Outcome, Failure> {
        let recipe = scenario_file::read(&self.scenario, self.overrides, None)?;
        let name = self.scenario.display().to_string();
        let locate = |error| Failure::from(ScenarioError::locate(&name, &recipe.text, &error));
        let manifest = recipe.scenario.visit(Try(&recipe)).map_err(locate)?;
        let (manifest, notes) = manifest.map_err(|error| match error {
            plaus_run::Error::Config(error) => locate(error),
            other => other.into(),
        })?;
        if let Some(draws) = self.draws {
            let (seed, tells) = (recipe.scenario.sampler.seed, !self.quiet && !self.json);
            let tally = recipe.scenario.visit(OfPrior { draws, seed, tells }).map_err(locate)?;
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
            notes.iter().for_each(|note| console::note_line(note));
            console::note_line("With all keys in force:");
            output::print(&manifest.scenario.effective)?;
        }
        Ok(Outcome::Done)
    }
}

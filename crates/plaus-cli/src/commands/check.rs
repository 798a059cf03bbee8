//! `plaus check`

use crate::console;
use crate::failure::{Failure, Outcome};
use crate::scenario_file;
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
    /// Print nothing where the scenario is valid
    #[arg(short, long)]
    quiet: bool,
}

/// Makes the scene and its moves, and so the manifest a run would have.
struct Try<'a>(&'a plaus_run::Recipe);

impl Visitor for Try<'_> {
    type Output = Result<Manifest, plaus_run::Error>;
    fn visit<S: Scene>(self, scene: S) -> Self::Output {
        self.0.manifest(&scene)
    }
}

impl Args {
    pub(super) fn run(self) -> Result<Outcome, Failure> {
        let recipe = scenario_file::read(&self.scenario, self.overrides, None)?;
        let name = self.scenario.display().to_string();
        let locate = |error| Failure::from(ScenarioError::locate(&name, &recipe.text, &error));
        let manifest = recipe.scenario.visit(Try(&recipe)).map_err(locate)?;
        let manifest = manifest.map_err(|error| match error {
            plaus_run::Error::Config(error) => locate(error),
            other => other.into(),
        })?;
        if !self.quiet {
            let scalars: Vec<&str> = manifest.scalars.iter().map(|scalar| scalar.name.as_str()).collect();
            console::note_line(&format!(
                "{name} is valid; moves: {}; scalars: {}",
                manifest.moves.join(", "),
                scalars.join(", ")
            ));
            console::note_line("With all keys in force:");
            console::print(&manifest.scenario.effective)?;
        }
        Ok(Outcome::Done)
    }
}

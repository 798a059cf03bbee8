//! `plaus check`

use crate::console;
use crate::failure::{Failure, Outcome};
use crate::output;
use crate::plots::histogram::{Bins, Histogram};
use crate::scenario_file;
use crate::table::counted;
use crate::waiting::Waiting;
use crate::why;
use plaus_run::{Manifest, Recipe};
use plaus_scenes::scenario::ScenarioError;
use plaus_scenes::{Scene, Stage};
use std::path::PathBuf;

/// Draws from the prior in which each requirement should be met at least once.
const TRIED: u64 = 200;
/// Fewer draws say nothing.
const ENOUGH: u64 = 50;
/// Most uncertain numbers that are named, unless all are asked for.
const SHOWN: usize = 12;

/// Which scenario.
#[derive(clap::Args)]
pub(crate) struct Args {
    /// Scenario file (TOML)
    scenario: PathBuf,
    /// Set any key of the scenario, e.g. `--set sigma_d=0.05`; may be given several times
    #[arg(long = "set", value_name = "KEY=VALUE")]
    overrides: Vec<String>,
    /// Show every key, with defaults, and the moves and numbers that a run would have
    #[arg(short, long, alias = "defaults")]
    all: bool,
    /// Draw N animations from the prior, and print how many of them meet each requirement
    #[arg(long, value_name = "N", value_parser = super::from_one, allow_negative_numbers = true)]
    draws: Option<u64>,
    /// With `--draws`: count how often each value of a number comes up, such as die.up; may be given several times
    #[arg(long, value_name = "NUMBER", requires = "draws")]
    count: Vec<String>,
    /// With `--count`: the width of the bins, which are centred on its multiples; or, after a colon, one of their
    /// edges, e.g. 20:0
    #[arg(long, value_name = "WIDTH[:EDGE]", requires = "count", value_parser = super::plot::bins,
        allow_hyphen_values = true)]
    bin: Option<Bins>,
    /// Print what `--draws` found as one JSON object, and nothing else
    #[arg(long, requires = "draws")]
    json: bool,
    /// Print nothing if the scenario is valid, except what `--draws` found
    #[arg(short, long)]
    quiet: bool,
}

impl Args {
    pub(super) fn run(self) -> Result<Outcome, Failure> {
        let recipe = scenario_file::read(&self.scenario, self.overrides.clone(), None)?;
        let name = self.scenario.display().to_string();
        let locate = |error| Failure::from(ScenarioError::locate(&name, &recipe.text, &error));
        let scene = recipe.scenario.stage().map_err(locate)?;
        // The manifest that a run would have, with the scene's moves.
        let manifest = recipe.manifest(&scene).map_err(|error| match error {
            plaus_run::Error::Config(error) => locate(error),
            other => other.into(),
        })?;
        if !self.quiet && !self.json {
            scene.notes().iter().for_each(|note| console::remark(note));
        }
        if let Some(draws) = self.draws {
            let scalars = scene.scalars();
            let counted = self.count.iter().map(|name| super::plot::number(name, &scalars));
            let counted: Vec<usize> = counted.collect::<Result<_, _>>()?;
            let waiting = (!self.quiet).then(|| Waiting::on("drawing from the prior".to_owned()));
            let (mut values, mut all) = (vec![Vec::new(); counted.len()], vec![0.0; scalars.len()]);
            let tally = why::of_prior(&scene, recipe.scenario.sampler.seed, draws, |state| {
                if !counted.is_empty() {
                    scene.write_scalars(state, &mut all);
                }
                values.iter_mut().zip(&counted).for_each(|(values, &number)| values.push((1, all[number])));
            });
            drop(waiting);
            let tally = tally.map_err(|error| Failure::Message(format!("{name}: {error}")))?;
            let counts: Result<Vec<Histogram>, String> = counted
                .iter()
                .zip(&values)
                .map(|(&number, values)| Histogram::of(&scalars[number], self.bin, true, values.iter().copied()))
                .collect();
            let counts = counts.map_err(Failure::Message)?.into_iter();
            let text = match self.json {
                true => {
                    let mut object = why::to_json(&scene, &tally);
                    object["counts"] = counts.map(|one| one.to_json()).collect();
                    format!("{object}\n")
                }
                false => {
                    let asks =
                        if tally.clauses.is_empty() { String::new() } else { why::in_words(&scene, &tally, "draws") };
                    counts.fold(asks, |text, one| format!("{text}\n{}", one.in_words()))
                }
            };
            output::print(text.trim_start())?;
            return Ok(Outcome::Done);
        }
        if !self.quiet {
            self.describe(&recipe, &scene, &manifest)?;
        }
        Ok(Outcome::Done)
    }

    /// Shows what a valid scenario says, and what is strange about it.
    fn describe(&self, recipe: &Recipe, scene: &Stage, manifest: &Manifest) -> Result<(), Failure> {
        let of_role = |role: &str| -> Vec<&str> {
            let of_it = manifest.scalars.iter().filter(|scalar| scalar.role == role);
            of_it.map(|scalar| scalar.name.as_str()).collect()
        };
        let uncertain = shortened(&of_role("draw"), self.all);
        console::note_line(&format!("{} is valid; uncertain: {uncertain}", self.scenario.display()));
        if self.all {
            let (moves, outcomes) = (manifest.moves.join(", "), of_role("outcome").join(", "));
            console::note_line(&format!("moves: {moves}; outcomes: {outcomes}"));
        }
        // A draw that cannot be simulated is reported where it matters, in a run.
        let tried = why::some_of_prior(scene, recipe.scenario.sampler.seed, TRIED);
        if let Some(tally) = tried.ok().filter(|tally| tally.states >= ENOUGH) {
            let draws = counted(tally.states, "random draw");
            if tally.failures.failed() > 0 {
                console::remark(&tally.failures.to_string());
            }
            for never in why::never_met(scene, &tally) {
                console::remark(&format!("none of {draws} meets {never}"));
            }
        }
        if self.all {
            console::note_line("With all keys in force:");
            return output::print(&manifest.scenario.effective);
        }
        console::note_line("What it says (`--all` shows the defaults too):");
        output::print(&recipe.scenario.said(&recipe.text, &recipe.overrides))
    }
}

/// Names with commas, the first few of many.
fn shortened(names: &[&str], all: bool) -> String {
    match names {
        [] => "nothing".to_owned(),
        _ if all || names.len() <= SHOWN => names.join(", "),
        _ => format!("{}, and {} more", names[..SHOWN].join(", "), names.len() - SHOWN),
    }
}

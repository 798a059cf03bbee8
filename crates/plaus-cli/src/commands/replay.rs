//! `plaus replay`

use super::summary;
use crate::console;
use crate::failure::{Failure, Outcome};
use crate::output;
use crate::scenario_file;
use plaus_export::{Clip, Cut, Label, table};
use plaus_gallery::label;
use plaus_gallery::live::{Found, Saved};
use plaus_mcmc::Goal;
use plaus_run::replay::{Replay, replay, replay_at};
use plaus_run::{Run, SampleId};
use plaus_scenes::{AccuracyPreset, Scene};
use serde_json::{Map, Value, json};
use std::path::PathBuf;

/// Which sample.
#[derive(clap::Args)]
pub(crate) struct Args {
    /// Folder of the run, or a file that a live page saved
    run: PathBuf,
    /// The sample as CHAIN:DRAW, as in the table of `plaus export`, e.g. 0:17; 0:w17 is one from the warm-up
    #[arg(long, value_name = "CHAIN:DRAW")]
    sample: SampleId,
    /// Poses per second, besides those at every impact
    #[arg(long, default_value_t = 60.0)]
    fps: f64,
    /// csv or json
    #[arg(long, value_enum, default_value_t = Format::Csv)]
    format: Format,
    /// Simulate the same draw at another accuracy: draft, standard, fine or reference
    #[arg(long, value_name = "PRESET")]
    accuracy: Option<AccuracyPreset>,
}

/// What the columns of the table mean.
const AXES: &str = "t in seconds; x, y, z of each body's middle in metres, y up (a scenario's x is x, its height z is y, \
                    its y is −z); qx, qy, qz, qw its rotation as a unit quaternion; impact: whether it hits something \
                    then; origin_x, origin_y, origin_z: the point that a scenario gives places for";

/// How the motion is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum Format {
    /// Rows of t,body,x,y,z,qx,qy,qz,qw,impact,origin_x,origin_y,origin_z: seconds and metres, y up, of each body's
    /// middle and of its origin, and orientations as unit quaternions. A scenario's x is x here, its height z is y, and
    /// its y is −z.
    Csv,
    /// One JSON object: the sample, its poses, its impacts, and the motion in closed form.
    Json,
}

impl Args {
    pub(super) fn run(self) -> Result<Outcome, Failure> {
        if self.run.is_file() && self.run.extension().is_some_and(|end| end == "json") {
            return self.saved();
        }
        let run = Run::open(&super::run_at(&self.run)?)?;
        scenario_file::tell_edited(run.manifest(), &self.run);
        let reader = run.reader()?;
        let replay = match self.accuracy {
            Some(accuracy) => replay_at(&reader, self.sample, accuracy)?,
            None => replay(&reader, self.sample)?,
        };
        self.print(&replay, || label::of(run.manifest(), &replay).facts)?;
        if matches!(self.format, Format::Csv) && self.accuracy.is_none() {
            let command = summary::export_of(&console::quoted(&self.run), "glb", self.sample);
            console::note_line(&format!("as a file for Blender, engines or browsers: {command}"));
        }
        Ok(Outcome::Done)
    }

    /// Rebuilds a draw of a file.
    fn saved(&self) -> Result<Outcome, Failure> {
        let wrong = |message: String| Failure::Message(format!("{}: {message}", self.run.display()));
        if self.accuracy.is_some() {
            return Err(wrong("--accuracy is for runs".to_owned()));
        }
        let text = std::fs::read_to_string(&self.run).map_err(|error| wrong(error.to_string()))?;
        let saved = Saved::read(&text).map_err(wrong)?;
        let id = self.sample.to_string();
        let found = saved.draw(&id).ok_or_else(|| {
            let some: Vec<String> = saved.draws.iter().take(8).map(Found::id).collect();
            wrong(format!("has no sample {id}; it has {}: {} …", saved.draws.len(), some.join(", ")))
        })?;
        let scenario = saved.world.scenario().map_err(|error| wrong(error.to_string()))?;
        let stage = scenario.stage().map_err(|error| wrong(error.to_string()))?;
        let state = found.state(&stage).map_err(wrong)?;
        let names = stage.scalars().into_iter().map(|scalar| scalar.name);
        let mut values = vec![0.0; names.len()];
        stage.write_scalars(state.by_ref(), &mut values);
        let replay = Replay {
            sample: self.sample,
            iteration: found.iteration,
            log_p: state.log_p().value(),
            log_prior: state.log_prior.value(),
            log_constraint: state.log_constraint.value(),
            satisfied: stage.class(state.by_ref()).is_some(),
            scalars: names.zip(values).collect(),
            animation: stage.animate(&state.draw).map_err(|error| wrong(error.to_string()))?,
            recorded: None,
        };
        let world = [("plaus", json!(saved.plaus)), ("scene", json!(scenario.world.name()))];
        let facts = || world.into_iter().map(|(name, value)| (name.to_owned(), value)).chain(label::facts(&replay));
        self.print(&replay, || facts().collect())?;
        Ok(Outcome::Done)
    }

    fn print(&self, replay: &Replay, facts: impl FnOnce() -> Map<String, Value>) -> Result<(), Failure> {
        let cut = Cut::new(self.fps, None, &replay.animation).map_err(|error| Failure::Message(error.to_string()))?;
        let label = Label::default();
        let clip = Clip::new(&replay.animation, &label, cut);
        match self.format {
            Format::Csv => {
                console::note_line(AXES);
                let mut rows = format!("{}\n", table::POSES).into_bytes();
                table::write_poses(&mut rows, &clip, "").map_err(Failure::of_output)?;
                output::print(&String::from_utf8_lossy(&rows))?;
            }
            Format::Json => {
                let poses = table::poses_to_json(&clip);
                output::print_line(&to_json(facts(), replay, poses).to_string())?;
            }
        }
        console::note_line(&closing(replay));
        Ok(())
    }
}

fn closing(replay: &Replay) -> String {
    let Replay { sample, log_p, satisfied, .. } = replay;
    let is = |satisfied| if satisfied { "satisfies" } else { "does not satisfy" };
    match replay.recorded {
        None => format!("sample {sample} rebuilt bit for bit: log p {log_p:?}, {} the constraint", is(*satisfied)),
        Some(recorded) => format!(
            "sample {sample} simulated at {} accuracy: log p {log_p:?}, {} the constraint; as \
             recorded: log p {:?}, {} it",
            recorded.accuracy.name(),
            is(*satisfied),
            recorded.log_p,
            is(recorded.satisfied),
        ),
    }
}

/// The facts about the sample, and its whole motion.
fn to_json(mut all: Map<String, Value>, replay: &Replay, poses: Value) -> Value {
    let motion = [
        ("impacts", json!(replay.animation.motion.impacts)),
        ("contacts", json!(replay.animation.motion.contacts)),
        ("poses", poses),
        ("tracks", json!(replay.animation.motion.tracks)),
        ("scenery", json!(replay.animation.scenery)),
    ];
    all.extend(motion.map(|(name, value)| (name.to_owned(), value)));
    all.into()
}

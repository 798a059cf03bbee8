//! `plaus replay`

use crate::console;
use crate::failure::{Failure, Outcome};
use plaus_export::{Clip, Cut, Label, table};
use plaus_run::replay::{Replay, replay};
use plaus_run::{Error, Folder, Manifest, Run, RunOf, RunVisitor, SampleId};
use plaus_scenes::Scene;
use serde_json::json;
use std::path::PathBuf;

/// Which sample.
#[derive(clap::Args)]
pub(crate) struct Args {
    /// Folder of the run
    run: PathBuf,
    /// The sample: its chain and its draw, as in the table of `plaus export`, e.g. 0:17
    #[arg(long, value_name = "CHAIN:DRAW")]
    sample: SampleId,
    /// Poses per second, besides those at every impact
    #[arg(long, default_value_t = 60.0)]
    fps: f64,
    /// csv or json
    #[arg(long, value_enum, default_value_t = Format::Csv)]
    format: Format,
}

/// A format of animation.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum Format {
    /// Rows of t,body,x,y,z,qx,qy,qz,qw,impact: seconds and metres, y up, and orientations as unit quaternions.
    Csv,
    /// One JSON object: the sample, its poses, its impacts, and the motion in closed form.
    Json,
}

struct Rebuild(SampleId);

impl RunVisitor for Rebuild {
    type Output = Result<Replay, Error>;
    fn visit<S: Scene>(self, run: RunOf<'_, S>) -> Self::Output {
        replay(&run, self.0)
    }
}

impl Args {
    pub(super) fn run(self) -> Result<Outcome, Failure> {
        let run = Run::open(&Folder::new(&self.run))?;
        let replay = run.visit(Rebuild(self.sample))??;
        let cut = Cut::new(self.fps, None, &replay.animation).map_err(|error| Failure::Message(error.to_string()))?;
        let clip = Clip { animation: &replay.animation, label: &Label::default(), cut };
        match self.format {
            Format::Csv => {
                let mut rows = format!("{}\n", table::POSES).into_bytes();
                table::write_poses(&mut rows, &clip, "").map_err(Failure::of_output)?;
                console::print(&String::from_utf8_lossy(&rows))?;
            }
            Format::Json => {
                let poses = table::poses_to_json(&clip);
                console::print_line(&to_json(run.manifest(), &replay, &poses).to_string())?;
            }
        }
        let Replay { sample, log_p, satisfied, .. } = replay;
        let is = if satisfied { "satisfies" } else { "does not satisfy" };
        console::note_line(&format!("sample {sample} rebuilt bit for bit: log p {log_p:?}, {is} the constraint"));
        Ok(Outcome::Done)
    }
}

fn to_json(manifest: &Manifest, replay: &Replay, poses: &serde_json::Value) -> serde_json::Value {
    json!({
        "scene": manifest.scene,
        "seed": manifest.plan.seed,
        "scenario_hash": manifest.scenario.hash,
        "sample": replay.sample.to_string(),
        "chain": replay.sample.chain,
        "draw": replay.sample.draw,
        "iteration": replay.iteration,
        "log_p": replay.log_p,
        "log_prior": replay.log_prior,
        "log_constraint": replay.log_constraint,
        "satisfied": replay.satisfied,
        "scalars": replay.scalars.iter().map(|(name, value)| (name.clone(), json!(value))).collect::<serde_json::Value>(),
        "duration": replay.animation.duration,
        "impacts": replay.animation.impacts,
        "poses": poses,
        "tracks": replay.animation.tracks,
        "scenery": replay.animation.scenery,
    })
}

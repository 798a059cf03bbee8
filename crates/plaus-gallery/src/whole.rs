//! All solutions of a page, with what it says about itself.

use crate::Options;
use crate::map::Maps;
use crate::models::Bytes;
use crate::pack::{self, Ranges, Shared, Shown};
use crate::page::Packed;
use crate::{label, words};
use plaus_export::Label;
use plaus_run::RunReader;
use plaus_run::replay::Replay;
use plaus_scenes::animation::View;
use plaus_scenes::{Scalar, Scene, Until};
use serde_json::{Value, json};

/// What the page says about itself.
pub(crate) struct About<'a> {
    pub(crate) options: &'a Options,
    pub(crate) distinct: usize,
    pub(crate) candidates: usize,
    pub(crate) live: Option<String>,
    pub(crate) until: Until,
}

pub(crate) fn pack(run: &RunReader<'_>, replays: &[Replay], maps: &Maps, about: &About<'_>) -> Packed {
    let (mut bytes, mut shared) = (Bytes::default(), Shared::default());
    let ranges = Ranges::of(replays.iter().map(|replay| &replay.animation));
    let mut samples = Vec::new();
    let scalars = run.scene().scalars();
    for (number, replay) in replays.iter().enumerate() {
        let mut sample = pack::of_one(&shown(run, replay, &scalars), &ranges, &mut bytes, &mut shared);
        sample["outcome"] = json!(maps.outcomes[number]);
        sample["path"] = json!(maps.paths[number]);
        // As text: numbers of 64 bits must not become JavaScript's.
        let Label { name, facts } = label::of(run.run().manifest(), replay);
        sample["label"] = json!(json!({"name": name, "facts": facts}).to_string());
        samples.push(sample);
    }
    let Shared { things, sounds, names } = shared;
    let manifest = run.run().manifest();
    let scalars = words::columns(&scalars, &run.run().scenario().to_value()["require"]);
    let view = replays.iter().filter_map(|replay| replay.animation.view).reduce(both);
    let (scene, file) = (manifest.scene.as_str(), manifest.scenario.file.as_str());
    let set = manifest.said().map(|set| format!(" --set {set}")).collect::<String>();
    let title = match scene {
        "custom" => format!("{file}{set} · plaus"),
        scene => format!("{scene} · {file}{set} · plaus"),
    };
    let name = manifest.name();
    let mut meta = json!({
        "plaus": manifest.plaus,
        "name": name,
        "scene": manifest.scene,
        "scenario": manifest.scenario.file,
        "overrides": manifest.said().collect::<Vec<_>>(),
        "hash": manifest.scenario.hash,
        "seed": manifest.plan.seed,
        "chains": manifest.plan.chains,
        "run": about.options.run,
        "until": match about.until {
            Until::Rest => Value::Null,
            Until::Decided => json!("decided"),
            Until::Time(seconds) => json!(format!("{seconds}s")),
        },
        "distinct": about.distinct,
        "candidates": about.candidates,
        "scalars": scalars,
        "names": names,
        "models": things.model_list,
        "props": things.prop_list,
        "sounds": sounds.list,
        "low": ranges.low.to_array(),
        "high": ranges.high.to_array(),
        "velocity": ranges.velocity,
        "acceleration": ranges.acceleration,
        "spin": ranges.spin,
        "samples": samples,
        "live": about.live.is_some().then(|| json!({"independent": manifest.is_independent()})),
    });
    if let (Some(meta), Some(Value::Object(view))) = (meta.as_object_mut(), view.as_ref().map(pack::view)) {
        meta.extend(view);
    }
    Packed { meta, bytes: bytes.0, name, title, live: about.live.clone() }
}

/// A recorded solution.
fn shown<'a>(run: &RunReader<'_>, replay: &'a Replay, all: &[Scalar]) -> Shown<'a> {
    let Replay { sample, iteration, log_p, log_prior, log_constraint, scalars, animation, .. } = replay;
    Shown {
        id: sample.to_string(),
        chain: sample.chain,
        draw: sample.draw,
        phase: json!(sample.phase),
        iteration: *iteration,
        log_p: *log_p,
        log_prior: *log_prior,
        log_constraint: *log_constraint,
        scalars: pack::without_details(all, scalars.iter().map(|(_, value)| *value)),
        times: run.scene().times(animation),
        animation,
    }
}

/// A view that shows everything that either of the two shows.
fn both(one: View, other: View) -> View {
    let frame = match (one.frame, other.frame) {
        (Some([a, b]), Some([c, d])) => Some([a.min(b).min(c).min(d), a.max(b).max(c).max(d)]),
        (frame, None) | (None, frame) => frame,
    };
    View { frame, alone: one.alone && other.alone, ..one }
}

//! Small animations for games: JSON with keys as whole numbers.

use super::{Collection, Exporter, Row};
use crate::clip::{Clip, ExportError};
use crate::keys::of_track;
use crate::{ours, thin};
use glam::DVec3;
use plaus_animation::{Colour, Shape, Track};
use serde_json::{Value, json};
use std::io::Write;
use std::path::Path;

pub(super) struct Json;

/// Beginning of such a file.
const HEAD: &str = "{\"plaus_motion\":1,";
/// A millisecond has this many time units.
const TIME: f64 = 128.0;
/// Largest number of a share.
const FULL: f64 = 32767.0;

impl Exporter for Json {
    fn row(&self) -> &'static Row {
        &Row {
            name: "json",
            endings: &["json"],
            about: "compact motion for games: whole numbers, a throw of a die in a few kB",
            help: "For each clip and body, keys as differences of whole numbers: times in units of 1/128 ms, \
                   positions in steps of `step` metres, quaternions in units of 1/32767; straight lines between them, \
                   as for glb; a body with `appears` is not there before that time. docs/engines.md has a \
                   reader of 40 lines.",
        }
    }

    fn begin(&self, _path: &Path) -> Box<dyn Collection> {
        Box::new(Clips { begun: false })
    }

    fn is_ours(&self, path: &Path) -> bool {
        ours::begins_with(path, HEAD.as_bytes())
    }
}

struct Clips {
    begun: bool,
}

impl Collection for Clips {
    fn add(&mut self, clip: &Clip<'_>, out: &mut dyn Write) -> Result<(), ExportError> {
        let begin = format!("{HEAD}\"clips\":[\n");
        let before = if std::mem::replace(&mut self.begun, true) { ",\n" } else { &begin };
        let bodies: Vec<Value> = clip.animation.motion.tracks.iter().map(|track| body(clip, track)).collect();
        let facts = ["sample", "seed", "log_p", "scalars"];
        let facts = facts.map(|fact| clip.label.facts.get(fact).cloned().unwrap_or(Value::Null));
        let [sample, seed, log_p, scalars] = facts;
        let one = json!({"name": clip.label.name, "sample": sample, "seed": seed, "log_p": log_p, "scalars": scalars,
            "duration": clip.cut.length(), "bodies": bodies});
        Ok(write!(out, "{before}{one}")?)
    }

    fn finish(self: Box<Self>, out: &mut dyn Write) -> Result<(), ExportError> {
        if !self.begun {
            write!(out, "{HEAD}\"clips\":[")?;
        }
        Ok(writeln!(out, "]}}")?)
    }
}

/// A body: its shape, and its keys as differences from one to the next.
fn body(clip: &Clip<'_>, track: &Track) -> Value {
    let keys = of_track(clip.animation, track, &clip.cut);
    let time = |time: f64| ((time - clip.cut.from()) * 1000.0 * TIME).round() as i64;
    let places = thin::places(track, &keys, 0.0);
    // A tenth of the tolerance of straight lines.
    let step = 0.1 * thin::tolerance(track.shape.reach());
    let whole = |place: DVec3| place.to_array().map(|x| (x / step).round() as i64);
    let mut body = json!({"name": track.name, "colour": hex(track.look.colour), "shape": form(&track.shape), "step": step,
        "t": differences(places.iter().map(|key| [time(key.0)])),
        "p": differences(places.iter().map(|key| whole(key.1)))});
    if let Some(at) = track.appears() {
        body["appears"] = time(at).into();
    }
    if track.turns() {
        let turns = thin::turns(track, &keys, 0.0);
        body["tq"] = differences(turns.iter().map(|key| [time(key.0)]));
        body["q"] = differences(turns.iter().map(|key| key.1.to_array().map(|x| (x * FULL).round() as i64)));
    }
    body
}

/// Numbers in a row, each minus the previous one.
fn differences<const N: usize>(keys: impl Iterator<Item = [i64; N]>) -> Value {
    let mut last = [0; N];
    let mut all = Vec::new();
    for key in keys {
        all.extend((0..N).map(|part| key[part] - last[part]));
        last = key;
    }
    all.into()
}

fn hex(Colour([red, green, blue]): Colour) -> String {
    format!("#{red:02x}{green:02x}{blue:02x}")
}

/// The shape, as far as a game needs it for drawing.
fn form(shape: &Shape) -> Value {
    match shape {
        Shape::Sphere { radius, .. } => json!({"ball": radius}),
        Shape::Disc { radius, thickness } => json!({"disc": [radius, thickness]}),
        Shape::Cuboid { half, pips } => json!({"box": (2.0 * *half).to_array(), "pips": pips}),
        Shape::Revolution { profile, .. } => json!({"lathe": profile}),
        Shape::Solid { vertices, triangles } => {
            let corners: Vec<[f64; 3]> = vertices.iter().map(|vertex| vertex.to_array()).collect();
            json!({"solid": {"corners": corners, "triangles": triangles}})
        }
    }
}

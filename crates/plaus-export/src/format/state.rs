//! The state in which an animation leaves its bodies: what another world starts from.

use super::{Collection, Exporter, Row};
use crate::clip::{Clip, ExportError};
use crate::ours;
use plaus_animation::Left;
use serde_json::{Value, json};
use std::io::Write;
use std::path::Path;

pub(super) struct State;

/// Beginning of such a file.
const HEAD: &str = "{\"plaus_state\":1,";

impl Exporter for State {
    fn row(&self) -> &'static Row {
        &Row {
            name: "state",
            endings: &["json"],
            about: "where each body is at the end and how it moves, for `start_from` of another world",
            help: "For each body of a world of your own that follows no keyframes, in the axes and units of scenario \
                   files and to the last bit: at_mm of its origin, its orientation as a quaternion x, y, z, w, the \
                   velocity_m_s of its centre of gravity, and its spin_deg_s. --until chooses the time.",
        }
    }

    fn begin(&self, _path: &Path) -> Box<dyn Collection> {
        Box::new(One)
    }

    fn is_ours(&self, path: &Path) -> bool {
        ours::begins_with(path, HEAD.as_bytes())
    }

    fn most(&self) -> usize {
        1
    }
}

struct One;

impl Collection for One {
    fn add(&mut self, clip: &Clip<'_>, out: &mut dyn Write) -> Result<(), ExportError> {
        let refused = |why: &str| Err(ExportError::Impossible(why.to_owned()));
        if clip.cut.from() > 0.0 || clip.cut.to() < clip.animation.motion.duration {
            return refused("a state is that at the end: choose the time by `--until 1.5s`, not by --time-range");
        }
        let Some(first) = clip.animation.left.first() else {
            return refused("only a world of your own with bodies that follow no keyframes has a state to go on from");
        };
        let sample = clip.label.facts.get("sample").unwrap_or(&Value::Null);
        let time = first.time;
        writeln!(out, "{HEAD}\"name\":{},\"sample\":{sample},\"time_s\":{time:?},", json!(clip.label.name))?;
        let bodies: Vec<String> = clip.animation.left.iter().map(|left| body(left).to_string()).collect();
        Ok(writeln!(out, "\"bodies\":[\n{}\n]}}", bodies.join(",\n"))?)
    }

    fn finish(self: Box<Self>, _: &mut dyn Write) -> Result<(), ExportError> {
        Ok(())
    }
}

/// A body in the units of scenario files.
fn body(left: &Left) -> Value {
    let degrees = left.spin.to_array().map(f64::to_degrees);
    json!({"name": left.name, "at_mm": (left.position * 1e3).to_array(), "orientation": left.orientation.to_array(),
        "velocity_m_s": left.velocity.to_array(), "spin_deg_s": degrees})
}

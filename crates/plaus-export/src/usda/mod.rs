//! USD as text: opens in usdview, Blender, Houdini, Omniverse and Maya.
//!
//! A body is an animated `Xform` with its geometry, uniquely named, under it; time samples lie at every frame, at the begin of every piece of the motion
//! and at every impact, in between USD interpolates linearly. The label's facts are the layer's custom data.

mod geometry;

use crate::clip::Clip;
use crate::keys::{of_track, orientations};
use glam::DQuat;
use plaus_animation::Track;
use serde_json::Value;
use std::collections::BTreeSet;
use std::fmt::Write as _;

/// Says who made a file; exports replace only files that begin so.
pub const HEAD: &str = concat!("#usda 1.0\n# made by plaus ", env!("CARGO_PKG_VERSION"));
/// Begin of [`HEAD`] whatever the version.
pub const HEAD_OF_ANY_VERSION: &str = "#usda 1.0\n# made by plaus ";

/// Text in the making. Writing to a string cannot fail.
struct Text(String);

impl Text {
    fn line(&mut self, depth: usize, text: &str) {
        let _ = writeln!(self.0, "{:1$}{text}", "", 4 * depth);
    }
}

/// The text of a USDA file.
#[must_use]
pub fn to_string(clip: &Clip<'_>) -> String {
    let mut text = Text(String::new());
    let fps = clip.cut.fps();
    let last = (clip.cut.to() - clip.cut.from()) * fps;
    text.line(0, HEAD);
    text.line(0, "(");
    text.line(1, "customLayerData = {");
    text.line(2, &format!("string \"plaus:name\" = {}", quoted(&clip.label.name)));
    for (key, value) in &clip.label.facts {
        text.line(2, &fact(key, value));
    }
    text.line(1, "}");
    for line in ["defaultPrim = \"plaus\"", "metersPerUnit = 1", "upAxis = \"Y\"", "startTimeCode = 0"] {
        text.line(1, line);
    }
    text.line(1, &format!("endTimeCode = {last}"));
    text.line(1, &format!("timeCodesPerSecond = {fps}"));
    text.line(1, &format!("framesPerSecond = {fps}"));
    text.line(0, ")\n");
    text.line(0, "def Xform \"plaus\" (\n    kind = \"component\"\n)\n{");
    let looks = geometry::Looks::of(clip.animation);
    looks.write(&mut text);
    let mut names = Names::default();
    for prop in &clip.animation.scenery {
        let name = names.unique(&prop.name);
        text.line(1, &format!("def Xform \"{name}\"\n    {{"));
        geometry::form(&mut text, &name, &prop.form, prop.look, &looks);
        text.line(1, "}");
    }
    for track in &clip.animation.tracks {
        let name = names.unique(&track.name);
        text.line(1, &format!("def Xform \"{name}\"\n    {{"));
        motion(&mut text, clip, track);
        geometry::shape(&mut text, &name, &track.shape, track.look, &looks);
        text.line(1, "}");
    }
    text.line(0, "}");
    text.0
}

/// Time samples of a body.
fn motion(text: &mut Text, clip: &Clip<'_>, track: &Track) {
    let keys = of_track(clip.animation, track, &clip.cut);
    let code = |time: f64| (time - clip.cut.from()) * clip.cut.fps();
    text.line(2, "double3 xformOp:translate.timeSamples = {");
    for key in &keys {
        let p = key.position + 0.0;
        text.line(3, &format!("{}: ({}, {}, {}),", code(key.time), p.x, p.y, p.z));
    }
    text.line(2, "}");
    if track.turns() {
        text.line(2, "quatf xformOp:orient.timeSamples = {");
        for (time, orientation) in orientations(track, &keys) {
            let DQuat { x, y, z, w } = orientation;
            text.line(3, &format!("{}: ({}, {}, {}, {}),", code(time), w as f32, x as f32, y as f32, z as f32));
        }
        text.line(2, "}");
    }
    let order = if track.turns() { "\"xformOp:translate\", \"xformOp:orient\"" } else { "\"xformOp:translate\"" };
    text.line(2, &format!("uniform token[] xformOpOrder = [{order}]"));
}

/// A fact as a typed entry of a dictionary; what has no simple type is text.
fn fact(key: &str, value: &Value) -> String {
    let key = quoted(&format!("plaus:{key}"));
    match value {
        Value::Bool(value) => format!("bool {key} = {value}"),
        Value::Number(number) => match number.as_i64().and_then(|whole| i32::try_from(whole).ok()) {
            Some(whole) => format!("int {key} = {whole}"),
            None if number.is_f64() => format!("double {key} = {number}"),
            None => format!("string {key} = \"{number}\""),
        },
        Value::String(text) => format!("string {key} = {}", quoted(text)),
        other => format!("string {key} = {}", quoted(&other.to_string())),
    }
}

fn quoted(text: &str) -> String {
    let mut quoted = String::from("\"");
    for c in text.chars() {
        match c {
            '"' | '\\' => quoted.extend(['\\', c]),
            '\n' => quoted.push_str("\\n"),
            c if c.is_control() => quoted.push(' '),
            c => quoted.push(c),
        }
    }
    quoted.push('"');
    quoted
}

/// Names of prims: letters, digits and underscores, not beginning with a digit, and each once.
#[derive(Default)]
struct Names(BTreeSet<String>);

impl Names {
    fn unique(&mut self, wanted: &str) -> String {
        let mut name: String = wanted.chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '_' }).collect();
        if !name.starts_with(|c: char| c.is_ascii_alphabetic() || c == '_') {
            name.insert(0, '_');
        }
        while !self.0.insert(name.clone()) {
            name.push('_');
        }
        name
    }
}

//! Keys of bodies as channels of animations.

use super::blob::pushed;
use super::file::Document;
use crate::clip::{Between, Clip, Engines, Style, Up};
use crate::keys::{Key, of_track, orientations};
use crate::thin;
use glam::{DQuat, DVec3};
use plaus_animation::{Track, UPRIGHT};
use serde_json::{Map, Value, json};
use std::f64::consts::FRAC_PI_2;

/// The unfinished animation of one clip.
pub(super) struct Channels {
    name: String,
    extras: Map<String, Value>,
    channels: Vec<Value>,
    samplers: Vec<Value>,
}

impl Channels {
    pub(super) fn new(name: &str, extras: Map<String, Value>) -> Self {
        Self { name: name.to_owned(), extras, channels: Vec::new(), samplers: Vec::new() }
    }

    /// Whether a node is turned.
    pub(super) fn turns(&self, node: usize) -> bool {
        self.channels.iter().any(|channel| channel["target"] == json!({"node": node, "path": "rotation"}))
    }

    /// Whether a node appears in the course of it.
    pub(super) fn appears(&self, node: usize) -> bool {
        self.channels.iter().any(|channel| channel["target"] == json!({"node": node, "path": "scale"}))
    }

    /// A constant value of a node.
    pub(super) fn still<const N: usize>(&mut self, document: &mut Document, node: usize, path: &str, value: &[f32; N]) {
        let io = document.still(value);
        self.push(node, path, io, "STEP");
    }

    fn push(&mut self, node: usize, path: &str, [input, output]: [usize; 2], interpolation: &str) {
        let sampler = json!({"input": input, "interpolation": interpolation, "output": output});
        let sampler = pushed(&mut self.samplers, sampler);
        self.channels.push(json!({"sampler": sampler, "target": {"node": node, "path": path}}));
    }

    /// Puts it into the document, if anything is animated.
    pub(super) fn finish(self, document: &mut Document) {
        let Self { name, extras, channels, samplers } = self;
        if !channels.is_empty() {
            let animation = json!({"name": name, "channels": channels, "samplers": samplers, "extras": extras});
            document.animations.push(animation);
        }
    }
}

/// The axes and units of keys: those of the animation, in metres; or, for a body that is the root node, those of the
/// style.
#[derive(Clone, Copy)]
pub(super) struct Frame {
    turn: DQuat,
    pub(super) scale: f64,
    /// From the axes of nodes of bodies to the bodies' own. For physics engines, whose solids have their axes along y,
    /// y points up in a body that is not turned.
    own: DQuat,
}

impl Frame {
    pub(super) fn of(style: Style) -> Self {
        let own = if style.engines == Engines::Nothing { DQuat::IDENTITY } else { UPRIGHT.conjugate() };
        let (turn, scale) = if style.root_motion { (turn(style.up), style.scale) } else { (DQuat::IDENTITY, 1.0) };
        Self { turn, scale, own }
    }

    fn vector(self, v: DVec3) -> [f32; 3] {
        (self.scale * (self.turn * v)).as_vec3().to_array()
    }

    pub(super) fn quaternion(self, q: DQuat) -> [f32; 4] {
        (self.turn * q * self.own).as_quat().normalize().to_array()
    }

    /// From a body's own axes to those of its node.
    pub(super) fn of_node(self) -> DQuat {
        self.own.conjugate()
    }

    /// The node of a body, where the body is at `time`.
    pub(super) fn node_at(self, track: &Track, time: f64, name: String, mesh: Option<usize>) -> Value {
        let mut node = named(name, mesh);
        node["translation"] = json!(self.vector(track.position(time)));
        if track.turns() || self.turn * self.own != DQuat::IDENTITY {
            node["rotation"] = json!(self.quaternion(track.orientation(time)));
        }
        if track.origin != DVec3::ZERO {
            node["extras"] = json!({"origin": (self.of_node() * track.origin).as_vec3().to_array()});
        }
        node
    }
}

/// A node with a name, and with a mesh if it shows one.
pub(super) fn named(name: String, mesh: Option<usize>) -> Value {
    let mut node = json!({"name": name});
    if let Some(mesh) = mesh {
        node["mesh"] = mesh.into();
    }
    node
}

/// The rotation from an animation's y axis to the axis that points up.
pub(super) fn turn(up: Up) -> DQuat {
    if up == Up::Z { DQuat::from_rotation_x(FRAC_PI_2) } else { DQuat::IDENTITY }
}

/// Hides a body until it appears, if that is within the clip: `scale` is that of its node from then on.
pub(super) fn appear(
    document: &mut Document,
    channels: &mut Channels,
    clip: &Clip<'_>,
    (track, node): (&Track, usize),
    scale: f32,
) {
    let Some(time) = track.appears().filter(|time| *time > clip.cut.from()) else { return };
    if time > clip.cut.to() {
        return channels.still(document, node, "scale", &[0.0; 3]);
    }
    let io = document.keys(&[0.0, (time - clip.cut.from()) as f32], &[[0.0; 3], [scale; 3]]);
    channels.push(node, "scale", io, "STEP");
}

/// Adds the motion of a body to a clip's animation.
pub(super) fn animate(document: &mut Document, channels: &mut Channels, clip: &Clip<'_>, track: &Track, node: usize) {
    let (begin, keys) = (clip.cut.from(), of_track(clip.animation, track, &clip.cut));
    let frame = Frame::of(clip.style);
    let (times, values, interpolation) = match clip.style.keys {
        Between::Exact => {
            let (times, splines) = splines(&keys, begin, frame);
            (times, splines, "CUBICSPLINE")
        }
        Between::Linear => {
            let (times, places) = each(&thin::places(track, &keys, thin::APART), begin, |v| frame.vector(v));
            (times, places, "LINEAR")
        }
    };
    let io = document.keys(&times, &values);
    channels.push(node, "translation", io, interpolation);
    if track.turns() {
        let turns = match clip.style.keys {
            Between::Exact => orientations(track, &keys),
            Between::Linear => thin::turns(track, &keys, thin::APART),
        };
        let (times, values) = each(&turns, begin, |q| frame.quaternion(q));
        let io = document.keys(&times, &values);
        channels.push(node, "rotation", io, "LINEAR");
    }
}

impl Document {
    fn keys<const N: usize>(&mut self, times: &[f32], values: &[[f32; N]]) -> [usize; 2] {
        [self.blob.times(times), self.blob.values(values)]
    }

    /// One key at the beginning, stored once for all equal values.
    fn still<const N: usize>(&mut self, value: &[f32; N]) -> [usize; 2] {
        let found = self.stills.iter().find(|(known, _)| known == value).map(|(_, io)| *io);
        found.unwrap_or_else(|| {
            let io = self.keys(&[0.0], &[*value]);
            self.stills.push((value.to_vec(), io));
            io
        })
    }
}

/// Times, and for each key the tangent on arrival, the value, and the tangent on leaving. Keys that are equal in single
/// precision become one.
fn splines(keys: &[Key], begin: f64, frame: Frame) -> (Vec<f32>, Vec<[f32; 3]>) {
    let (mut times, mut splines) = (Vec::<f32>::new(), Vec::<[f32; 3]>::new());
    for key in keys {
        let time = (key.time - begin) as f32;
        if times.last() == Some(&time) {
            // It arrives like the first of the equal keys, and leaves like the last.
            splines.truncate(splines.len() - 2);
        } else {
            times.push(time);
            splines.push(frame.vector(key.arriving));
        }
        splines.extend([frame.vector(key.position), frame.vector(key.leaving)]);
    }
    (times, splines)
}

/// Times and values. Keys that are equal in single precision become one: the last.
fn each<T: Copy, const N: usize>(
    keys: &[(f64, T)],
    begin: f64,
    value: impl Fn(T) -> [f32; N],
) -> (Vec<f32>, Vec<[f32; N]>) {
    let (mut times, mut values) = (Vec::<f32>::new(), Vec::<[f32; N]>::new());
    for &(time, what) in keys {
        let time = (time - begin) as f32;
        if times.last() == Some(&time) {
            values.pop();
        } else {
            times.push(time);
        }
        values.push(value(what));
    }
    (times, values)
}

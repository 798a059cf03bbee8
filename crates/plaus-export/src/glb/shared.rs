//! Several clips in one file: each an animation, with bodies, scenery and materials that they share.
//!
//! Bodies of the same name are one node in all clips in which they look alike; balls of different radius are one node
//! with different scales. A body that is not in a clip has scale 0 there, as glTF recommends for hidden nodes. The
//! document shows the first clip, and an animation names only the nodes that differ from it. So a file grows with the
//! number of its clips, not with the square of that number.

use super::blob::pushed;
use super::file::Document;
use super::materials::unique;
use super::motion::{self, Channels, Frame};
use crate::clip::{Clip, Engines, ExportError, Label, Style, Up};
use crate::mesh;
use glam::{DQuat, DVec3};
use plaus_animation::{Look, Prop, Shape, Track};
use serde_json::{Map, Value, json};
use std::sync::Arc;

/// Makes a GLB file of one clip or of several.
///
/// ```
/// # use glam::DVec3;
/// # use plaus_animation::{Animation, Look, Piece, Shape, Track};
/// use plaus_export::{Clip, Cut, Label, glb};
///
/// # let fall = Piece::ballistic(0.0, DVec3::Y, DVec3::ZERO, DVec3::new(0.0, -9.81, 0.0));
/// # let animation = Animation::new(0.4, vec![Track::new("ball_0", Shape::ball(0.05), Look::nth(0), vec![fall])],
/// vec![]);
/// let mut writer = glb::Writer::default();
/// for name in ["first", "second"] {
///     writer.add(&Clip::new(&animation, &Label::new(name), Cut::new(60.0, None, &animation)?))?;
/// }
/// let bytes = writer.finish()?;
/// assert_eq!(&bytes[..4], b"glTF");
/// # Ok::<(), plaus_export::ExportError>(())
/// ```
#[derive(Default)]
pub struct Writer {
    pub(super) document: Document,
    pub(super) props: Vec<Thing<Prop>>,
    pub(super) bodies: Vec<Thing<Body>>,
    meshes: Vec<(Arc<Shape>, Look, Option<usize>)>,
    clips: Vec<Channels>,
    /// Other nodes beside them.
    pub(super) extra: Vec<usize>,
    labels: Vec<Label>,
    style: Style,
}

/// A body in the form in which it is drawn.
pub(super) struct Body {
    pub(super) name: String,
    shape: Arc<Shape>,
    look: Look,
    /// Whether it turns in any clip.
    turns: bool,
}

/// A node, and its scale in each clip: 0 in clips that it is not in.
pub(super) struct Thing<T> {
    pub(super) what: T,
    pub(super) node: usize,
    scales: Vec<f32>,
}

impl<T> Thing<T> {
    fn shown(&mut self, clip: usize, scale: f32) {
        self.scales.resize(clip, 0.0);
        self.scales.push(scale);
    }
}

impl Body {
    /// The scale at which this node can show a body; `None` if it cannot.
    fn scale(&self, track: &Track) -> Option<f64> {
        if self.name != track.name || self.look != track.look {
            return None;
        }
        match (&*self.shape, &*track.shape) {
            (a, b) if a == b => Some(1.0),
            (Shape::Sphere { radius: a, holes: c }, Shape::Sphere { radius: b, holes: d }) if c == d => Some(b / a),
            _ => None,
        }
    }
}

impl Writer {
    /// Adds a clip.
    ///
    /// # Errors
    /// [`ExportError::Impossible`] if root motion is asked for, and it is not of one body alone.
    pub fn add(&mut self, clip: &Clip<'_>) -> Result<(), ExportError> {
        let number = self.clips.len();
        self.style = clip.style;
        let (bodies, scenery) = (clip.animation.motion.tracks.len(), clip.animation.scenery.len());
        if clip.style.root_motion && (bodies, scenery) != (1, 0) {
            let message =
                format!("root motion is for one body alone: here are {bodies}, and {scenery} pieces of scenery");
            return Err(ExportError::Impossible(message));
        }
        let unit = Frame::of(clip.style).scale;
        for prop in &clip.animation.scenery {
            let known = self.props.iter().position(|thing| thing.what == *prop);
            let place = known.unwrap_or_else(|| self.new_prop(prop, clip));
            self.props[place].shown(number, 1.0);
        }
        let mut channels = Channels::new(&clip.label.name, clip.label.facts.clone());
        // Rods that are drawn of joints follow their bodies in clips alone.
        let is_shown = |track: &&Track| {
            let world = clip.physics.filter(|_| clip.style.engines == Engines::Alone);
            world.is_none_or(|world| world.bodies.iter().any(|body| body.name == track.name))
        };
        for track in clip.animation.motion.tracks.iter().filter(is_shown) {
            let known = self.bodies.iter().enumerate().find_map(|(place, thing)| {
                let free = thing.scales.len() <= number;
                thing.what.scale(track).filter(|_| free).map(|scale| (place, scale))
            });
            let (place, scale) = known.unwrap_or_else(|| (self.new_body(track, clip), 1.0));
            let body = &mut self.bodies[place];
            body.shown(number, (scale * unit) as f32);
            body.what.turns |= track.turns();
            let follows = |name: &str| clip.physics.is_some_and(|world| world.follows_keys(name));
            if clip.style.engines != Engines::Alone || follows(&track.name) {
                motion::animate(&mut self.document, &mut channels, clip, track, body.node);
                motion::appear(&mut self.document, &mut channels, clip, (track, body.node), (scale * unit) as f32);
            }
        }
        self.clips.push(channels);
        self.labels.push(clip.label.clone());
        Ok(())
    }

    fn new_prop(&mut self, prop: &Prop, clip: &Clip<'_>) -> usize {
        let place = clip.physics.and_then(|world| world.place_of(&prop.name));
        let mut part = mesh::of_form(&prop.form, prop.look);
        if let Some((at, turn)) = place {
            part.mesh.moved(-at, turn.conjugate());
        }
        let mesh = self.document.mesh(&prop.name, &[part]);
        let name = self.node_name(&prop.name, &clip.label.name);
        let mut node = motion::named(name, mesh);
        if let Some((at, turn)) = place {
            (node["translation"], node["rotation"]) = (json!(at.to_array()), json!(turn.to_array()));
        }
        let node = pushed(&mut self.document.nodes, node);
        self.props.push(Thing { what: prop.clone(), node, scales: Vec::new() });
        self.props.len() - 1
    }

    fn new_body(&mut self, track: &Track, clip: &Clip<'_>) -> usize {
        let known = self.meshes.iter().find(|(shape, look, _)| (shape, *look) == (&track.shape, track.look));
        let mesh = match known {
            Some(&(_, _, mesh)) => mesh,
            None => {
                let mut parts = mesh::of_shape(&track.shape, track.look);
                let turn = Frame::of(clip.style).of_node();
                parts.iter_mut().for_each(|part| part.mesh.moved(DVec3::ZERO, turn));
                let mesh = self.document.mesh(&track.name, &parts);
                self.meshes.push((track.shape.clone(), track.look, mesh));
                mesh
            }
        };
        let name = self.node_name(&track.name, &clip.label.name);
        let node = Frame::of(clip.style).node_at(track, clip.cut.from(), name, mesh);
        let node = pushed(&mut self.document.nodes, node);
        let what = Body { name: track.name.clone(), shape: track.shape.clone(), look: track.look, turns: false };
        self.bodies.push(Thing { what, node, scales: Vec::new() });
        self.bodies.len() - 1
    }

    /// The name of a thing; if another thing has it, with the name of its clip.
    fn node_name(&self, wanted: &str, clip: &str) -> String {
        let taken = |name: &str| self.document.nodes.iter().any(|node| node["name"] == name);
        let name = if taken(wanted) { format!("{wanted} {clip}") } else { wanted.to_owned() };
        unique(&name, " ", taken)
    }

    /// The bytes of the file.
    ///
    /// # Errors
    ///
    /// [`ExportError::TooLong`] if it would be longer than the format allows.
    pub fn finish(mut self) -> Result<Vec<u8>, ExportError> {
        self.show();
        let things = self.props.iter().map(|thing| thing.node).chain(self.bodies.iter().map(|thing| thing.node));
        let things = things.chain(self.extra.iter().copied());
        let (things, style): (Vec<_>, Style) = (things.collect(), self.style);
        let label = self.common();
        let nodes = if style.root_motion {
            things
        } else {
            vec![pushed(&mut self.document.nodes, root_node(&label, things, style))]
        };
        let mut scene = json!({"name": label.name});
        if !nodes.is_empty() {
            scene["nodes"] = nodes.into();
        }
        scene["extras"] = label.facts.into();
        for clip in self.clips {
            clip.finish(&mut self.document);
        }
        self.document.finish(scene)
    }

    /// Sets scales that differ between clips, and orientations of bodies that turn in some clips only.
    fn show(&mut self) {
        let (count, upright) = (self.clips.len(), Frame::of(self.style).quaternion(DQuat::IDENTITY));
        let nodes = &mut self.document.nodes;
        let (mut shown, mut still) = (Vec::new(), Vec::new());
        let bodies = self.bodies.iter_mut().map(|thing| (thing.node, &mut thing.scales, thing.what.turns));
        let props = self.props.iter_mut().map(|thing| (thing.node, &mut thing.scales, false));
        for (node, scales, turns) in bodies.chain(props) {
            scales.resize(count, 0.0);
            if scales.iter().any(|scale| *scale != 1.0) {
                nodes[node]["scale"] = vec![scales[0]; 3].into();
                // A node that an animation does not name stays as in the document.
                let others = scales.iter().enumerate().filter(|(_, scale)| **scale != scales[0]);
                shown.extend(others.map(|(clip, &scale)| (clip, node, scale)));
            }
            if turns {
                still.push(node);
            }
        }
        for (clip, node, scale) in shown {
            let channels = &mut self.clips[clip];
            if !channels.appears(node) {
                channels.still(&mut self.document, node, "scale", &[scale; 3]);
            }
        }
        for (clip, channels) in self.clips.iter_mut().enumerate() {
            for &node in &still {
                let shown = self.bodies.iter().any(|thing| thing.node == node && thing.scales[clip] > 0.0);
                if shown && !channels.turns(node) {
                    channels.still(&mut self.document, node, "rotation", &upright);
                }
            }
        }
    }

    /// The label of the file: that of its clip, or what all its clips have in common.
    fn common(&self) -> Label {
        let Some((first, others)) = self.labels.split_first() else { return Label::new("plaus") };
        if others.is_empty() {
            return first.clone();
        }
        let same = |(key, value): &(&String, &Value)| others.iter().all(|label| label.facts.get(*key) == Some(*value));
        let facts = first.facts.iter().filter(same).map(|(key, value)| (key.clone(), value.clone()));
        let mut facts: Map<String, Value> = facts.collect();
        facts.insert("clips".to_owned(), json!(self.labels.len()));
        let name = facts.get("scene").and_then(Value::as_str).unwrap_or("plaus").to_owned();
        Label { name, facts }
    }
}

/// The root node, which turns and scales everything below it according to the style.
fn root_node(label: &Label, children: Vec<usize>, style: Style) -> Value {
    let mut root = json!({"name": label.name});
    if !children.is_empty() {
        root["children"] = children.into();
    }
    root["extras"] = label.facts.clone().into();
    if style.up == Up::Z {
        root["rotation"] = json!(motion::turn(style.up).as_quat().to_array());
    }
    if style.scale != 1.0 {
        root["scale"] = vec![style.scale as f32; 3].into();
    }
    root
}

//! A layer of one clip or of several.

use super::HEAD;
use super::geometry::{self, Looks};
use super::text::{Names, PHYSICS, Text, fact, identifier, quoted};
use crate::clip::{Clip, Label, Style, Up};
use crate::keys::of_track;
use crate::thin;
use glam::DQuat;
use plaus_animation::{Look, Material, Prop, Shape, Track};
use std::sync::Arc;

/// Makes a USDA file of one clip, or of several as variants `solution` of one prim.
#[derive(Default)]
pub struct Writer {
    style: Style,
    names: Names,
    looks: Looks,
    props: Vec<Thing<Prop>>,
    bodies: Vec<Thing<Body>>,
    clips: Vec<Take>,
}

/// A clip's own part of the layer.
struct Take {
    name: String,
    label: Label,
    /// Its end in time codes.
    end: f64,
    motion: Vec<(usize, Text)>,
}

/// Something with a name, and the clips that it is in.
struct Thing<T> {
    name: String,
    what: T,
    clips: Vec<usize>,
}

struct Body {
    wanted: String,
    shape: Arc<Shape>,
    look: Look,
}

impl Writer {
    /// Adds a clip.
    pub fn add(&mut self, clip: &Clip<'_>) {
        let number = self.clips.len();
        self.style = clip.style;
        for prop in &clip.animation.scenery {
            let known = self.props.iter().position(|thing| thing.what == *prop);
            let place = known.unwrap_or_else(|| {
                self.looks.add(prop.look);
                let name = self.names.unique(&prop.name);
                self.props.push(Thing { name, what: prop.clone(), clips: Vec::new() });
                self.props.len() - 1
            });
            self.props[place].clips.push(number);
        }
        let mut motion = Vec::new();
        for track in &clip.animation.motion.tracks {
            let (place, scale) = self.body(number, track);
            self.bodies[place].clips.push(number);
            motion.push((place, samples(clip, track, scale)));
        }
        let end = clip.cut.length() * clip.style.time_codes;
        self.clips.push(Take { name: identifier(&clip.label.name), label: clip.label.clone(), end, motion });
    }

    /// The body that shows a track, and its scale.
    fn body(&mut self, number: usize, track: &Track) -> (usize, f64) {
        let alike = |thing: &Thing<Body>| {
            let body = &thing.what;
            let same = body.wanted == track.name && body.look == track.look && thing.clips.last() != Some(&number);
            match (&*body.shape, &*track.shape) {
                _ if !same => None,
                (a, b) if a == b => Some(1.0),
                (Shape::Sphere { radius: a, holes: c }, Shape::Sphere { radius: b, holes: d }) if c == d => Some(b / a),
                _ => None,
            }
        };
        let known = self.bodies.iter().enumerate().find_map(|(place, thing)| alike(thing).map(|scale| (place, scale)));
        known.unwrap_or_else(|| {
            self.looks.add_shape(&track.shape, track.look);
            let name = self.names.unique(&track.name);
            let what = Body { wanted: track.name.clone(), shape: track.shape.clone(), look: track.look };
            self.bodies.push(Thing { name, what, clips: Vec::new() });
            (self.bodies.len() - 1, 1.0)
        })
    }

    /// The text of the file.
    #[must_use]
    pub fn finish(self) -> String {
        let mut text = Text::default();
        self.head(&mut text);
        self.root(&mut text);
        self.looks.write(&mut text);
        text.line(1, &format!("def PhysicsScene \"{PHYSICS}\"\n    {{"));
        let down = if self.style.up == Up::Z { "(0, 0, -1)" } else { "(0, -1, 0)" };
        text.line(2, &format!("vector3f physics:gravityDirection = {down}"));
        text.line(2, &format!("float physics:gravityMagnitude = {}\n    }}", 9.81 * self.style.scale));
        let (count, single) = (self.clips.len(), self.clips.len() == 1);
        for prop in self.props.iter().filter(|prop| prop.clips.len() == count) {
            self.prop(&mut text, 1, prop);
        }
        for (place, body) in self.bodies.iter().enumerate() {
            text.line(1, &format!("def Xform \"{}\"\n    {{", body.name));
            if single {
                self.clips.iter().flat_map(|take| &take.motion).filter(|(of, _)| *of == place).for_each(
                    |(_, samples)| {
                        text.0.push_str(&samples.0);
                    },
                );
            }
            geometry::shape(&mut text, &body.name, &body.what.shape, body.what.look, &self.looks);
            text.line(1, "}");
        }
        if count > 1 {
            text.line(1, "variantSet \"solution\" = {");
            self.clips.iter().enumerate().for_each(|(number, take)| self.variant(&mut text, number, take));
            text.line(1, "}");
        }
        text.line(0, "}");
        text.0
    }

    fn head(&self, text: &mut Text) {
        let codes = self.style.time_codes;
        text.line(0, HEAD);
        text.line(0, "(");
        text.line(1, "customLayerData = {");
        if let [take] = &self.clips[..] {
            text.line(2, &format!("string \"plaus:name\" = {}", quoted(&take.label.name)));
            take.label.facts.iter().for_each(|(key, value)| text.line(2, &fact(key, value)));
        } else {
            text.line(2, &format!("int \"plaus:clips\" = {}", self.clips.len()));
        }
        text.line(1, "}");
        text.line(1, "defaultPrim = \"plaus\"");
        text.line(1, &format!("metersPerUnit = {}", 1.0 / self.style.scale));
        text.line(1, &format!("upAxis = \"{:?}\"", self.style.up));
        text.line(1, "startTimeCode = 0");
        text.line(1, &format!("endTimeCode = {}", self.clips.iter().map(|take| take.end).fold(0.0, f64::max)));
        text.line(1, &format!("timeCodesPerSecond = {codes}"));
        text.line(1, &format!("framesPerSecond = {codes}"));
        text.line(0, ")\n");
    }

    /// Opens the root prim, turned and scaled according to the style.
    fn root(&self, text: &mut Text) {
        text.line(0, "def Xform \"plaus\" (\n    kind = \"component\"");
        if let [first, _, ..] = &self.clips[..] {
            text.line(1, &format!("variants = {{\n        string solution = \"{}\"\n    }}", first.name));
            text.line(1, "prepend variantSets = \"solution\"");
        }
        text.line(0, ")\n{");
        let mut order = Vec::new();
        if self.style.up == Up::Z {
            text.line(1, "double xformOp:rotateX = 90");
            order.push("\"xformOp:rotateX\"");
        }
        if self.style.scale != 1.0 {
            text.line(1, &format!("float3 xformOp:scale = ({0}, {0}, {0})", self.style.scale));
            order.push("\"xformOp:scale\"");
        }
        if !order.is_empty() {
            text.line(1, &format!("uniform token[] xformOpOrder = [{}]", order.join(", ")));
        }
    }

    fn prop(&self, text: &mut Text, depth: usize, prop: &Thing<Prop>) {
        let solid = prop.what.look.material != Material::Mark;
        text.line(depth, &format!("def Xform \"{}\"\n    {{", prop.name));
        geometry::form(text, &prop.name, &prop.what.form, prop.what.look, solid, &self.looks);
        text.line(depth, "}");
    }

    /// The content of one clip only.
    fn variant(&self, text: &mut Text, number: usize, take: &Take) {
        text.line(2, &format!("\"{}\" (", take.name));
        text.line(3, "customData = {");
        take.label.facts.iter().for_each(|(key, value)| text.line(4, &fact(key, value)));
        text.line(4, &format!("double \"plaus:endTimeCode\" = {}", take.end));
        text.line(3, "}");
        text.line(2, ") {");
        for prop in self.props.iter().filter(|prop| prop.clips.len() < self.clips.len()) {
            if prop.clips.contains(&number) {
                self.prop(text, 1, prop);
            }
        }
        for (place, body) in self.bodies.iter().enumerate() {
            text.line(1, &format!("over \"{}\"\n    {{", body.name));
            match take.motion.iter().find(|(of, _)| *of == place) {
                Some((_, samples)) => text.0.push_str(&samples.0),
                None => text.line(2, "token visibility = \"invisible\""),
            }
            text.line(1, "}");
        }
        text.line(2, "}");
    }
}

/// Time samples of a body.
fn samples(clip: &Clip<'_>, track: &Track, scale: f64) -> Text {
    let mut text = Text::default();
    let keys = of_track(clip.animation, track, &clip.cut);
    let code = |time: f64| (time - clip.cut.from()) * clip.style.time_codes;
    if let Some(time) = track.appears().filter(|time| *time > clip.cut.from()) {
        text.line(2, "token visibility.timeSamples = {");
        text.line(3, "0: \"invisible\",");
        text.line(3, &format!("{}: \"inherited\",", code(time)));
        text.line(2, "}");
    }
    text.line(2, "double3 xformOp:translate.timeSamples = {");
    for (time, place) in thin::places(track, &keys, 0.0) {
        let p = place + 0.0;
        text.line(3, &format!("{}: ({}, {}, {}),", code(time), p.x, p.y, p.z));
    }
    text.line(2, "}");
    let mut order = vec!["\"xformOp:translate\""];
    if track.turns() {
        text.line(2, "quatf xformOp:orient.timeSamples = {");
        for (time, orientation) in thin::turns(track, &keys, 0.0) {
            let DQuat { x, y, z, w } = orientation;
            text.line(3, &format!("{}: ({}, {}, {}, {}),", code(time), w as f32, x as f32, y as f32, z as f32));
        }
        text.line(2, "}");
        order.push("\"xformOp:orient\"");
    }
    if scale != 1.0 {
        text.line(2, &format!("float3 xformOp:scale = ({0}, {0}, {0})", scale as f32));
        order.push("\"xformOp:scale\"");
    }
    text.line(2, &format!("uniform token[] xformOpOrder = [{}]", order.join(", ")));
    text
}

//! Animated glTF 2.0, binary: opens in browsers, Blender, Godot, Unity and Unreal.
//!
//! One node a body, with its name; one animation with the label's name. Translations are cubic splines with exact tangents: motion under constant
//! acceleration is a parabola, which such a spline holds exactly, so poses are right between keys too, at any frame rate. Rotations are keyed
//! so densely that the shortest turn between keys is the right one. The label's facts are the `extras` of the animation and of the scene's root.

mod blob;
mod godot;
mod materials;
mod motion;

pub use godot::godot_import;
pub(crate) use materials::{linear, surface};

use crate::clip::{Clip, ExportError};
use crate::mesh::{self, Part};
use blob::Blob;
use gltf_json::extras::RawValue;
use gltf_json::validation::Checked::Valid;
use gltf_json::{Asset, Index, Mesh, Node, Root, Scene, mesh::Mode, mesh::Primitive, mesh::Semantic};
use materials::Materials;
use plaus_animation::{Look, Shape};
use serde_json::{Map, Value};
use std::collections::BTreeMap;

/// Says who made a file; exports replace only files that say so.
pub const GENERATOR: &str = concat!("plaus ", env!("CARGO_PKG_VERSION"));
/// Begin of [`GENERATOR`] whatever the version.
pub const MADE_BY: &str = "plaus ";

/// A glTF document in the making.
#[derive(Default)]
struct Document {
    root: Root,
    blob: Blob,
    materials: Materials,
}

/// The bytes of a GLB file.
///
/// # Errors
/// [`ExportError::TooLong`] where it would be longer than the format can say.
pub fn to_vec(clip: &Clip<'_>) -> Result<Vec<u8>, ExportError> {
    let mut document = Document::default();
    document.root.asset = Asset { generator: Some(GENERATOR.to_owned()), ..Asset::default() };
    let mut children = Vec::new();
    for prop in &clip.animation.scenery {
        let mesh = document.mesh(&prop.name, &[mesh::of_form(&prop.form, prop.look)]);
        children.push(document.root.push(Node { mesh, name: Some(prop.name.clone()), ..Node::default() }));
    }
    let mut bodies: Vec<(&Shape, Look, Option<Index<Mesh>>)> = Vec::new();
    let mut nodes = Vec::new();
    for track in &clip.animation.tracks {
        let known = bodies.iter().find(|(shape, look, _)| (*shape, *look) == (&track.shape, track.look));
        let mesh = match known {
            Some(&(_, _, mesh)) => mesh,
            None => {
                let mesh = document.mesh(&track.name, &mesh::of_shape(&track.shape, track.look));
                bodies.push((&track.shape, track.look, mesh));
                mesh
            }
        };
        let node = motion::node_at(track, clip.cut.from(), mesh);
        nodes.push(document.root.push(node));
    }
    children.extend(&nodes);
    let facts = extras(&clip.label.facts)?;
    let name = Some(clip.label.name.clone());
    let root = Node { name: name.clone(), children: Some(children), extras: facts.clone(), ..Node::default() };
    let root = document.root.push(root);
    let scene = Scene { name, nodes: vec![root], extensions: None, extras: facts.clone() };
    document.root.scene = Some(document.root.push(scene));
    motion::animate(&mut document, clip, &nodes, facts);
    document.finish()
}

fn extras(facts: &Map<String, Value>) -> Result<Option<Box<RawValue>>, ExportError> {
    let text = serde_json::to_string(facts).map_err(|error| ExportError::Json(error.to_string()))?;
    RawValue::from_string(text).map(Some).map_err(|error| ExportError::Json(error.to_string()))
}

impl Document {
    /// A mesh of parts; `None` where there is nothing to be seen.
    fn mesh(&mut self, name: &str, parts: &[Part]) -> Option<Index<Mesh>> {
        let drawn = parts.iter().filter(|part| !part.mesh.triangles.is_empty());
        let primitives: Vec<Primitive> = drawn.map(|part| self.primitive(part)).collect();
        let mesh = Mesh { extensions: None, extras: None, name: Some(name.to_owned()), primitives, weights: None };
        (!mesh.primitives.is_empty()).then(|| self.root.push(mesh))
    }

    fn primitive(&mut self, part: &Part) -> Primitive {
        let mesh = &part.mesh;
        let attributes = BTreeMap::from([
            (Valid(Semantic::Positions), self.blob.points(&mut self.root, &mesh.positions, true)),
            (Valid(Semantic::Normals), self.blob.points(&mut self.root, &mesh.normals, false)),
        ]);
        Primitive {
            attributes,
            extensions: None,
            extras: None,
            indices: Some(self.blob.indices(&mut self.root, mesh.triangles.as_flattened())),
            material: Some(self.materials.index(&mut self.root, part.look)),
            mode: Valid(Mode::Triangles),
            targets: None,
        }
    }

    /// Header, JSON chunk and binary chunk.
    fn finish(mut self) -> Result<Vec<u8>, ExportError> {
        let bytes = self.blob.finish(&mut self.root);
        let mut json = self.root.to_vec().map_err(|error| ExportError::Json(error.to_string()))?;
        json.resize(json.len().next_multiple_of(4), b' ');
        let length = 12 + 8 + json.len() + 8 + bytes.len();
        let as_u32 = |length: usize| u32::try_from(length).map_err(|_| ExportError::TooLong);
        let mut file = Vec::with_capacity(length);
        file.extend(b"glTF");
        file.extend([2, as_u32(length)?, as_u32(json.len())?].map(u32::to_le_bytes).as_flattened());
        file.extend(b"JSON");
        file.extend(json);
        file.extend(as_u32(bytes.len())?.to_le_bytes());
        file.extend(b"BIN\0");
        file.extend(bytes);
        Ok(file)
    }
}

//! A GLB of what a stage holds.

use crate::AssetError;
use crate::glb::{FROM_USD, Key, joined};
use glam::{DMat4, DQuat, DVec3};
use serde_json::{Map, Value, json};

/// The extension for what moves, and that for solids.
const BODIES: &str = "KHR_physics_rigid_bodies";
const SHAPES: &str = "KHR_implicit_shapes";

/// A node: in m, y up.
#[derive(Debug, Default)]
pub(super) struct Node {
    pub(super) name: String,
    /// The index of the one that it belongs to, which comes before it.
    pub(super) parent: Option<usize>,
    pub(super) at: DVec3,
    pub(super) turn: DQuat,
    pub(super) scale: DVec3,
    /// Corners and triangles about its place, along its axes.
    pub(super) mesh: Option<(Vec<DVec3>, Vec<[u32; 3]>)>,
    /// The index of what it looks like.
    pub(super) look: Option<usize>,
    /// What it says of how it moves.
    pub(super) bodies: Map<String, Value>,
    pub(super) ours: Map<String, Value>,
    pub(super) keys: Vec<Key>,
}

impl Node {
    pub(super) fn matrix(&self) -> DMat4 {
        DMat4::from_scale_rotation_translation(self.scale, self.turn, self.at)
    }
}

/// All that a file has.
#[derive(Debug, Default)]
pub(super) struct File {
    pub(super) nodes: Vec<Node>,
    pub(super) shapes: Vec<Value>,
    /// Physics materials, filters and joints.
    pub(super) bodies: Map<String, Value>,
    /// Names and colours, linear.
    pub(super) looks: Vec<(String, [f64; 3])>,
    pub(super) ours: Map<String, Value>,
}

/// Numbers with how they are laid out.
#[derive(Default)]
struct Blob {
    bytes: Vec<u8>,
    views: Vec<Value>,
    accessors: Vec<Value>,
}

impl Blob {
    /// Adds an accessor and returns its index.
    fn add(&mut self, bytes: impl Iterator<Item = [u8; 4]>, mut accessor: Value) -> usize {
        let start = self.bytes.len();
        bytes.for_each(|four| self.bytes.extend_from_slice(&four));
        self.views.push(json!({ "buffer": 0, "byteOffset": start, "byteLength": self.bytes.len() - start }));
        accessor["bufferView"] = (self.views.len() - 1).into();
        self.accessors.push(accessor);
        self.accessors.len() - 1
    }

    fn floats(&mut self, numbers: impl Iterator<Item = f64>, accessor: Value) -> usize {
        self.add(numbers.map(|number| (number as f32).to_le_bytes()), accessor)
    }
}

const FLOAT: u32 = 5126;
const UINT: u32 = 5125;

impl File {
    /// Its bytes.
    ///
    /// # Errors
    /// [`AssetError::TooLong`] if they are too many.
    pub(super) fn bytes(mut self) -> Result<Vec<u8>, AssetError> {
        let mut blob = Blob::default();
        let (mut meshes, mut channels, mut samplers): (Vec<Value>, Vec<Value>, Vec<Value>) = Default::default();
        let mut nodes: Vec<Value> = Vec::new();
        let mut roots = Vec::new();
        for (index, node) in self.nodes.iter().enumerate() {
            let mut json = placed(node, node.parent.map(|parent| &self.nodes[parent]));
            json["name"] = node.name.as_str().into();
            let mut extensions = Map::new();
            for (name, said) in [(BODIES, &node.bodies), (FROM_USD, &node.ours)] {
                if !said.is_empty() {
                    extensions.insert(name.into(), said.clone().into());
                }
            }
            if !extensions.is_empty() {
                json["extensions"] = extensions.into();
            }
            if let Some((corners, faces)) = node.mesh.as_ref().filter(|(_, faces)| !faces.is_empty()) {
                json["mesh"] = meshes.len().into();
                meshes.push(mesh(&mut blob, corners, faces, node.look));
            }
            if !node.keys.is_empty() {
                animate(&mut blob, index, &node.keys, &mut channels, &mut samplers);
            }
            match node.parent {
                None => roots.push(index),
                Some(parent) => match nodes[parent]["children"].as_array_mut() {
                    Some(children) => children.push(index.into()),
                    None => nodes[parent]["children"] = json!([index]),
                },
            }
            nodes.push(json);
        }
        let look = |(name, [r, g, b]): &(String, [f64; 3])| {
            let colour = json!({ "baseColorFactor": [r, g, b, 1.0] });
            json!({ "name": name, "pbrMetallicRoughness": colour })
        };
        let mut file = json!({ "asset": { "version": "2.0" }, "scene": 0, "scenes": [{ "nodes": roots }] });
        let lists = [
            ("nodes", nodes),
            ("meshes", meshes),
            ("materials", self.looks.iter().map(look).collect()),
            ("bufferViews", blob.views),
            ("accessors", blob.accessors),
        ];
        for (key, list) in lists.into_iter().filter(|(_, list)| !list.is_empty()) {
            file[key] = list.into();
        }
        if !channels.is_empty() {
            file["animations"] = json!([{ "channels": channels, "samplers": samplers }]);
        }
        if !blob.bytes.is_empty() {
            file["buffers"] = json!([{ "byteLength": blob.bytes.len() }]);
        }
        let mut extensions = Map::new();
        extensions.insert(BODIES.into(), std::mem::take(&mut self.bodies).into());
        extensions.insert(SHAPES.into(), json!({ "shapes": self.shapes }));
        extensions.insert(FROM_USD.into(), self.ours.into());
        file["extensionsUsed"] = extensions.keys().cloned().collect::<Vec<_>>().into();
        file["extensions"] = extensions.into();
        joined(&file, blob.bytes)
    }
}

/// A node where it is in the one that it belongs to.
fn placed(node: &Node, parent: Option<&Node>) -> Value {
    let (mut at, mut turn) = (node.at, node.turn);
    if let Some(parent) = parent {
        if parent.scale != DVec3::ONE {
            let matrix = parent.matrix().inverse() * node.matrix();
            return json!({ "matrix": matrix.to_cols_array() });
        }
        let back = parent.turn.inverse();
        (at, turn) = (back * (at - parent.at), (back * turn).normalize());
    }
    let mut json = json!({ "translation": at.to_array(), "rotation": turn.to_array() });
    if node.scale != DVec3::ONE {
        json["scale"] = node.scale.to_array().as_slice().into();
    }
    json
}

fn mesh(blob: &mut Blob, corners: &[DVec3], faces: &[[u32; 3]], look: Option<usize>) -> Value {
    let none = [DVec3::INFINITY, DVec3::NEG_INFINITY];
    let [low, high] = corners.iter().fold(none, |[low, high], &corner| [low.min(corner), high.max(corner)]);
    let [low, high] = [low, high].map(|end| end.to_array().map(|x| x as f32));
    let places = json!({ "componentType": FLOAT, "type": "VEC3", "count": corners.len(), "min": low, "max": high });
    let places = blob.floats(corners.iter().flat_map(|corner| corner.to_array()), places);
    let indices = json!({ "componentType": UINT, "type": "SCALAR", "count": 3 * faces.len() });
    let indices = blob.add(faces.iter().flatten().map(|index| index.to_le_bytes()), indices);
    let mut primitive = json!({ "attributes": { "POSITION": places }, "indices": indices, "mode": 4 });
    if let Some(look) = look {
        primitive["material"] = look.into();
    }
    json!({ "primitives": [primitive] })
}

fn animate(blob: &mut Blob, node: usize, keys: &[Key], channels: &mut Vec<Value>, samplers: &mut Vec<Value>) {
    let times = |key: &Key| key.time as f32;
    let ends = [keys.first(), keys.last()].map(|key| key.map_or(0.0, times));
    let accessor = json!({ "componentType": FLOAT, "type": "SCALAR", "count": keys.len(), "min": [ends[0]],
                           "max": [ends[1]] });
    let input = blob.floats(keys.iter().map(|key| key.time), accessor);
    let accessor = |kind: &str| json!({ "componentType": FLOAT, "type": kind, "count": keys.len() });
    let at = blob.floats(keys.iter().flat_map(|key| key.at.to_array()), accessor("VEC3"));
    let turn = blob.floats(keys.iter().flat_map(|key| key.turn.to_array()), accessor("VEC4"));
    for (path, output) in [("translation", at), ("rotation", turn)] {
        channels.push(json!({ "sampler": samplers.len(), "target": { "node": node, "path": path } }));
        samplers.push(json!({ "input": input, "output": output, "interpolation": "LINEAR" }));
    }
}

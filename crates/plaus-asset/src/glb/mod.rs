//! Binary glTF: nodes with their meshes, keyframes, and extra properties.

mod check;
mod colliders;
mod drawn;
mod keys;
mod pack;

pub use keys::{Between, Key};
pub use pack::packed;
#[cfg(feature = "usd")]
pub(crate) use {drawn::screen, keys::OFF, keys::straight, pack::joined};

use super::{AssetError, Object, Triangles};
use check::{is_sound, unknown_accessor, wrong_type};
use drawn::Drawn;
use glam::{DMat3, DMat4, DQuat, DVec3};
use gltf::{Document, Gltf};
use serde_json::Value;
use std::borrow::Cow;
use std::collections::{BTreeMap, BTreeSet};

/// Extensions that change where triangles are, or hold them in a form of their own.
const GEOMETRY: [&str; 5] = [
    "KHR_draco_mesh_compression",
    "EXT_meshopt_compression",
    "KHR_meshopt_compression",
    "KHR_mesh_quantization",
    "EXT_mesh_gpu_instancing",
];

/// The extension in which a GLB that is made of USD has what GLB has no word for: of the file, `gravity` in m/s², y up,
/// `left_out` and `harmless`; of nodes, `colour`, and of colliders `density` in kg/m³ or `mass` in kg, and `pieces` if
/// convex pieces are to stand for a mesh.
pub const FROM_USD: &str = "PLAUS_from_usd";

/// The extensions that a file requires its readers to know.
fn required(json: &Value) -> impl Iterator<Item = &str> {
    json["extensionsRequired"].as_array().into_iter().flatten().filter_map(Value::as_str)
}

/// A file that was read.
#[derive(Debug)]
pub struct Glb {
    document: Document,
    blob: Vec<u8>,
    /// The file's JSON, including properties that the reader does not know.
    json: Value,
    /// The nodes that the scene holds, in the order of the tree.
    nodes: Vec<Placed>,
}

/// Where a node is.
#[derive(Debug, Clone)]
struct Placed {
    /// Its name, which no other node has.
    name: String,
    index: usize,
    parent: Option<usize>,
    world: DMat4,
    /// The name of the object that its collider takes its mesh from, if that is not its own.
    collider: Option<String>,
}

impl Placed {
    /// Triangles about its origin as an object of the file.
    fn object(&self, name: &str, drawn: Drawn) -> Result<Object, AssetError> {
        let Drawn { mut corners, mut faces, colour, material } = drawn;
        let (at, turn) = pose(&self.world);
        // The rest of the node's matrix is its scale. A mirror image turns faces inside out.
        let rest = DMat4::from_rotation_translation(turn, at).inverse() * self.world;
        if DMat3::from_mat4(rest).determinant() < 0.0 {
            faces.iter_mut().for_each(|face| face.swap(1, 2));
        }
        corners.iter_mut().for_each(|corner| *corner = rest.transform_point3(*corner));
        let triangles = Triangles::new(name, &corners, &faces)?;
        Ok(Object { name: name.to_owned(), at, turn, triangles, colour, material, is_drawn: true })
    }
}

/// A node.
#[derive(Debug, Clone, PartialEq)]
pub struct Node {
    /// Its name, that of its [`Object`] if it has a mesh. No other node has it: a second node called `box` is `box_2`.
    pub name: String,
    /// Its index among the file's nodes.
    pub index: usize,
    /// The index of its parent node.
    pub parent: Option<usize>,
    /// Where its origin is in the file, in m.
    pub at: DVec3,
    /// Turns its axes into those of the file.
    pub turn: DQuat,
    /// Its scale along its axes.
    pub scale: DVec3,
    /// Whether it has a mesh.
    pub has_mesh: bool,
    /// The object with the mesh of its collider, if another node or entry than its own has it.
    pub collider: Option<String>,
    /// Its `extras`; null if there are none.
    pub extras: Value,
    /// Its extensions by name; null if there are none.
    pub extensions: Value,
    /// How it moves; empty if it does not.
    pub keys: Vec<Key>,
    /// How it moves between keys.
    pub between: Between,
    /// The parts of its motion that are left out, in words.
    pub left_out: Vec<String>,
}

impl Glb {
    /// Reads a file.
    ///
    /// # Errors
    ///
    /// [`AssetError::Broken`] for bytes that are not a GLB, or are an invalid one, or if its meshes need an extension
    /// that is not read. Other required extensions, such as lights, have no bearing on shapes and motion.
    pub fn read(bytes: &[u8]) -> Result<Self, AssetError> {
        let broken = |what: String| AssetError::Broken(format!("it is not a valid GLB: {what}"));
        let length = bytes.get(8..12).and_then(|length| length.try_into().ok()).map(u32::from_le_bytes);
        if !bytes.starts_with(b"glTF") || length.is_none_or(|length| length as usize != bytes.len()) {
            return Err(broken("its header lacks the word glTF or its length".into()));
        }
        let mut file = gltf::Glb::from_slice(bytes).map_err(|error| broken(error.to_string()))?;
        let json: Value = serde_json::from_slice(&file.json).map_err(|error| broken(error.to_string()))?;
        if let Some(name) = required(&json).find(|name| GEOMETRY.contains(name)) {
            return Err(AssetError::Broken(format!("its meshes need {name}, which is not read: export it without")));
        }
        if let Some(what) = unknown_accessor(&json) {
            return Err(broken(what));
        }
        let mut whole = Cow::Borrowed(bytes);
        if required(&json).next().is_some() {
            // The library refuses every required extension that it does not know.
            let mut known = json.clone();
            known.as_object_mut().map(|known| known.remove("extensionsRequired"));
            file.json = serde_json::to_vec(&known).map_err(|error| broken(error.to_string()))?.into();
            whole = file.to_vec().map_err(|error| broken(error.to_string()))?.into();
        }
        let Gltf { document, blob } = Gltf::from_slice(&whole).map_err(|error| broken(error.to_string()))?;
        let blob = blob.unwrap_or_default();
        if let Some(index) = document.accessors().find(|accessor| !is_sound(accessor, &blob)).map(|a| a.index()) {
            return Err(broken(format!("accessor {index} is sparse, or goes beyond the file's own data")));
        }
        if let Some(what) = wrong_type(&document) {
            return Err(broken(what));
        }
        let mut nodes = placed(&document)?;
        colliders::name_all(&mut nodes, &json, &document);
        Ok(Self { document, blob, json, nodes })
    }

    /// The extensions that it requires its readers to know.
    pub fn required(&self) -> impl Iterator<Item = &str> {
        required(&self.json)
    }

    /// The nodes with a mesh, then the meshes of other nodes that colliders name.
    pub(crate) fn objects(&self) -> Result<Vec<Object>, AssetError> {
        let mut objects = Vec::new();
        for placed in &self.nodes {
            let Some(node) = self.document.nodes().nth(placed.index) else { continue };
            if let Some(mesh) = node.mesh() {
                let mut drawn = Drawn::default();
                drawn.add(&mesh, &DMat4::IDENTITY, self, &placed.name)?;
                objects.push(placed.object(&placed.name, drawn)?);
            }
        }
        self.colliders(&mut objects)?;
        Ok(objects)
    }

    /// The nodes of the scene, in the order of its tree.
    #[must_use]
    pub fn nodes(&self) -> Vec<Node> {
        let node = |&Placed { ref name, index, parent, ref world, ref collider }: &Placed| {
            let node = self.document.nodes().nth(index)?;
            let (at, turn) = pose(world);
            let said = |key: &str| self.json["nodes"][index].get(key).cloned().unwrap_or(Value::Null);
            let (keys, between, left_out) = self.keys(&node);
            Some(Node {
                name: name.clone(),
                index,
                parent,
                at,
                turn,
                scale: world.to_scale_rotation_translation().0,
                collider: collider.clone(),
                has_mesh: node.mesh().is_some(),
                extras: said("extras"),
                extensions: said("extensions"),
                keys,
                between,
                left_out,
            })
        };
        self.nodes.iter().filter_map(node).collect()
    }

    /// The file's JSON for one entry of a list: `nodes`, `meshes`, `materials`; null if there is none.
    #[must_use]
    pub fn said(&self, list: &str, index: usize) -> &Value {
        &self.json[list][index]
    }

    /// The file's data for an extension, beyond its nodes; null if there are none.
    #[must_use]
    pub fn extension(&self, name: &str) -> &Value {
        &self.json["extensions"][name]
    }
}

/// Gives every node a name of its own: the first node of a name keeps it, the next ones get a number. Nodes with a mesh
/// come first, so that nothing but another mesh changes the name of an object.
fn name_all(nodes: &mut [Placed], document: &Document) {
    let node = |index: usize| document.nodes().nth(index);
    let given = |index: usize| node(index)?.name().filter(|name| !name.is_empty()).map(String::from);
    let mut taken: BTreeSet<String> = nodes.iter().filter_map(|node| given(node.index)).collect();
    let mut kept = BTreeSet::new();
    // The last number that was given to a name.
    let mut counts: BTreeMap<String, u64> = BTreeMap::new();
    let mut order: Vec<&mut Placed> = nodes.iter_mut().collect();
    order.sort_by_key(|placed| node(placed.index).is_none_or(|node| node.mesh().is_none()));
    for placed in order {
        let own = given(placed.index);
        let plain = own.clone().unwrap_or_else(|| format!("object_{}", placed.index + 1));
        let mut name = plain.clone();
        let mut is_free = if own.is_some() { kept.insert(name.clone()) } else { taken.insert(name.clone()) };
        let count = counts.entry(plain.clone()).or_insert(1);
        while !is_free {
            *count += 1;
            name = format!("{plain}_{count}");
            is_free = taken.insert(name.clone());
        }
        placed.name = name;
    }
}

/// Where a node is, and how it is turned.
pub(crate) fn pose(world: &DMat4) -> (DVec3, DQuat) {
    let (scale, turn, at) = world.to_scale_rotation_translation();
    let is_turn = scale.is_finite() && turn.is_finite() && turn.length() > 0.5;
    (at, if is_turn { turn.normalize() } else { DQuat::IDENTITY })
}

/// The nodes of the default scene, or of the first scene, and where they are.
fn placed(document: &Document) -> Result<Vec<Placed>, AssetError> {
    let Some(scene) = document.default_scene().or_else(|| document.scenes().next()) else { return Ok(Vec::new()) };
    let mut seen = vec![false; document.nodes().len()];
    let mut found = Vec::new();
    let mut open: Vec<_> = scene.nodes().map(|node| (node, None, DMat4::IDENTITY)).collect();
    open.reverse();
    while let Some((node, parent, around)) = open.pop() {
        if std::mem::replace(&mut seen[node.index()], true) {
            return Err(AssetError::Broken(format!("node {} is in the scene twice", node.index())));
        }
        let world = around * matrix(&node);
        if !world.is_finite() {
            return Err(AssetError::Broken(format!("node {} has a matrix that is not finite", node.index())));
        }
        found.push(Placed { name: String::new(), index: node.index(), parent, world, collider: None });
        let children: Vec<_> = node.children().map(|child| (child, Some(node.index()), world)).collect();
        open.extend(children.into_iter().rev());
    }
    name_all(&mut found, document);
    Ok(found)
}

/// A node's pose relative to its parent.
fn matrix(node: &gltf::Node<'_>) -> DMat4 {
    DMat4::from_cols_array_2d(&node.transform().matrix().map(|column| column.map(f64::from)))
}

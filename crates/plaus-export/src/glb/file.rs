//! An unfinished document, and its bytes.

use super::GENERATOR;
use super::blob::{Blob, pushed};
use super::materials::Materials;
use crate::clip::ExportError;
use crate::mesh::Part;
use serde_json::{Map, Value, json};

/// A glTF document under construction.
#[derive(Default)]
pub(super) struct Document {
    pub(super) nodes: Vec<Value>,
    pub(super) animations: Vec<Value>,
    pub(super) extensions: Map<String, Value>,
    pub(super) blob: Blob,
    meshes: Vec<Value>,
    materials: Materials,
    /// Constant values, with the accessors of their one key.
    pub(super) stills: Vec<(Vec<f32>, [usize; 2])>,
}

impl Document {
    /// A mesh of parts; `None` if nothing is visible.
    pub(super) fn mesh(&mut self, name: &str, parts: &[Part]) -> Option<usize> {
        let drawn = parts.iter().filter(|part| !part.mesh.triangles.is_empty());
        let primitives: Vec<Value> = drawn.map(|part| self.primitive(part)).collect();
        (!primitives.is_empty()).then(|| pushed(&mut self.meshes, json!({"name": name, "primitives": primitives})))
    }

    /// A mesh without a material, for what is not drawn.
    #[cfg(feature = "physics")]
    pub(super) fn surface(&mut self, name: &str, corners: &[glam::DVec3], triangles: &[[u32; 3]]) -> usize {
        let corners: Vec<[f32; 3]> = corners.iter().map(|corner| corner.as_vec3().to_array()).collect();
        let indices = self.blob.indices(triangles.as_flattened());
        let primitive = json!({"attributes": {"POSITION": self.blob.points(&corners, true)}, "indices": indices});
        pushed(&mut self.meshes, json!({"name": format!("{name} hull"), "primitives": [primitive]}))
    }

    fn primitive(&mut self, part: &Part) -> Value {
        let (mesh, blob) = (&part.mesh, &mut self.blob);
        json!({
            "attributes": {
                "POSITION": blob.points(&mesh.positions, true),
                "NORMAL": blob.points(&mesh.normals, false),
                "TEXCOORD_0": blob.uvs(&mesh.uvs),
            },
            "indices": blob.indices(mesh.triangles.as_flattened()),
            "material": self.materials.index(part.look),
        })
    }

    /// Header, JSON chunk and binary chunk.
    pub(super) fn finish(self, scene: Value) -> Result<Vec<u8>, ExportError> {
        let Blob { bytes, views, accessors } = self.blob;
        let buffers = Vec::from_iter((!bytes.is_empty()).then(|| json!({"byteLength": bytes.len()})));
        let mut root = json!({"asset": {"version": "2.0", "generator": GENERATOR}, "scene": 0, "scenes": [scene]});
        let lists = [
            ("nodes", self.nodes),
            ("meshes", self.meshes),
            ("materials", self.materials.list),
            ("accessors", accessors),
            ("bufferViews", views),
            ("buffers", buffers),
            ("animations", self.animations),
        ];
        // glTF knows no empty lists.
        for (name, list) in lists.into_iter().filter(|(_, list)| !list.is_empty()) {
            root[name] = list.into();
        }
        if !self.extensions.is_empty() {
            root["extensionsUsed"] = self.extensions.keys().cloned().collect();
            root["extensions"] = self.extensions.into();
        }
        let mut json = serde_json::to_vec(&root).map_err(|error| ExportError::Json(error.to_string()))?;
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

//! An unfinished document, and its bytes.

use super::GENERATOR;
use super::blob::Blob;
use super::materials::Materials;
use crate::clip::ExportError;
use crate::mesh::Part;
use gltf_json::accessor::Accessor;
use gltf_json::extras::RawValue;
use gltf_json::validation::Checked::Valid;
use gltf_json::{Asset, Index, Mesh, Root, mesh::Mode, mesh::Primitive, mesh::Semantic};
use serde_json::{Map, Value};
use std::collections::BTreeMap;

/// A glTF document under construction.
pub(super) struct Document {
    pub(super) root: Root,
    pub(super) blob: Blob,
    materials: Materials,
    /// Constant values, with the accessors of their one key.
    pub(super) stills: Vec<(Vec<f32>, [Index<Accessor>; 2])>,
}

impl Default for Document {
    fn default() -> Self {
        let asset = Asset { generator: Some(GENERATOR.to_owned()), ..Asset::default() };
        let root = Root { asset, ..Root::default() };
        Self { root, blob: Blob::default(), materials: Materials::default(), stills: Vec::new() }
    }
}

/// Facts in written form.
pub(super) fn extras(facts: &Map<String, Value>) -> Result<Option<Box<RawValue>>, ExportError> {
    let text = serde_json::to_string(facts).map_err(|error| ExportError::Json(error.to_string()))?;
    RawValue::from_string(text).map(Some).map_err(|error| ExportError::Json(error.to_string()))
}

impl Document {
    /// A mesh of parts; `None` if nothing is visible.
    pub(super) fn mesh(&mut self, name: &str, parts: &[Part]) -> Option<Index<Mesh>> {
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
            (Valid(Semantic::TexCoords(0)), self.blob.uvs(&mut self.root, &mesh.uvs)),
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
    pub(super) fn finish(mut self) -> Result<Vec<u8>, ExportError> {
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

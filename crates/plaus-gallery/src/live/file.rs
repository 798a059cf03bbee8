//! Files of shapes, as what was read of them: a page has no readers of such files.

use super::in_words;
use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use glam::{DQuat, DVec3};
use plaus_scenes::files::{Asset, Content, Files, Format, Object, Triangles};
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// What was read of a file of shapes.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct File {
    /// Where it was, as the scenario names it.
    path: String,
    /// BLAKE3 of its bytes, in hexadecimal digits.
    hash: String,
    objects: Vec<Shape>,
}

/// An object of a file.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Shape {
    name: String,
    at: [f64; 3],
    turn: [f64; 4],
    /// Three numbers of 64 bits for each corner, little-endian, as base64.
    corners: String,
    /// Three numbers of 32 bits for each triangle, little-endian, as base64.
    faces: String,
    colour: Option<[u8; 3]>,
    material: Option<String>,
    is_drawn: bool,
}

impl File {
    /// Reads a file whose name tells its format.
    ///
    /// # Errors
    /// In words, if it has no shapes.
    pub(super) fn read(path: &str, bytes: &Arc<[u8]>) -> Result<Self, String> {
        let Asset { hash, content, .. } = Asset::read(path, Arc::clone(bytes)).map_err(in_words)?;
        let objects = content.objects.iter().map(Shape::of).collect();
        Ok(Self { path: path.to_owned(), hash, objects })
    }

    fn asset(&self) -> Result<Asset, String> {
        let objects = self.objects.iter().map(Shape::object).collect::<Result<_, _>>()?;
        let content = Content { format: Format::of(&self.path).map_err(in_words)?, objects };
        Ok(Asset { bytes: Arc::default(), hash: self.hash.clone(), content })
    }
}

impl Shape {
    fn of(object: &Object) -> Self {
        let Object { name, at, turn, triangles: Triangles { corners, faces }, colour, material, is_drawn } = object;
        let corners: Vec<u8> =
            corners.iter().flat_map(|corner| corner.to_array().map(f64::to_le_bytes)).flatten().collect();
        let faces: Vec<u8> = faces.iter().flat_map(|face| face.map(u32::to_le_bytes)).flatten().collect();
        Self {
            name: name.clone(),
            at: at.to_array(),
            turn: turn.to_array(),
            corners: STANDARD.encode(corners),
            faces: STANDARD.encode(faces),
            colour: *colour,
            material: material.clone(),
            is_drawn: *is_drawn,
        }
    }

    fn object(&self) -> Result<Object, String> {
        let corners = STANDARD.decode(&self.corners).map_err(in_words)?;
        let corners = corners.as_chunks().0.iter().map(|bytes| f64::from_le_bytes(*bytes)).collect::<Vec<f64>>();
        let corners: Vec<DVec3> = corners.as_chunks().0.iter().map(|corner| DVec3::from_array(*corner)).collect();
        let faces = STANDARD.decode(&self.faces).map_err(in_words)?;
        let faces = faces.as_chunks().0.iter().map(|bytes| u32::from_le_bytes(*bytes)).collect::<Vec<u32>>();
        // Checks that corners are finite, and are there.
        let triangles = Triangles::new(&self.name, &corners, faces.as_chunks().0).map_err(in_words)?;
        Ok(Object {
            name: self.name.clone(),
            at: DVec3::from_array(self.at),
            turn: DQuat::from_array(self.turn),
            triangles,
            colour: self.colour,
            material: self.material.clone(),
            is_drawn: self.is_drawn,
        })
    }
}

/// The files of a page.
pub(super) struct Shapes<'a>(pub(super) &'a [File]);

impl Files for Shapes<'_> {
    fn bytes(&self, _: &str, _: bool) -> Result<Arc<[u8]>, String> {
        Err("a page has only shapes of files".to_owned())
    }

    fn asset(&self, path: &str, _: bool) -> Result<Asset, String> {
        let file = self.0.iter().find(|file| file.path == path);
        file.ok_or_else(|| "it is not among the files of the page".to_owned())?.asset()
    }
}

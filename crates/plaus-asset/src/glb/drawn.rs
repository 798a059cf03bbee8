//! Triangles of meshes.

use super::{AssetError, Glb};
use glam::{DMat4, DVec3};
use gltf::Mesh;
use gltf::mesh::Mode;
use plaus_dist::math::powf;

/// Triangles, with the first colour that a material gives, and its name.
#[derive(Debug, Default)]
pub(super) struct Drawn {
    pub(super) corners: Vec<DVec3>,
    pub(super) faces: Vec<[u32; 3]>,
    pub(super) colour: Option<[u8; 3]>,
    pub(super) material: Option<String>,
}

impl Drawn {
    /// Adds a mesh, moved by a matrix; `name` is that of its node.
    pub(super) fn add(&mut self, mesh: &Mesh<'_>, by: &DMat4, file: &Glb, name: &str) -> Result<(), AssetError> {
        for primitive in mesh.primitives() {
            match primitive.mode() {
                Mode::Triangles => {}
                Mode::Points | Mode::Lines | Mode::LineLoop | Mode::LineStrip => continue,
                mode => {
                    return Err(AssetError::Broken(format!(
                        "{name:?} has triangles as {mode:?}: export single triangles"
                    )));
                }
            }
            let reader = primitive.reader(|_| Some(&file.blob[..]));
            let first = self.corners.len() as u32;
            let Some(positions) = reader.read_positions() else { continue };
            self.corners.extend(positions.map(|place| by.transform_point3(DVec3::from_array(place.map(f64::from)))));
            let indices: Vec<u32> = match reader.read_indices() {
                Some(indices) => indices.into_u32().collect(),
                None => (0..self.corners.len() as u32 - first).collect(),
            };
            let shifted = |index: u32| first.saturating_add(index);
            let mut faces: Vec<[u32; 3]> =
                indices.chunks_exact(3).map(|face| [face[0], face[1], face[2]].map(shifted)).collect();
            if by.determinant() < 0.0 {
                faces.iter_mut().for_each(|face| face.swap(1, 2));
            }
            self.faces.append(&mut faces);
            let base = primitive.material().pbr_metallic_roughness().base_color_factor();
            let given = primitive.material().index().is_some();
            if self.colour.is_none() && given {
                self.colour = Some([0, 1, 2].map(|k| screen(base[k])));
                self.material = primitive.material().name().filter(|name| !name.is_empty()).map(String::from);
            }
        }
        Ok(())
    }
}

/// A channel of a colour, converted from linear to sRGB (IEC 61966-2-1).
pub(crate) fn screen(linear: f32) -> u8 {
    let linear = f64::from(linear.clamp(0.0, 1.0));
    let shown = if linear <= 0.003_130_8 { 12.92 * linear } else { 1.055 * powf(linear, 1.0 / 2.4) - 0.055 };
    (255.0 * shown).round() as u8
}

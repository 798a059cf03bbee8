//! Wavefront OBJ.

use super::{AssetError, Object, Triangles};
use glam::{DQuat, DVec3};
use tobj::{LoadError, LoadOptions};

/// The objects of a file; groups are objects, faces with more than three corners are cut into triangles.
pub(super) fn read(bytes: &[u8]) -> Result<Vec<Object>, AssetError> {
    let options = LoadOptions { triangulate: true, ignore_points: true, ignore_lines: true, ..LoadOptions::default() };
    // Material files are not looked for: only the file itself is read.
    let read = tobj::load_obj_buf(&mut &bytes[..], &options, |_| Err(LoadError::OpenFileFailed));
    let (models, _) = read.map_err(|error| AssetError::Broken(format!("it is not a valid OBJ: {error}")))?;
    let mut objects: Vec<(String, Vec<DVec3>, Vec<[u32; 3]>)> = Vec::new();
    for (index, model) in models.into_iter().enumerate() {
        let name = match model.name.as_str() {
            "" | "unnamed_object" => format!("object_{}", index + 1),
            name => name.to_owned(),
        };
        let corners = model.mesh.positions.chunks_exact(3).map(DVec3::from_slice);
        let faces = model.mesh.indices.chunks_exact(3);
        // An object with several materials comes as several parts of one name.
        let place = objects.iter().position(|known| known.0 == name).unwrap_or_else(|| {
            objects.push((name, Vec::new(), Vec::new()));
            objects.len() - 1
        });
        let (_, all, triangles) = &mut objects[place];
        let first = all.len() as u32;
        all.extend(corners);
        triangles.extend(faces.map(|face| [first + face[0], first + face[1], first + face[2]]));
    }
    let object = |(name, corners, faces): (String, Vec<DVec3>, Vec<[u32; 3]>)| {
        let triangles = Triangles::new(&name, &corners, &faces)?;
        Ok(Object { name, at: DVec3::ZERO, turn: DQuat::IDENTITY, triangles, colour: None })
    };
    objects.into_iter().map(object).collect()
}

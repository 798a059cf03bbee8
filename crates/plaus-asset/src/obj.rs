//! Wavefront OBJ.

use super::{AssetError, Object, Triangles};
use glam::DVec3;
use tobj::{LoadError, LoadOptions};

/// The lines that say where corners and faces are, and how objects and groups are called; whatever else a file says is
/// left out, so that it is no reason to refuse it. Bytes that are no UTF-8 are taken as Latin-1.
fn plain(bytes: &[u8]) -> String {
    let text = match std::str::from_utf8(bytes) {
        Ok(text) => text.trim_start_matches('\u{feff}').to_owned(),
        Err(_) => bytes.iter().map(|&byte| char::from(byte)).collect(),
    };
    let whole = text.replace("\\\r\n", " ").replace("\\\n", " ");
    let mut plain = String::with_capacity(whole.len());
    for line in whole.lines() {
        let data = line.split('#').next().unwrap_or_default();
        let mut words = data.split_whitespace();
        match words.next() {
            // Weights and colours of corners come after the coordinates.
            Some("v") => plain.extend(["v "].into_iter().chain(words.take(3).flat_map(|word| [word, " "]))),
            // A corner of a face is `position/texture/normal`.
            Some("f") => {
                let corners = words.map(|word| word.split('/').next().unwrap_or_default());
                plain.extend(["f "].into_iter().chain(corners.flat_map(|corner| [corner, " "])));
            }
            // A name may contain a number sign.
            Some("o" | "g") => plain.push_str(line.trim()),
            _ => continue,
        }
        plain.push('\n');
    }
    plain
}

/// The objects of a file; groups are objects, faces with more than three corners are cut into triangles.
pub(super) fn read(bytes: &[u8]) -> Result<Vec<Object>, AssetError> {
    let options = LoadOptions { triangulate: true, ignore_points: true, ignore_lines: true, ..LoadOptions::default() };
    let plain = plain(bytes);
    let read = tobj::load_obj_buf(&mut plain.as_bytes(), &options, |_| Err(LoadError::OpenFileFailed));
    let (models, _) = read.map_err(|error| AssetError::Broken(format!("it is not a valid OBJ: {error}")))?;
    let mut objects: Vec<(String, Vec<DVec3>, Vec<[u32; 3]>)> = Vec::new();
    for (index, model) in models.into_iter().enumerate() {
        let name = match model.name.as_str() {
            "" | "unnamed_object" => format!("object_{}", index + 1),
            name => name.to_owned(),
        };
        let corners = model.mesh.positions.chunks_exact(3).map(DVec3::from_slice);
        let faces = model.mesh.indices.chunks_exact(3);
        // An object may come in several parts of one name.
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
        Ok(Object::plain(name, triangles))
    };
    objects.into_iter().map(object).collect()
}

/// The corners of an OBJ that may have no faces, as far as they are finite.
#[must_use]
pub fn corners(bytes: &[u8]) -> Vec<DVec3> {
    let corner = |line: &str| {
        let mut words = line.split_whitespace();
        let is_corner = words.next() == Some("v");
        let mut number = || words.next()?.parse().ok();
        let corner = DVec3::new(number()?, number()?, number()?);
        (is_corner && corner.is_finite()).then_some(corner)
    };
    String::from_utf8_lossy(bytes).lines().filter_map(corner).collect()
}

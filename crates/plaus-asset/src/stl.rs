//! STL, binary or text.

use super::{AssetError, Object, Triangles};
use glam::DVec3;
use std::io::Cursor;

/// Bytes before the triangles of a binary file, the last four of which count them.
const HEADER: usize = 84;
/// Bytes of each triangle.
const TRIANGLE: usize = 50;

/// The one object of a file.
pub(super) fn read(bytes: &[u8]) -> Result<Vec<Object>, AssetError> {
    let broken = |error: std::io::Error| AssetError::Broken(format!("it is not a valid STL: {error}"));
    // Some programs begin binary files with the word that text files begin with, so the length decides.
    let read = if is_binary(bytes) {
        let mut copy = bytes.to_vec();
        copy[..5].fill(0);
        stl_io::read_stl(&mut Cursor::new(copy))
    } else {
        stl_io::read_stl(&mut Cursor::new(bytes))
    };
    let mesh = read.map_err(broken)?;
    let corners: Vec<DVec3> = mesh.vertices.iter().map(|corner| DVec3::from_array(corner.0.map(f64::from))).collect();
    let faces: Vec<[u32; 3]> = mesh.faces.iter().map(|face| face.vertices.map(|corner| corner as u32)).collect();
    let name = "object_1".to_owned();
    let triangles = Triangles::new(&name, &corners, &faces)?;
    Ok(vec![Object::plain(name, triangles)])
}

/// Whether a file is as long as its count of triangles says.
fn is_binary(bytes: &[u8]) -> bool {
    let count = bytes.get(HEADER - 4..HEADER).and_then(|count| count.try_into().ok()).map(u32::from_le_bytes);
    // A count of four letters of a text may be too many for addresses of 32 bits.
    count.is_some_and(|count| bytes.len() as u64 == HEADER as u64 + TRIANGLE as u64 * u64::from(count))
}

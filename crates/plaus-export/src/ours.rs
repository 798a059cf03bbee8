//! Recognises files that an export made, and so may replace on request.

use crate::glb::MADE_BY;
use crate::usda::HEAD_OF_ANY_VERSION;
use std::fs::File;
use std::io::Read;
use std::path::Path;

/// Longest description of a GLB that is read, in bytes.
const LONGEST: u64 = 64 << 20;

/// Whether the file is a GLB made by this program, according to its contents.
#[must_use]
pub fn is_glb(path: &Path) -> bool {
    let mut head = [0; 20];
    let Ok(mut file) = File::open(path) else { return false };
    if file.read_exact(&mut head).is_err() || &head[..4] != b"glTF" || &head[16..] != b"JSON" {
        return false;
    }
    let length = u32::from_le_bytes([head[12], head[13], head[14], head[15]]);
    let mut json = Vec::new();
    let read = file.take(u64::from(length).min(LONGEST)).read_to_end(&mut json).is_ok();
    let needle = format!("\"generator\":\"{MADE_BY}");
    read && json.windows(needle.len()).any(|window| window == needle.as_bytes())
}

/// Whether the file is a USDA made by this program, according to its contents.
#[must_use]
pub fn is_usda(path: &Path) -> bool {
    begins_with(path, HEAD_OF_ANY_VERSION.as_bytes())
}

/// Whether a regular file begins with these bytes.
#[must_use]
pub fn begins_with(path: &Path, start: &[u8]) -> bool {
    let mut found = vec![0; start.len()];
    path.is_file() && File::open(path).and_then(|mut file| file.read_exact(&mut found)).is_ok() && found == start
}

//! Formats of pictures, one row each.

mod gif;
mod mp4;
mod sheet;
mod still;

use plaus_export::Exporter;
use std::fs::File;
use std::io::Read;
use std::path::Path;

/// All formats, in the order in which they are listed.
pub const ALL: [&dyn Exporter; 3] = [&still::Png, &gif::Gif, &mp4::Mp4];

/// The beginning of the note in all files made here, for any version.
const MADE_BY: &str = "plaus ";
/// Longest file that is searched for the note.
const LONGEST: u64 = 1 << 28;

/// Whether a file begins with `head` and contains that note.
fn is_ours(path: &Path, head: &[u8]) -> bool {
    let mut bytes = Vec::new();
    let read = File::open(path).and_then(|file| file.take(LONGEST).read_to_end(&mut bytes)).is_ok();
    read && bytes.starts_with(head) && bytes.windows(MADE_BY.len()).any(|window| window == MADE_BY.as_bytes())
}

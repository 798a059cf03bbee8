//! USD as text: opens in usdview, Blender, Houdini, Omniverse and Maya.
//!
//! A body is an animated `Xform` with its geometry, uniquely named, under it. USD interpolates linearly between time
//! samples, so they are as dense as the motion requires, with one at every impact. The label's facts are the layer's
//! custom data. Scenery has collision attributes of physics, so that other programs can simulate further.
//!
//! Several clips are variants of one prim, which share bodies, scenery and materials: see [`Writer`].

mod geometry;
mod text;
mod variants;

pub use variants::Writer;

use crate::clip::Clip;

/// Names the program that made a file; exports replace only files that begin so.
pub const HEAD: &str = concat!("#usda 1.0\n# made by plaus ", env!("CARGO_PKG_VERSION"));
/// Beginning of [`HEAD`] for any version.
pub const HEAD_OF_ANY_VERSION: &str = "#usda 1.0\n# made by plaus ";

/// The text of a USDA file with one clip.
#[must_use]
pub fn to_string(clip: &Clip<'_>) -> String {
    let mut writer = Writer::default();
    writer.add(clip);
    writer.finish()
}

//! Animated glTF 2.0, binary: opens in browsers, Blender, Godot, Unity and Unreal.
//!
//! One node a body, with its name; one animation a clip, with its label's name. Between keys there are straight lines,
//! as dense as the motion asks for, with a key at every impact; or, with [`Between::Exact`](crate::Between), cubic
//! splines with exact tangents, which hold the parabolas of motion under constant acceleration as they are. The label's
//! facts are the `extras` of the animation and of the scene's root.
//!
//! Several clips share bodies, scenery and materials: see [`Writer`].

mod blob;
mod file;
mod godot;
mod materials;
mod motion;
mod shared;

pub use godot::godot_import;
pub(crate) use materials::{linear, surface, unique};
pub use shared::Writer;

use crate::clip::{Clip, ExportError};

/// Says who made a file; exports replace only files that say so.
pub const GENERATOR: &str = concat!("plaus ", env!("CARGO_PKG_VERSION"));
/// Begin of [`GENERATOR`] whatever the version.
pub const MADE_BY: &str = "plaus ";

/// The bytes of a GLB file with one clip.
///
/// # Errors
/// [`ExportError::TooLong`] where it would be longer than the format can say.
pub fn to_vec(clip: &Clip<'_>) -> Result<Vec<u8>, ExportError> {
    let mut writer = Writer::default();
    writer.add(clip)?;
    writer.finish()
}

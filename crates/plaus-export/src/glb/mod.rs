//! Animated glTF 2.0, binary: opens in browsers, Blender, Godot, Unity and Unreal.
//!
//! One node for each body, with its name; one animation for each clip, with its label's name. Between keys there are
//! straight lines, as dense as the motion requires, with a key at every impact. With [`Between::Exact`](crate::Between)
//! there are cubic splines with exact tangents instead, which represent the parabolas of motion under constant
//! acceleration exactly. The label's facts are the `extras` of the animation and of the scene's root.
//!
//! Several clips share bodies, scenery and materials: see [`Writer`].

mod blob;
mod file;
mod godot;
mod materials;
mod motion;
#[cfg(feature = "physics")]
mod physics;
mod shared;

pub use godot::godot_import;
pub(crate) use materials::{linear, surface, unique};
#[cfg(feature = "physics")]
pub use physics::other_pairs;
pub use shared::Writer;

use crate::clip::{Clip, ExportError};

/// Names the program that made a file; exports replace only files with this name.
pub const GENERATOR: &str = concat!("plaus ", env!("CARGO_PKG_VERSION"));
/// Beginning of [`GENERATOR`] for any version.
pub const MADE_BY: &str = "plaus ";

/// The bytes of a GLB file with one clip.
///
/// # Errors
///
/// [`ExportError::TooLong`] if it would be longer than the format allows.
pub fn to_vec(clip: &Clip<'_>) -> Result<Vec<u8>, ExportError> {
    let mut writer = Writer::default();
    writer.add(clip)?;
    writer.finish()
}

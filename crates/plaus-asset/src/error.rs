//! What can be wrong with a file of shapes.

use super::{MOST_BYTES, MOST_TRIANGLES};

/// Why a file was not read.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum AssetError {
    /// The extension is not that of a known format.
    #[error("its name must end in .glb, .gltf, .obj, .stl, .usd, .usda, .usdc or .usdz")]
    UnknownFormat,
    /// More bytes than allowed.
    #[error("it has {bytes} bytes: at most {MOST_BYTES} are allowed")]
    TooLong {
        /// How many it has.
        bytes: u64,
    },
    /// More triangles than the simulator accepts.
    #[error("it has {triangles} triangles: at most {MOST_TRIANGLES} are allowed; decimate it")]
    TooMany {
        /// How many it has.
        triangles: usize,
    },
    /// No triangles at all.
    #[error("it has no triangles")]
    Empty,
    /// It is not what its name says, or it is damaged.
    #[error("{0}")]
    Broken(String),
    /// A corner that is NaN or infinite.
    #[error("corner {corner} of {object:?} is not finite")]
    NotFinite {
        /// The object.
        object: String,
        /// Which of its corners, counted from 0 in the order of the file.
        corner: usize,
    },
}

//! What can be wrong with a file of shapes.

use super::{MOST_BYTES, MOST_TRIANGLES};

/// A file that is not read.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum AssetError {
    /// An ending that says no format.
    #[error("its name must end in .glb, .obj or .stl")]
    UnknownFormat,
    /// More bytes than are read.
    #[error("it has {bytes} bytes: at most {MOST_BYTES} are read")]
    TooLong {
        /// How many it has.
        bytes: u64,
    },
    /// More triangles than the simulator takes.
    #[error("it has {triangles} triangles: at most {MOST_TRIANGLES} are served; decimate it")]
    TooMany {
        /// How many it has.
        triangles: usize,
    },
    /// No triangles at all.
    #[error("there are no triangles in it")]
    Empty,
    /// It is not what its name says, or damaged.
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

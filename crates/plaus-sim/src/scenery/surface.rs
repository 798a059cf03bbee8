//! The names of what bodies touch.

use serde::{Deserialize, Serialize};
use std::fmt;

/// A part of the scenery that a body can touch: an index into the planes, faces, edges, vertices or domes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub enum Surface {
    /// A plane.
    Plane(u32),
    /// The inside of a triangle.
    Face(u32),
    /// A bowl or dome.
    Dome(u32),
    /// An edge of the mesh.
    Edge(u32),
    /// A vertex of the mesh.
    Vertex(u32),
    /// A fixed part of a world of rigid bodies, touched by one point of a body's skin.
    Part {
        /// Index of the part.
        part: u16,
        /// Which point of the body.
        point: u16,
    },
    /// A fixed part of such a world, touched by a convex piece of a body.
    Spot {
        /// Index of the part.
        part: u16,
        /// Which piece of the part: the triangle of a mesh.
        piece: u32,
        /// The elements that touch there, and the piece of the body.
        point: u32,
    },
}

impl fmt::Display for Surface {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Plane(k) => write!(f, "plane {k}"),
            Self::Face(k) => write!(f, "triangle {k}"),
            Self::Dome(k) => write!(f, "dome {k}"),
            Self::Edge(k) => write!(f, "mesh edge {k}"),
            Self::Vertex(k) => write!(f, "vertex {k}"),
            Self::Part { part, point } => write!(f, "part {part} (by point {point})"),
            Self::Spot { part, piece, .. } => write!(f, "piece {piece} of part {part}"),
        }
    }
}

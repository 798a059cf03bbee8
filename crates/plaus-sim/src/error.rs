//! What can be wrong with a world before it is simulated. Running out of events is not an error, but an
//! [`Outcome`](crate::Outcome).

use crate::scenery::surface::Surface;
use glam::DVec3;
use std::fmt;

/// The first coordinate of some vectors that is NaN or infinite, for an error message.
pub(crate) fn first_not_finite(vectors: &[DVec3]) -> Option<f64> {
    vectors.iter().flat_map(|v| v.to_array()).find(|x| !x.is_finite())
}

/// A piece of scenery that an error is about.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SurfaceId {
    /// A fixed part of a world of rigid bodies, by its place in the list.
    Part(usize),
    /// A surface of a marbles' world, or one that a part is touched at.
    Of(Surface),
    /// A plane that is not part of a world yet.
    Plane,
    /// A bowl or dome, likewise.
    Dome,
    /// A table, likewise.
    Table,
    /// A curved track, likewise.
    ArcTrack,
}

impl fmt::Display for SurfaceId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Part(index) => write!(f, "part {index}"),
            Self::Of(surface) => surface.fmt(f),
            Self::Plane => f.write_str("plane"),
            Self::Dome => f.write_str("dome"),
            Self::Table => f.write_str("table"),
            Self::ArcTrack => f.write_str("curved track"),
        }
    }
}

/// What is wrong with the outline of a solid of revolution. Lengths in m.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum ProfileError {
    /// A length that must be more than 0.
    NotPositive {
        /// Which: "foot", "rim", "radius" or "top".
        what: &'static str,
        /// Its value.
        value: f64,
    },
    /// Fewer than three points.
    FewPoints {
        /// How many there are.
        points: usize,
    },
    /// A point that is not above the one before it, or above the rim.
    Falls {
        /// Its height.
        height: f64,
        /// The height that it must exceed.
        after: f64,
    },
    /// A point that is not below the top.
    AboveTop {
        /// Its height.
        height: f64,
        /// That of the top.
        top: f64,
    },
    /// The top is too little above the last point.
    NoRoom {
        /// The height of the top.
        top: f64,
        /// The height of the last point.
        height: f64,
        /// The least that it must be above it.
        least: f64,
    },
}

impl ProfileError {
    /// What is wrong and what would be right, with lengths in a unit of this name and size in m.
    #[must_use]
    pub fn in_units(&self, unit: &str, size: f64) -> String {
        // Without the digits that only rounding makes.
        let of = |length: f64| format!("{} {unit}", (length / size * 1e6).round() / 1e6);
        match *self {
            Self::NotPositive { what, value } => format!("the {what} is {}, expected more than 0", of(value)),
            Self::FewPoints { points } => format!("the outline has {points} points, expected at least 3"),
            Self::Falls { height, after } => format!(
                "a point of the outline is at the height {}, expected more than {}: heights rise from the rim's on",
                of(height),
                of(after)
            ),
            Self::AboveTop { height, top } => {
                format!(
                    "a point of the outline is at the height {}, expected less than the top's, {}",
                    of(height),
                    of(top)
                )
            }
            Self::NoRoom { top, height, least } => format!(
                "the top is at {}, expected at least {}: {} above the outline's last point",
                of(top),
                of(height + least),
                of(least)
            ),
        }
    }
}

impl fmt::Display for ProfileError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.in_units("m", 1.0))
    }
}

/// A world or a state that cannot be simulated, with the body, triangle or surface at fault.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum WorldError {
    /// A number of a body is NaN, infinite, or out of range.
    #[error("body {body}: {field} is {value}, expected {expected}")]
    BadBody {
        /// Index of the body.
        body: usize,
        /// Which number.
        field: &'static str,
        /// Its value.
        value: f64,
        /// The value expected.
        expected: &'static str,
    },
    /// A coefficient of a pair law is NaN or out of range.
    #[error("law between materials {a} and {b}: {field} is {value}, out of its range")]
    BadLaw {
        /// First material.
        a: u16,
        /// Second material.
        b: u16,
        /// Which coefficient.
        field: &'static str,
        /// Its value.
        value: f64,
    },
    /// A material without a law.
    #[error("material {material} is not in the table of {known} materials")]
    UnknownMaterial {
        /// The material named.
        material: u16,
        /// How many there are.
        known: u16,
    },
    /// Two bodies overlap at the start.
    #[error("bodies {a} and {b} overlap by {depth} m at the start")]
    BodiesOverlap {
        /// The lower index.
        a: usize,
        /// The higher index.
        b: usize,
        /// Penetration in metres.
        depth: f64,
    },
    /// A body overlaps the scenery at the start.
    #[error("body {body} overlaps {surface} by {depth} m at the start")]
    OverlapsScenery {
        /// Index of the body.
        body: usize,
        /// Which surface.
        surface: SurfaceId,
        /// Penetration in metres.
        depth: f64,
    },
    /// A triangle with no area, or with a corner that is NaN or infinite.
    #[error("triangle {triangle} is degenerate (area {area} m²)")]
    DegenerateTriangle {
        /// Index of the triangle.
        triangle: usize,
        /// Its area in m².
        area: f64,
    },
    /// A triangle names a vertex that the mesh lacks.
    #[error("triangle {triangle} names vertex {vertex}, but the mesh has only {vertices} vertices")]
    UnknownVertex {
        /// Index of the triangle.
        triangle: usize,
        /// The vertex named.
        vertex: usize,
        /// How many there are.
        vertices: usize,
    },
    /// Two triangles run along an edge in the same direction, or more than two share it.
    #[error(
        "edge {from}–{to} of triangle {triangle} is shared by triangles that disagree on which side is outside, or by more than two"
    )]
    BadEdge {
        /// Index of the later triangle.
        triangle: usize,
        /// First vertex of the edge.
        from: usize,
        /// Second vertex of the edge.
        to: usize,
    },
    /// A vertex was moved farther than the margin that its mesh was made with.
    #[error("vertex {vertex} moved {distance} m from its original place, more than its margin of {margin} m")]
    MovedTooFar {
        /// Index of the vertex.
        vertex: usize,
        /// How far, in metres.
        distance: f64,
        /// The margin in metres.
        margin: f64,
    },
    /// A number of a plane, dome, curved track or spline surface is NaN, infinite, or out of range.
    #[error("{surface}: {field} is {value}, expected {expected}")]
    BadSurface {
        /// Which surface.
        surface: SurfaceId,
        /// Which number.
        field: &'static str,
        /// Its value.
        value: f64,
        /// The value expected.
        expected: &'static str,
    },
    /// A field over a surface gave a value that is not finite.
    #[error("control point ({i}, {j}) of the field \"{field}\" is {value}")]
    BadControlPoint {
        /// Which field.
        field: &'static str,
        /// First index.
        i: i64,
        /// Second index.
        j: i64,
        /// The value given.
        value: f64,
    },
    /// A number of the world as a whole or of its accuracy is out of range.
    #[error("{field} is {value}, expected {expected}")]
    BadNumber {
        /// Which number.
        field: &'static str,
        /// Its value.
        value: f64,
        /// The value expected.
        expected: &'static str,
    },
    /// A bad outline of a solid of revolution.
    #[error("{0}")]
    BadProfile(ProfileError),
    /// A point of a hull that is not finite.
    #[error("point {point} of a hull is {at}, expected finite numbers")]
    BadPoint {
        /// Index of the point.
        point: usize,
        /// Its coordinates.
        at: DVec3,
    },
    /// Too few points for a hull.
    #[error("{points} distinct points have no hull: at least 4 are needed")]
    FewPoints {
        /// How many there are.
        points: usize,
    },
    /// Points of a hull that are all in one plane.
    #[error("the {points} points of a hull are all within {thickness} m of one plane")]
    FlatHull {
        /// How many there are.
        points: usize,
        /// Largest distance in metres at which they count as in the plane.
        thickness: f64,
    },
    /// A hull with too many points, corners or corners of one face.
    #[error("a hull has {count} {what}, but at most {most} are supported")]
    LargeHull {
        /// What is too many.
        what: &'static str,
        /// How many there are.
        count: usize,
        /// The largest number allowed.
        most: usize,
    },
    /// Points so nearly in one plane that rounding would decide the faces of their hull.
    #[error(
        "the faces of a hull near point {point} cannot be distinguished: move it into their plane, or farther out of it"
    )]
    UnclearHull {
        /// Index of a point near there.
        point: usize,
    },
    /// An invalid solid of a compound.
    #[error("solid {member} of a compound: {field} is {value}, expected {expected}")]
    BadMember {
        /// Its index.
        member: usize,
        /// Which number.
        field: &'static str,
        /// Its value.
        value: f64,
        /// The value expected.
        expected: &'static str,
    },
    /// An invalid key of a body that follows keyframes.
    #[error("body {body}: key {key} of its {track}: {field} is {value}, expected {expected}")]
    BadKey {
        /// Index of the body.
        body: usize,
        /// Which track.
        track: &'static str,
        /// Index of the key.
        key: usize,
        /// Which number.
        field: &'static str,
        /// Its value.
        value: f64,
        /// The value expected.
        expected: &'static str,
    },
    /// An invalid joint.
    #[error("joint {joint}: {field} is {value}, expected {expected}")]
    BadJoint {
        /// Its number: joints count from 0 in the order in which they were added.
        joint: usize,
        /// What is wrong.
        field: &'static str,
        /// Its value.
        value: f64,
        /// The value expected.
        expected: &'static str,
    },
    /// A state made for another world.
    #[error("the state has {state} bodies, the world {world}")]
    WrongState {
        /// Bodies of the state.
        state: usize,
        /// Bodies of the world.
        world: usize,
    },
}

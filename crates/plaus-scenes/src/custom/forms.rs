//! Shapes of bodies and of scenery, as in scenario files.

use super::amount::{Amount, Angle, Factor, Length, Place, Rounding};
use super::from_file::{FromFile, Wanted};
use crate::scene::ConfigError;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The shape of a body.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Shape {
    /// A ball.
    Ball(Ball),
    /// A box.
    Box(Cuboid),
    /// A cylinder about its z axis: a coin, a can.
    Cylinder(Cylinder),
    /// A cone whose tip points along its z axis.
    Cone(Cone),
    /// A rod with round ends along its z axis.
    Capsule(Capsule),
    /// An egg or a lens, simulated as a polyhedron.
    Ellipsoid(Ellipsoid),
    /// The convex hull of points.
    Hull(Hull),
    /// A solid of revolution about its z axis: a pin, a chess piece.
    Revolution(Revolution),
    /// Several shapes joined into one body.
    Compound(Compound),
    /// The convex hull of the triangles in a file: hollows are filled.
    HullOf(FromFile),
    /// A die with 4, 8, 10, 12 or 20 faces.
    Die(Die),
}

/// The shape of a piece of a compound.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Convex {
    /// A ball.
    Ball(Ball),
    /// A box.
    Box(Cuboid),
    /// A cylinder about its z axis.
    Cylinder(Cylinder),
    /// A cone whose tip points along its z axis.
    Cone(Cone),
    /// A rod with round ends along its z axis.
    Capsule(Capsule),
    /// An egg or a lens, simulated as a polyhedron.
    Ellipsoid(Ellipsoid),
    /// The convex hull of points.
    Hull(Hull),
    /// The convex hull of the triangles in a file.
    HullOf(FromFile),
}

/// The shape of a piece of scenery.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Still {
    /// A plane: everything below it, seen along its z axis, is solid.
    Plane(Plane),
    /// A table with random bumps; like a plane, it has no edges.
    Table(Table),
    /// A ball.
    Ball(Ball),
    /// A box.
    Box(Cuboid),
    /// A cylinder about its z axis.
    Cylinder(Cylinder),
    /// A cone whose tip points along its z axis.
    Cone(Cone),
    /// A rod with round ends along its z axis.
    Capsule(Capsule),
    /// An egg or a lens, simulated as a polyhedron.
    Ellipsoid(Ellipsoid),
    /// The convex hull of points.
    Hull(Hull),
    /// Several shapes joined into one.
    Compound(Compound),
    /// The convex hull of the triangles in a file: hollows are filled.
    HullOf(FromFile),
    /// The triangles of a file unchanged, solid behind their faces.
    Mesh(FromFile),
    /// Ground by its heights, solid below.
    Heights(Heights),
    /// A curved track: a loop, a quarter pipe, a half pipe, a bend.
    Arc(ArcOf),
}

/// An infinite plane.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Plane {}

/// A table with random bumps: its height is a smooth curve (a uniform cubic b-spline) through random control points on
/// a square grid, whose origin is at `at_mm`. It is level unless `turn_deg` turns it. All points of all properties are
/// independent of each other.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Table {
    /// Standard deviation of a control point's height about that of `at_mm`. Heights beyond six of them count as six.
    pub bumps_mm: Amount<Rounding>,
    /// Distance between neighbouring control points.
    pub spacing_mm: Amount<Length>,
    /// Coulomb's coefficient of friction between the table and whatever touches it. Unset: it follows from the
    /// materials.
    #[serde(default)]
    pub friction: Option<Patchy>,
    /// Restitution between the table and whatever hits it. Unset: it follows from the materials.
    #[serde(default)]
    pub restitution: Option<Patchy>,
}

/// Random bumps on a mesh, a box without rounding, or ground by its heights. The surface is cut into triangles with
/// edges of at most half of `spacing_mm`, and each of their corners is moved along its normal by the value there of a
/// smooth random field in space: a uniform cubic b-spline over control points on a cubic grid along the shape's axes,
/// through its origin. All points are independent of each other. A draw in which bumps turn a triangle over has
/// probability 0.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SurfaceBumps {
    /// Standard deviation of a control point's value. Values beyond six of them count as six.
    pub sd_mm: Amount<Rounding>,
    /// Distance between neighbouring control points.
    pub spacing_mm: Amount<Length>,
}

/// Ground by its heights at the points of a square grid, whose middle is at `at_mm`. Beyond the grid there is nothing.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Heights {
    /// Heights above `at_mm`: one row for each y, in ascending order, and in a row one height for each x. A square of
    /// the grid is two triangles, cut from its corner of least x and y to the opposite one.
    #[schemars(length(min = 2))]
    pub rows_mm: Vec<Vec<Amount<Place>>>,
    /// Distance between neighbouring points.
    pub spacing_mm: Amount<Length>,
}

/// A curved track: the inside of an arc of a cylinder, exactly round. Its axis is the y axis through `at_mm`; angles
/// are counted about it from x towards z, so that the track is lowest at −90, and what comes along x goes up from
/// there. Its back, sides and ends are solid too.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ArcOf {
    /// Radius of the cylinder.
    pub radius_mm: Amount<Length>,
    /// Angle at which the track begins.
    pub from_deg: Amount<Angle>,
    /// Angle at which it ends: a larger one.
    pub to_deg: Amount<Angle>,
    /// Its extent along y. Where it begins, its middle is at the y of `at_mm`.
    pub width_mm: Amount<Length>,
    /// How far it moves along y in a turn, so that a loop ends beside its beginning. A track of more than one turn
    /// needs at least its width, and a wall's thickness where it has walls.
    #[serde(default)]
    pub pitch_mm: Amount<Place>,
    /// Thickness of what is solid behind it, and of its walls. Unset: a twentieth of the radius.
    #[serde(default)]
    pub thickness_mm: Option<Amount<Length>>,
    /// Height of walls along its sides, less than the radius; 0 for none. They lead what rolls along a track with a
    /// pitch.
    #[serde(default)]
    pub walls_mm: Amount<Rounding>,
}

/// A coefficient that differs from place to place: a curve through random control points on the same grid as the
/// bumps.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Patchy {
    /// Mean of a control point's normal law, before the law is cut off where the coefficient can have no values.
    #[schemars(range(min = 0.0, max = 10.0))]
    pub mean: f64,
    /// Standard deviation of that law. At most a twentieth of it may be cut off.
    #[schemars(range(min = 0.0, max = 10.0))]
    pub sd: f64,
}

/// A ball.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Ball {
    /// Its radius.
    pub radius_mm: Amount<Length>,
}

/// A box.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Cuboid {
    /// Its edges along x, y and z.
    pub size_mm: [Amount<Length>; 3],
    /// Radius of its edges and corners; 0 is sharp. The faces do not move.
    #[serde(default)]
    pub rounding_mm: Amount<Rounding>,
}

/// A cylinder.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Cylinder {
    /// Its radius.
    pub radius_mm: Amount<Length>,
    /// Distance between its faces.
    pub height_mm: Amount<Length>,
}

/// A cone.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Cone {
    /// Radius of its base.
    pub radius_mm: Amount<Length>,
    /// Distance from base to tip; `at_mm` is half way between them.
    pub height_mm: Amount<Length>,
}

/// A rod with round ends.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Capsule {
    /// Its radius.
    pub radius_mm: Amount<Length>,
    /// Distance between the centres of its round ends.
    pub length_mm: Amount<Length>,
}

/// An ellipsoid along its own axes. A polyhedron of its volume with 42 corners is simulated: they lie outside it by up
/// to 4.7 % of half its longest axis, and the faces' middles inside it by up to 2.3 %.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Ellipsoid {
    /// The lengths of its axes.
    pub size_mm: [Amount<Length>; 3],
}

/// The convex hull of points.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Hull {
    /// Its corners; points inside the hull are allowed.
    #[schemars(length(min = 4, max = 1000))]
    pub points_mm: Vec<[Amount<Place>; 3]>,
    /// How far the body reaches beyond the hull, on all sides; 0 is sharp.
    #[serde(default)]
    pub rounding_mm: Amount<Rounding>,
}

/// A die: a regular solid, or with 10 faces a solid of kites. Opposite faces add up to one more than there are. With 4
/// faces the one below counts, otherwise the one on top.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Die {
    /// Its number of faces: 4, 8, 10, 12 or 20. With 6, it is a box with `pips`.
    #[schemars(range(min = 4, max = 20))]
    pub sides: u32,
    /// Distance between opposite faces; with 4 faces, from a face to the opposite corner of the sharp die.
    pub size_mm: Amount<Length>,
    /// Radius of its edges and corners; 0 is sharp. The faces do not move.
    #[serde(default)]
    pub rounding_mm: Amount<Rounding>,
}

/// A solid of revolution: a flat foot with a rounded rim, a smooth curve through the points of its outline, and a top
/// that is part of a ball.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Revolution {
    /// Radius of the foot's flat.
    pub foot_mm: Amount<Length>,
    /// Rounding of the foot's rim.
    pub rim_mm: Amount<Length>,
    /// Heights above the foot and radii there, from low to high.
    #[schemars(length(min = 3, max = 100))]
    pub outline_mm: Vec<[Amount<Length>; 2]>,
    /// Height of the top. It is part of a ball: half a ball of the last radius where there is room for it, else a
    /// flatter part of a larger one.
    pub top_mm: Amount<Length>,
}

/// Several shapes joined into one body.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Compound {
    /// Its pieces. Where they overlap, their masses add up.
    #[schemars(length(min = 1, max = 256))]
    pub pieces: Vec<Piece>,
}

/// A piece of a compound.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Piece {
    /// Its shape.
    pub shape: Convex,
    /// Where its middle is in the compound.
    #[serde(default)]
    pub at_mm: [Amount<Place>; 3],
    /// How it is turned in the compound: about the x axis, then about y, then about z.
    #[serde(default)]
    pub turn_deg: [Amount<Angle>; 3],
    /// Its density, relative to that of the material.
    #[serde(default = "one")]
    pub density: Amount<Factor>,
}

fn one() -> Amount<Factor> {
    1.0.into()
}

impl From<Convex> for Shape {
    fn from(shape: Convex) -> Self {
        match shape {
            Convex::Ball(form) => Self::Ball(form),
            Convex::Box(form) => Self::Box(form),
            Convex::Cylinder(form) => Self::Cylinder(form),
            Convex::Cone(form) => Self::Cone(form),
            Convex::Capsule(form) => Self::Capsule(form),
            Convex::Ellipsoid(form) => Self::Ellipsoid(form),
            Convex::Hull(form) => Self::Hull(form),
            Convex::HullOf(form) => Self::HullOf(form),
        }
    }
}

/// A function that is called for each file of a shape, with its key relative to that shape.
pub(super) type EachFile<'a> = &'a mut dyn FnMut(&str, Wanted, &mut FromFile) -> Result<(), ConfigError>;

impl Compound {
    fn for_files(&mut self, each: EachFile<'_>) -> Result<(), ConfigError> {
        for (index, piece) in self.pieces.iter_mut().enumerate() {
            if let Convex::HullOf(file) = &mut piece.shape {
                each(&format!("compound.pieces[{index}].shape.hull_of"), Wanted::Hull, file)?;
            }
        }
        Ok(())
    }
}

impl Shape {
    /// Its name in scenario files.
    pub(super) fn name(&self) -> &'static str {
        match self {
            Self::Ball(_) => "ball",
            Self::Box(_) => "box",
            Self::Cylinder(_) => "cylinder",
            Self::Cone(_) => "cone",
            Self::Capsule(_) => "capsule",
            Self::Ellipsoid(_) => "ellipsoid",
            Self::Hull(_) => "hull",
            Self::Revolution(_) => "revolution",
            Self::Compound(_) => "compound",
            Self::HullOf(_) => "hull_of",
            Self::Die(_) => "die",
        }
    }

    /// Visits the files that it names.
    pub(super) fn for_files(&mut self, each: EachFile<'_>) -> Result<(), ConfigError> {
        match self {
            Self::HullOf(file) => each("hull_of", Wanted::Hull, file),
            Self::Compound(compound) => compound.for_files(each),
            _ => Ok(()),
        }
    }
}

impl Still {
    /// The solid; `None` for a plane, a table, a mesh, ground by its heights or a curved track.
    pub(super) fn solid(&self) -> Option<Shape> {
        Some(match self.clone() {
            Self::Plane(_) | Self::Table(_) | Self::Mesh(_) | Self::Heights(_) | Self::Arc(_) => return None,
            Self::Ball(form) => Shape::Ball(form),
            Self::Box(form) => Shape::Box(form),
            Self::Cylinder(form) => Shape::Cylinder(form),
            Self::Cone(form) => Shape::Cone(form),
            Self::Capsule(form) => Shape::Capsule(form),
            Self::Ellipsoid(form) => Shape::Ellipsoid(form),
            Self::Hull(form) => Shape::Hull(form),
            Self::Compound(form) => Shape::Compound(form),
            Self::HullOf(form) => Shape::HullOf(form),
        })
    }

    /// Visits the files that it names.
    pub(super) fn for_files(&mut self, each: EachFile<'_>) -> Result<(), ConfigError> {
        match self {
            Self::Mesh(file) => each("mesh", Wanted::Triangles, file),
            Self::HullOf(file) => each("hull_of", Wanted::Hull, file),
            Self::Compound(compound) => compound.for_files(each),
            _ => Ok(()),
        }
    }
}

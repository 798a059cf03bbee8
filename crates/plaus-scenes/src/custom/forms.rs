//! Shapes of bodies and of scenery, as scenario files have them.

use super::amount::{Amount, Length, Place, Rounding};
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
    /// The convex hull of points.
    Hull(Hull),
}

/// The shape of what stands still.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Still {
    /// A plane: everything below it, seen along its z axis, is solid.
    Plane(Plane),
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
    /// The convex hull of points.
    Hull(Hull),
}

/// A plane without end.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Plane {}

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
    /// Radius of its edges and corners; 0 is sharp. Faces stay where they are.
    #[serde(default)]
    pub rounding_mm: Amount<Rounding>,
}

/// A cylinder.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Cylinder {
    /// Its radius.
    pub radius_mm: Amount<Length>,
    /// From face to face.
    pub height_mm: Amount<Length>,
}

/// A cone.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Cone {
    /// Radius of its foot.
    pub radius_mm: Amount<Length>,
    /// From foot to tip; `at_mm` is half way between them.
    pub height_mm: Amount<Length>,
}

/// A rod with round ends.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Capsule {
    /// Its radius.
    pub radius_mm: Amount<Length>,
    /// Between the middles of its round ends.
    pub length_mm: Amount<Length>,
}

/// The convex hull of points.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Hull {
    /// Its corners; points inside do no harm.
    #[schemars(length(min = 4, max = 1000))]
    pub points_mm: Vec<[Amount<Place>; 3]>,
    /// How far the body reaches beyond the hull, all around; 0 is sharp.
    #[serde(default)]
    pub rounding_mm: Amount<Rounding>,
}

impl Shape {
    /// What stands in the file for it.
    pub(super) fn name(&self) -> &'static str {
        match self {
            Self::Ball(_) => "ball",
            Self::Box(_) => "box",
            Self::Cylinder(_) => "cylinder",
            Self::Cone(_) => "cone",
            Self::Capsule(_) => "capsule",
            Self::Hull(_) => "hull",
        }
    }
}

impl Still {
    /// The solid; `None` for a plane.
    pub(super) fn solid(&self) -> Option<Shape> {
        Some(match self.clone() {
            Self::Plane(_) => return None,
            Self::Ball(form) => Shape::Ball(form),
            Self::Box(form) => Shape::Box(form),
            Self::Cylinder(form) => Shape::Cylinder(form),
            Self::Cone(form) => Shape::Cone(form),
            Self::Capsule(form) => Shape::Capsule(form),
            Self::Hull(form) => Shape::Hull(form),
        })
    }
}

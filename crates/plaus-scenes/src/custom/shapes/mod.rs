//! Shapes: one file and one row each. A shape's file has its keys, how they are read, and what is simulated and drawn.

mod arc;
mod ball;
mod compound;
mod cuboid;
mod cup;
mod die;
pub(crate) mod ellipsoid;
mod form;
mod frustum;
mod heights;
mod hull;
mod made;
mod of_file;
mod plane;
mod revolution;
mod table;
mod what;

pub use self::{
    arc::ArcOf, ball::Ball, compound::Compound, compound::Piece, cuboid::Cuboid, cup::Cup, die::Die,
    ellipsoid::Ellipsoid, frustum::Capsule, frustum::Cone, frustum::Cylinder, heights::Heights, hull::Hull,
    of_file::HullOf, of_file::Mesh, plane::Plane, revolution::Revolution, table::Patchy, table::Table,
};

pub(super) use form::{Form, Reader, Round};
pub(super) use made::Made;
pub(super) use what::{Faces, What};

use super::amount::{Amount, Angle, Factor, Length, Place, Rounding};
use super::from_file::{FromFile, Wanted};
use super::values::{Collector, MM, Numbers, Owner, Value, Values, vector};
use crate::animation;
use crate::scene::ConfigError;
use plaus_sim::WorldError;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// What the keys of every shape must provide.
trait Said<Read = Form> {
    /// Visits the files that it names; `key` is its own.
    fn for_files(&mut self, _key: &str, _each: EachFile<'_>) -> Result<(), ConfigError> {
        Ok(())
    }

    /// What it is with its numbers as values: a [`Form`], unless it can only stand still.
    fn read(&self, reader: &mut Reader<'_>) -> Result<Read, ConfigError>;
}

/// A function that is called for each file that shapes name, with its key.
pub(super) type EachFile<'a> = &'a mut dyn FnMut(&str, Wanted, &mut FromFile) -> Result<(), ConfigError>;

/// One of the places for shapes: an enum of those that may stand there, each with its name in scenario files.
macro_rules! place {
    ($about:literal $Place:ident: $Read:ty { $(#[$doc:meta] { $Name:ident($Said:ty) = $name:literal })* }) => {
        #[doc = $about]
        #[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
        pub enum $Place {
            $(#[$doc] #[serde(rename = $name)] $Name($Said),)*
        }

        impl $Place {
            /// Its name in scenario files.
            pub(super) fn name(&self) -> &'static str {
                match self {
                    $(Self::$Name(_) => $name,)*
                }
            }

            /// Visits the files that it names; `at` is the key that it is the value of.
            pub(super) fn for_files(&mut self, at: &str, each: EachFile<'_>) -> Result<(), ConfigError> {
                let key = format!("{at}.{}", self.name());
                match self {
                    $(Self::$Name(said) => said.for_files(&key, each),)*
                }
            }

            /// The same with its numbers as values; `reader` is that of the table that has it as `shape`.
            pub(super) fn read(&self, reader: &mut Reader<'_>) -> Result<$Read, ConfigError> {
                let own = &mut reader.within(&format!("shape.{}", self.name()), "");
                Ok(match self {
                    $(Self::$Name(said) => said.read(own)?.into(),)*
                })
            }
        }
    };
}

/// Sorts rows into those of bodies, of pieces of compounds and of scenery.
macro_rules! shapes {
    ([$($body:tt)*] [$($piece:tt)*] [$($still:tt)*]) => {
        place! { "The shape of a body." Shape: Form { $($body)* } }
        place! { "The shape of a piece of a compound." Convex: Form { $($piece)* } }
        place! { "The shape of a piece of scenery." Still: What { $($still)* } }
    };
    ([$($b:tt)*] [$($p:tt)*] [$($s:tt)*] #[$doc:meta] $row:tt anywhere $($rest:tt)*) => {
        shapes! { [$($b)* #[$doc] $row] [$($p)* #[$doc] $row] [$($s)* #[$doc] $row] $($rest)* }
    };
    ([$($b:tt)*] $p:tt [$($s:tt)*] #[$doc:meta] $row:tt as body and scenery $($rest:tt)*) => {
        shapes! { [$($b)* #[$doc] $row] $p [$($s)* #[$doc] $row] $($rest)* }
    };
    ([$($b:tt)*] $p:tt $s:tt #[$doc:meta] $row:tt as body $($rest:tt)*) => {
        shapes! { [$($b)* #[$doc] $row] $p $s $($rest)* }
    };
    ($b:tt $p:tt [$($s:tt)*] #[$doc:meta] $row:tt as scenery $($rest:tt)*) => {
        shapes! { $b $p [$($s)* #[$doc] $row] $($rest)* }
    };
}

shapes! {
    [] [] []
    /// A plane: everything below it, seen along its z axis, is solid.
    { Plane(Plane) = "plane" } as scenery
    /// A table with random bumps; like a plane, it has no edges.
    { Table(Table) = "table" } as scenery
    /// A ball.
    { Ball(Ball) = "ball" } anywhere
    /// A box.
    { Box(Cuboid) = "box" } anywhere
    /// A cylinder about its z axis: a coin, a can.
    { Cylinder(Cylinder) = "cylinder" } anywhere
    /// A cone whose tip points along its z axis.
    { Cone(Cone) = "cone" } anywhere
    /// A rod with round ends along its z axis.
    { Capsule(Capsule) = "capsule" } anywhere
    /// An egg or a lens, simulated as a polyhedron.
    { Ellipsoid(Ellipsoid) = "ellipsoid" } anywhere
    /// The convex hull of points.
    { Hull(Hull) = "hull" } anywhere
    /// A solid of revolution about its z axis: a pin, a chess piece.
    { Revolution(Revolution) = "revolution" } as body
    /// Several shapes joined into one.
    { Compound(Compound) = "compound" } as body and scenery
    /// A cup, hollow and open at the top of its z axis.
    { Cup(Cup) = "cup" } as body and scenery
    /// The convex hull of the triangles in a file: hollows are filled.
    { HullOf(HullOf) = "hull_of" } anywhere
    /// A die with 4, 8, 10, 12 or 20 faces.
    { Die(Die) = "die" } as body
    /// The triangles of a file unchanged, solid behind their faces.
    { Mesh(Mesh) = "mesh" } as scenery
    /// Ground by its heights, solid below.
    { Heights(Heights) = "heights" } as scenery
    /// A curved track: a loop, a quarter pipe, a half pipe, a bend.
    { Arc(ArcOf) = "arc" } as scenery
}

#[cfg(test)]
mod tests;

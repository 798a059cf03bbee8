//! Models of bodies with shapes and joints, where they are at the start. Includes, frames, the defaults of classes, and
//! all ways to say how something is turned are resolved; what is not read is listed with its lines.

use glam::{DMat3, DQuat, DVec3};

pub use super::xml::Open;

/// A model. Lengths are in m, z is up.
#[derive(Debug, Clone, PartialEq)]
pub struct Model {
    /// In m/s².
    pub gravity: DVec3,
    /// Each after the body that it belongs to; the first is the world.
    pub bodies: Vec<Body>,
    /// Meshes that shapes may name by their index.
    pub meshes: Vec<Mesh>,
    /// Whether meshes stand for their convex hulls.
    pub are_hulls: bool,
    /// Whether its bodies pass through each other.
    pub passes_itself: bool,
    /// What was not read although it may change motion, in words.
    pub left_out: Vec<String>,
    /// What was not read, as it has no bearing on motion.
    pub harmless: Vec<String>,
}

/// A body.
#[derive(Debug, Clone, PartialEq)]
pub struct Body {
    /// Its name; `body_1` and so on, by its index, if the file gives none.
    pub name: String,
    /// The body that it belongs to; itself for the world.
    pub parent: usize,
    /// Where its origin is in the world.
    pub at: DVec3,
    /// Turns its axes into those of the world.
    pub turn: DQuat,
    /// What lets it move in the body that it belongs to.
    pub joints: Vec<Joint>,
    /// Its shapes.
    pub geoms: Vec<Geom>,
    /// Its mass in kg, if that does not follow from its shapes.
    pub mass: Option<Inertial>,
    /// How much of gravity it does not feel: 1 is all.
    pub gravcomp: f64,
    /// Whether something outside the model moves it.
    pub is_mocap: bool,
}

/// A mass that does not follow from shapes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Inertial {
    /// In kg.
    pub mass: f64,
    /// Where its centre of gravity is in the world.
    pub at: DVec3,
    /// Its tensor of inertia about that, along the world's axes, in kg m²; 0 if it is not given.
    pub tensor: DMat3,
}

/// A joint.
#[derive(Debug, Clone, PartialEq)]
pub struct Joint {
    /// Its name, if it has one.
    pub name: Option<String>,
    /// What it lets move.
    pub kind: JointKind,
    /// Where it is in the world.
    pub at: DVec3,
    /// A unit vector along its axis, in the world.
    pub axis: DVec3,
    /// The least and the largest value, as changes from the start: of a hinge in radians, of a slide in m. Of a ball
    /// joint, the largest is the largest angle from the start.
    pub limits: Option<[f64; 2]>,
    /// Its dry friction, of a hinge in N m, of a slide in N.
    pub friction: f64,
    /// Stiffness, change from the start at which it is at rest, and damping of its spring, in rad, N m and s, or m, N
    /// and s.
    pub spring: [f64; 3],
}

/// What a joint lets move.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum JointKind {
    /// Everything.
    Free,
    /// All rotations about a point.
    Ball,
    /// The rotation about an axis.
    Hinge,
    /// The motion along an axis.
    Slide,
}

/// A shape of a body.
#[derive(Debug, Clone, PartialEq)]
pub struct Geom {
    /// Its name, if it has one.
    pub name: Option<String>,
    /// What it is, about its middle and along its axes.
    pub solid: Solid,
    /// Where it is in the world.
    pub at: DVec3,
    /// Turns its axes into those of the world.
    pub turn: DQuat,
    /// Its mass in kg, if it is given.
    pub mass: Option<f64>,
    /// In kg/m³; where its mass is given, that counts.
    pub density: f64,
    /// Coulomb's coefficient of friction, if it is given; 0 if it is said to have none.
    pub friction: Option<f64>,
    /// Whether it can touch anything.
    pub collides: bool,
    /// Red, green and blue, if they are given.
    pub colour: Option<[u8; 3]>,
    /// What of it is not read, in words.
    pub left_out: Option<String>,
}

/// A solid; lengths in m.
#[derive(Debug, Clone, PartialEq)]
pub enum Solid {
    /// A plane: everything below it is solid.
    Plane,
    /// A ball of this radius.
    Ball(f64),
    /// Half the edges of a box.
    Box(DVec3),
    /// Radius and half the height along z.
    Cylinder(f64, f64),
    /// Radius and half the distance of the middles of its round ends, along z.
    Capsule(f64, f64),
    /// Half the axes of an ellipsoid.
    Ellipsoid(DVec3),
    /// The convex hull of the mesh with this index.
    Mesh(usize),
    /// Something that is not read: a height field, for example.
    Other(String),
}

/// A mesh.
#[derive(Debug, Clone, PartialEq)]
pub struct Mesh {
    /// Its name.
    pub name: String,
    /// Where its corners come from.
    pub from: Corners,
    /// Subtracted from its corners first.
    pub origin: DVec3,
    /// The inverse of it turns them next.
    pub turn: DQuat,
    /// Multiplied with them last.
    pub scale: DVec3,
}

/// Where the corners of a mesh come from.
#[derive(Debug, Clone, PartialEq)]
pub enum Corners {
    /// A file: its path from the model's folder.
    File(String),
    /// The model itself.
    Said(Vec<DVec3>),
    /// Something that is not read.
    Unread,
}

impl Mesh {
    /// A corner where it is in the shape.
    #[must_use]
    pub fn place(&self, corner: DVec3) -> DVec3 {
        self.scale * (self.turn.inverse() * (corner - self.origin))
    }
}

/// A tensor along the world's axes, of its six numbers xx, yy, zz, xy, xz, yz along axes that `turn` turns into those.
pub(crate) fn tensor([xx, yy, zz, xy, xz, yz]: [f64; 6], turn: DQuat) -> DMat3 {
    let turn = DMat3::from_quat(turn);
    turn * DMat3::from_cols(DVec3::new(xx, xy, xz), DVec3::new(xy, yy, yz), DVec3::new(xz, yz, zz)) * turn.transpose()
}

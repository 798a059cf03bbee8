//! What a simulator needs to go on from the start of a motion. A body's own axes here are those in which y points up
//! where it is not turned; lengths are in m, with angles in radians.

use glam::{DQuat, DVec3};

/// A world at the start of a motion.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Physics {
    /// What moves, by the names of tracks.
    pub bodies: Vec<Rigid>,
    /// What stands still, by the names of scenery.
    pub scenery: Vec<Still>,
    /// Friction, restitution and static friction of pairs of materials.
    pub laws: Vec<Vec<[f64; 3]>>,
    /// Joints.
    pub joints: Vec<Joint>,
    /// Bodies, by their indices, that pass through each other.
    pub no_contact: Vec<Vec<usize>>,
    /// What of the world is not told here, one sentence each, without a full stop.
    pub left_out: Vec<String>,
}

impl Physics {
    /// Whether a body of this name follows keys.
    #[must_use]
    pub fn follows_keys(&self, name: &str) -> bool {
        self.bodies.iter().any(|body| body.name == name && body.is_driven)
    }

    /// Where scenery of this name is, and how it is turned, if it is one solid at a place.
    #[must_use]
    pub fn place_of(&self, name: &str) -> Option<(DVec3, DQuat)> {
        match &self.scenery.iter().find(|still| still.name == name)?.colliders[..] {
            [Collider { solid: Solid::Drawn, .. }] => None,
            [one] => Some((one.at, one.turn)),
            _ => None,
        }
    }
}

/// What moves.
#[derive(Debug, Clone, PartialEq)]
pub struct Rigid {
    /// Its name.
    pub name: String,
    /// Its convex solids, about the middle of its track.
    pub colliders: Vec<Collider>,
    /// Which row of the [laws](Physics::laws) it has.
    pub material: usize,
    /// Whether it follows keys.
    pub is_driven: bool,
    /// In kg.
    pub mass: f64,
    /// Principal moments of inertia in kg m².
    pub moments: DVec3,
    /// Turns their axes into its own.
    pub axes: DQuat,
    /// Where its centre of gravity is, and how it is turned.
    pub at: DVec3,
    /// Turns its own axes into the world's.
    pub turn: DQuat,
    /// In m/s, along the world's axes.
    pub velocity: DVec3,
    /// In radians per second, along the world's axes.
    pub spin: DVec3,
    /// Its acceleration by gravity over that of the Earth, 9.80665 m/s².
    pub gravity: f64,
}

/// What stands still.
#[derive(Debug, Clone, PartialEq)]
pub struct Still {
    /// Its name.
    pub name: String,
    /// Its solids, where they are in the world.
    pub colliders: Vec<Collider>,
    /// Which row of the [laws](Physics::laws) it has.
    pub material: usize,
}

/// A solid at a place.
#[derive(Debug, Clone, PartialEq)]
pub struct Collider {
    /// What it is.
    pub solid: Solid,
    /// Where its middle is.
    pub at: DVec3,
    /// How it is turned.
    pub turn: DQuat,
}

/// A solid, along y where it has an axis.
#[derive(Debug, Clone, PartialEq)]
pub enum Solid {
    /// Of this radius.
    Ball(f64),
    /// Of these edges.
    Box(DVec3),
    /// Radii at its bottom and top, and its height: a cylinder, a cone, or between the two.
    Cylinder([f64; 2], f64),
    /// Its radius, and the distance between the middles of its round ends.
    Capsule(f64, f64),
    /// All below it.
    Plane,
    /// The convex hull of corners, with triangles of it.
    Hull(Vec<DVec3>, Vec<[u32; 3]>),
    /// What is drawn of it.
    Drawn,
}

/// A joint.
#[derive(Debug, Clone, PartialEq)]
pub struct Joint {
    /// Its name.
    pub name: String,
    /// The body that it holds, by its index.
    pub body: usize,
    /// What it holds it to; the world if there is none.
    pub other: Option<usize>,
    /// Where it is in the world.
    pub at: DVec3,
    /// What it lets move: a weld nothing, a ball joint all but its point.
    pub axis: AxisKind,
}

/// What a joint lets move.
#[derive(Debug, Clone, PartialEq)]
pub enum AxisKind {
    /// Nothing.
    Weld,
    /// All rotations.
    Ball,
    /// The rotation about an axis.
    Hinge(Axis),
    /// The way along one.
    Slider(Axis),
}

/// The axis of a hinge or a slider, with its coordinate in rad or m from the start.
#[derive(Debug, Clone, PartialEq)]
pub struct Axis {
    /// Of unit length, in the world.
    pub along: DVec3,
    /// The least and the largest coordinate.
    pub limits: Option<[f64; 2]>,
    /// Stiffness, coordinate at rest, and damping of a spring.
    pub spring: Option<[f64; 3]>,
    /// The speed that a motor holds, and its greatest force or torque.
    pub motor: Option<[f64; 2]>,
}

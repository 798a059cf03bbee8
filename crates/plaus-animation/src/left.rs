//! How bodies are left where an animation ends.

use glam::{DQuat, DVec3};

/// Where a body is at a time, and how it moves, to rounding: pieces of an animation are made for pictures. In the axes
/// of scenario files, z up.
#[derive(Debug, Clone, PartialEq)]
pub struct Left {
    /// The body's name.
    pub name: String,
    /// When, in s.
    pub time: f64,
    /// Its origin, the point that a scenario gives places for, in m.
    pub position: DVec3,
    /// From its own axes to the scenario's.
    pub orientation: DQuat,
    /// Velocity of its centre of gravity, in m/s.
    pub velocity: DVec3,
    /// Angular velocity, in rad/s.
    pub spin: DVec3,
}

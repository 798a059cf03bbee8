//! A scene's world for the simulator alone, without randomness.

use glam::DVec3;
use plaus_sim::marbles::Marbles;
use plaus_sim::rigid::RigidWorld;

/// A world of either kind.
#[derive(Debug, Clone)]
pub enum Physical {
    /// Balls without orientation.
    Marbles(Box<Marbles>),
    /// Bodies that turn.
    Rigid(Box<RigidWorld>),
}

/// A world with a place for each of its bodies. z points up.
#[derive(Debug, Clone)]
pub struct PlainWorld {
    /// The world.
    pub world: Physical,
    /// Where each body can start, upright and at rest, without touching another body; it may touch the ground only by
    /// standing on it. Centres of gravity, in m.
    pub places: Vec<DVec3>,
}

//! An animation as closed-form pieces, from which any frame rate can be drawn exactly.

use glam::DVec3;
use serde::{Deserialize, Serialize};

/// Motion of all bodies from time 0 to `duration`. Metres and seconds, y up.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Animation {
    /// Seconds.
    pub duration: f64,
    /// One a body, with stable names.
    pub tracks: Vec<Track>,
    /// Impacts in order of time.
    pub impacts: Vec<Impact>,
}

/// The motion of one body.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Track {
    /// Stable name, e.g. `ball_0`.
    pub name: String,
    /// Pieces in order of time; each is valid until the next begins.
    pub pieces: Vec<Piece>,
}

/// Motion under constant acceleration from `start` on.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Piece {
    /// Seconds.
    pub start: f64,
    /// Position at `start`.
    pub position: DVec3,
    /// Velocity at `start`.
    pub velocity: DVec3,
    /// Acceleration throughout.
    pub acceleration: DVec3,
}

/// A contact of a body with something else.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Impact {
    /// Seconds.
    pub time: f64,
    /// The body's name.
    pub body: String,
    /// What it hit.
    pub other: String,
    /// Where.
    pub point: DVec3,
    /// Unit normal of the surface hit.
    pub normal: DVec3,
}

impl Track {
    /// Position at `time`; before the first piece the body is where that begins.
    #[must_use]
    pub fn position(&self, time: f64) -> DVec3 {
        let next = self.pieces.partition_point(|piece| piece.start <= time);
        match self.pieces.get(next.saturating_sub(1)) {
            Some(piece) => {
                let t = (time - piece.start).max(0.0);
                piece.position + t * (piece.velocity + 0.5 * t * piece.acceleration)
            }
            None => DVec3::ZERO,
        }
    }
}

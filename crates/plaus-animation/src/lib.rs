//! An animation as closed-form pieces, from which any frame rate can be drawn exactly, with everything needed to show
//! it.
//!
//! ```
//! use glam::DVec3;
//! use plaus_animation::{Animation, Look, Piece, Prop, Shape, Track};
//!
//! // A ball of 2 cm falls from 1 m for a quarter of a second.
//! let fall = Piece::ballistic(0.0, DVec3::Y, DVec3::ZERO, DVec3::new(0.0, -9.81, 0.0));
//! let ball = Track::new("ball_0", Shape::ball(0.01), Look::nth(0), vec![fall]);
//! let table = Prop::block("table", Look::WOOD, DVec3::new(0.0, -0.05, 0.0), DVec3::new(0.5, 0.05, 0.5));
//! let animation = Animation::new(0.25, vec![ball], vec![]).with_scenery(vec![table]);
//! assert!((animation.motion.tracks[0].position(0.2).y - (1.0 - 0.5 * 9.81 * 0.04)).abs() < 1e-15);
//! ```
//!
//! Metres, seconds, radians, kilograms; right-handed, y up.

mod axes;
mod breaking;
mod called;
mod contact;
mod eye;
mod impact;
mod left;
mod look;
mod motion;
mod name;
mod physics;
mod scenery;
mod shape;
mod surface;
mod track;

pub use axes::{UPRIGHT, upright};
pub use breaking::Break;
pub use called::Called;
pub use contact::Contact;
pub use eye::Eye;
pub use impact::Impact;
pub use left::Left;
pub use look::{Colour, Look, Material};
pub use motion::Motion;
pub use physics::{Axis, AxisKind, Collider, Joint, Physics, Rigid, Solid, Still};
pub use scenery::{Form, Prop, View};
pub use shape::{Shape, Stripe};
pub use track::{Piece, Track, Turn};

use serde::{Deserialize, Serialize};

/// A motion among scenery, as it is shown.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Animation {
    /// How all bodies move.
    pub motion: Motion,
    /// How bodies are left at the end, if the scene tells; not written, because it follows from the draw.
    #[serde(skip)]
    pub left: Vec<Left>,
    /// Scenery.
    pub scenery: Vec<Prop>,
    /// The best viewpoint, if the scene knows it.
    pub view: Option<View>,
}

impl Animation {
    /// Bodies that move, and their impacts in order of time.
    #[must_use]
    pub fn new(duration: f64, tracks: Vec<Track>, impacts: Vec<Impact>) -> Self {
        Self::from(Motion::new(duration, tracks, impacts))
    }

    /// The same with how bodies are left at the end.
    #[must_use]
    pub fn with_left(self, left: Vec<Left>) -> Self {
        Self { left, ..self }
    }

    /// The look of a body or a part of the scenery; `None` if nothing has that name.
    #[must_use]
    pub fn look_of(&self, name: &str) -> Option<Look> {
        let body = self.motion.tracks.iter().find(|track| track.name == name).map(|track| track.look);
        body.or_else(|| self.scenery.iter().find(|prop| prop.name == name).map(|prop| prop.look))
    }

    /// The same until `end` s: see [`Motion::until`].
    #[must_use]
    pub fn until(self, end: f64) -> Self {
        Self { motion: self.motion.until(end), ..self }
    }

    /// The same among scenery.
    #[must_use]
    pub fn with_scenery(self, scenery: Vec<Prop>) -> Self {
        Self { scenery, ..self }
    }

    /// The same, seen from a good viewpoint.
    #[must_use]
    pub fn with_view(self, view: View) -> Self {
        Self { view: Some(view), ..self }
    }
}

impl From<Motion> for Animation {
    /// Without scenery.
    fn from(motion: Motion) -> Self {
        Self { motion, left: Vec::new(), scenery: Vec::new(), view: None }
    }
}

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
//! assert!((animation.tracks[0].position(0.2).y - (1.0 - 0.5 * 9.81 * 0.04)).abs() < 1e-15);
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

pub use axes::{UPRIGHT, upright};
pub use breaking::Break;
pub use called::Called;
pub use contact::Contact;
pub use eye::Eye;
pub use impact::Impact;
pub use left::Left;
pub use look::{Colour, Look, Material};
pub use motion::{Piece, Track, Turn};
pub use physics::{Axis, AxisKind, Collider, Joint, Physics, Rigid, Solid, Still};
pub use scenery::{Form, Prop, View};
pub use shape::{Shape, Stripe};

use serde::{Deserialize, Serialize};

/// Motion of all bodies from time 0 to `duration`, among scenery.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Animation {
    /// Seconds.
    pub duration: f64,
    /// One for each body, with stable names.
    pub tracks: Vec<Track>,
    /// Impacts in order of time.
    pub impacts: Vec<Impact>,
    /// Lasting contacts, in order of their starts.
    pub contacts: Vec<Contact>,
    /// Joints that break, in order of time.
    #[serde(default)]
    pub breaks: Vec<Break>,
    /// How bodies are left at the end, if the scene tells; not written, because it follows from the draw.
    #[serde(skip)]
    pub left: Vec<Left>,
    /// Numbers of its draw that requirements ask for; not written, because they follow from the draw.
    #[serde(skip)]
    pub numbers: Vec<f64>,
    /// Scenery.
    pub scenery: Vec<Prop>,
    /// The best viewpoint, if the scene knows it.
    pub view: Option<View>,
}

impl Animation {
    /// Bodies that move, and their impacts in order of time.
    #[must_use]
    pub fn new(duration: f64, tracks: Vec<Track>, impacts: Vec<Impact>) -> Self {
        let (contacts, breaks, left, numbers, scenery) = Default::default();
        Self { duration, tracks, impacts, contacts, breaks, left, numbers, scenery, view: None }
    }

    /// The same with lasting contacts, in order of their starts.
    #[must_use]
    pub fn with_contacts(self, contacts: Vec<Contact>) -> Self {
        Self { contacts, ..self }
    }

    /// The same with joints that break, in order of time.
    #[must_use]
    pub fn with_breaks(self, breaks: Vec<Break>) -> Self {
        Self { breaks, ..self }
    }

    /// The same with how bodies are left at the end.
    #[must_use]
    pub fn with_left(self, left: Vec<Left>) -> Self {
        Self { left, ..self }
    }

    /// The look of a body or a part of the scenery; `None` if nothing has that name.
    #[must_use]
    pub fn look_of(&self, name: &str) -> Option<Look> {
        let body = self.tracks.iter().find(|track| track.name == name).map(|track| track.look);
        body.or_else(|| self.scenery.iter().find(|prop| prop.name == name).map(|prop| prop.look))
    }

    /// One body alone, with its impacts and contacts; `None` if no body has that name.
    #[must_use]
    pub fn only(&self, body: &str) -> Option<Self> {
        let track = self.tracks.iter().find(|track| track.name == body)?;
        let impacts = self.impacts.iter().filter(|hit| hit.involves(body)).cloned().collect();
        let contacts = self.contacts.iter().filter(|contact| contact.involves(body)).cloned();
        Some(Self::new(self.duration, vec![track.clone()], impacts).with_contacts(contacts.collect()))
    }

    /// The same until `end` s. If the animation ends earlier, bodies then stay where they are; anything later than
    /// `end` is left out.
    #[must_use]
    pub fn until(mut self, end: f64) -> Self {
        self.tracks.retain(|track| track.appears().is_none_or(|appears| appears <= end));
        for track in &mut self.tracks {
            let last = (track.position(self.duration), track.orientation(self.duration));
            if end > self.duration && track.pieces.last().is_some_and(|piece| !piece.rests()) {
                track.pieces.push(Piece::resting(self.duration, last.0).turning(Turn::still(last.1)));
            }
            let kept = track.pieces.partition_point(|piece| piece.start <= end).max(1);
            track.pieces.truncate(kept);
        }
        self.impacts.retain(|hit| hit.time <= end);
        self.contacts.retain(|contact| contact.start < end || contact.start == end.min(contact.end));
        self.breaks.retain(|one| one.time <= end);
        for contact in &mut self.contacts {
            // What bears on what goes on where everything stays.
            let goes_on = contact.end >= self.duration && contact.slip + contact.roll == 0.0;
            contact.end = if goes_on { end } else { contact.end.min(end) };
        }
        self.duration = end;
        self
    }

    /// When the last body has come to rest, or the end of the animation.
    #[must_use]
    pub fn rest(&self) -> f64 {
        let rest = |track: &Track| match track.pieces.last() {
            Some(piece) if piece.rests() => piece.start,
            Some(_) => self.duration,
            None => 0.0,
        };
        self.tracks.iter().map(rest).fold(0.0, f64::max).min(self.duration)
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

//! The motion of all bodies.

use super::breaking::Break;
use super::contact::Contact;
use super::impact::Impact;
use super::track::{Piece, Track, Turn};
use serde::{Deserialize, Serialize};

/// Motion of all bodies from time 0 to `duration`, with what happens to them: all that requirements are judged by, but
/// for scenery.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Motion {
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
    /// Numbers of its draw that requirements ask for; not written, because they follow from the draw.
    #[serde(skip)]
    pub numbers: Vec<f64>,
}

impl Motion {
    /// Bodies that move, and their impacts in order of time.
    #[must_use]
    pub fn new(duration: f64, tracks: Vec<Track>, impacts: Vec<Impact>) -> Self {
        Self { duration, tracks, impacts, ..Self::default() }
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
}

//! One interface to a motion: bodies by name, events by time. All kinds of requirements use it.

use super::begun::Begun;
use super::cast::{Cast, matches};
use super::score::Span;
use super::ways::{self, Leg};
use super::when::{When, Window};
use glam::DVec3;
use plaus_animation::{Contact, Impact, Motion, Prop, Track};
use plaus_dist::math;

/// Whether a body is there.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Presence {
    There,
    /// What is known of the motion does not show it.
    Unknown,
    Absent,
}

/// How a body moves.
#[derive(Debug, Clone, Copy)]
pub(super) struct Moving {
    /// In m/s.
    pub(super) velocity: DVec3,
    /// In rad/s.
    pub(super) spin: DVec3,
}

/// A motion, as far as it is known.
#[derive(Debug, Clone, Copy)]
pub struct Probe<'a> {
    motion: &'a Motion,
    /// Empty where it is not known, or no requirement is about it.
    scenery: &'a [Prop],
    cast: &'a Cast,
    /// Time up to which places and impacts are known; infinite if the motion is known to its end.
    known: f64,
    /// The same for orientations and spins, and for lasting contacts.
    turns: f64,
    contacts: f64,
    /// The body that a requirement is about if it names none.
    whom: Option<&'a str>,
}

impl<'a> Probe<'a> {
    /// A motion that is known to its end.
    #[must_use]
    pub fn whole(motion: &'a Motion, cast: &'a Cast) -> Self {
        let known = f64::INFINITY;
        Self { motion, scenery: &[], cast, known, turns: known, contacts: known, whom: cast.only() }
    }

    /// A motion that is complete before `known` s; later parts may be missing.
    #[must_use]
    pub fn until(motion: &'a Motion, cast: &'a Cast, known: f64) -> Self {
        Self { known, turns: known, contacts: known, ..Self::whole(motion, cast) }
    }

    /// The beginning of a motion.
    #[must_use]
    pub fn of(begun: &'a Begun, cast: &'a Cast) -> Self {
        let Begun { motion, known, turns, contacts } = begun;
        Self { turns: turns.min(*known), contacts: contacts.min(*known), ..Self::until(motion, cast, *known) }
    }

    /// The same among scenery.
    #[must_use]
    pub fn among(self, scenery: &'a [Prop]) -> Self {
        Self { scenery, ..self }
    }

    /// The part of it of which orientations and spins are known.
    pub(super) fn turned(self) -> Self {
        Self { known: self.turns, ..self }
    }

    /// The part of it of which lasting contacts are known.
    pub(super) fn touched(self) -> Self {
        Self { known: self.contacts, ..self }
    }

    /// The same, about `whom` if no body is named.
    pub(super) fn about(self, whom: &'a str) -> Self {
        Self { whom: Some(whom), ..self }
    }

    /// Whether the motion is known to its end.
    #[must_use]
    pub fn is_whole(&self) -> bool {
        self.known == f64::INFINITY
    }

    /// Time up to which it is known.
    pub(super) fn known(&self) -> f64 {
        self.known
    }

    /// The bodies and scenery.
    pub(super) fn cast(&self) -> &'a Cast {
        self.cast
    }

    /// The body that is named, or else the one that the requirement is about.
    pub(super) fn name<'b>(&self, name: &'b str) -> &'b str
    where
        'a: 'b,
    {
        if name.is_empty() { self.whom.unwrap_or_default() } else { name }
    }

    /// Whether a body is there; of a pattern, any that matches.
    pub(super) fn presence(&self, body: &str) -> Presence {
        if self.cast.optional.is_empty() {
            return Presence::There;
        }
        let is_optional = |name: &str| self.cast.optional.iter().any(|one| one == name);
        let name = self.name(body);
        let mut bodies = self.cast.matching(name).peekable();
        if bodies.peek().is_none() || bodies.any(|body| !is_optional(body) || self.track(body).is_some()) {
            Presence::There
        } else if self.is_whole() {
            Presence::Absent
        } else {
            Presence::Unknown
        }
    }

    /// The bodies that match a pattern, but for those that are known not to be there.
    pub(super) fn bodies<'b>(&'b self, pattern: &'b str) -> impl Iterator<Item = &'b str> {
        self.cast.matching(self.name(pattern)).filter(|body| self.presence(body) != Presence::Absent)
    }

    /// A body's motion; `None` if it has none, like a ball that is not dropped.
    pub(super) fn track(&self, name: &str) -> Option<&'a Track> {
        let name = self.name(name);
        self.motion.tracks.iter().find(|track| track.name == name)
    }

    /// The end of the motion, or of its known part.
    pub(super) fn end(&self) -> f64 {
        if self.is_whole() { self.motion.duration } else { self.known }
    }

    /// When a contact ends: after the end of the motion, everything stays as at the end.
    pub(super) fn lasts_until(&self, contact: &Contact) -> f64 {
        if self.is_whole() && contact.end >= self.motion.duration { f64::INFINITY } else { contact.end }
    }

    /// The known part of a window; `None` if none of it is known. After the end of the motion, everything stays as at
    /// the end.
    pub(super) fn seen(&self, window: Window) -> Option<[f64; 2]> {
        let end = self.end();
        match self.is_whole() {
            true => Some([window.from.clamp(0.0, end), window.to.clamp(0.0, end)]),
            false => (window.from < end).then(|| [window.from.max(0.0), window.to.min(end)]),
        }
    }

    /// Whether all of a window is known.
    pub(super) fn sees_all(&self, window: Window) -> bool {
        self.is_whole() || window.to < self.known
    }

    /// The end of the motion, as a window.
    pub(super) fn at_end(&self) -> Window {
        Window { from: self.end(), to: self.end() }
    }

    /// A time at which a body is observed, no later than the end; `None` if it is not known yet. Without a time: the
    /// end.
    pub(super) fn moment(&self, time: Option<f64>) -> Option<f64> {
        match time {
            Some(time) if time < self.known => Some(time.min(self.end())),
            _ => self.is_whole().then(|| self.end()),
        }
    }

    /// The body of the two in an impact that matches `body`.
    pub(super) fn party(&self, hit: &Impact, body: &str) -> Option<&'a Track> {
        let name = if matches(self.name(body), &hit.body) { &hit.body } else { &hit.other };
        self.motion.tracks.iter().find(|track| track.name == *name)
    }

    /// How a body moves just before a time, or just after it.
    pub(super) fn at_hit(&self, track: &Track, time: f64, after: bool) -> Option<Moving> {
        let next = if after {
            track.pieces.partition_point(|piece| piece.start <= time)
        } else {
            track.pieces.partition_point(|piece| piece.start < time)
        };
        let piece = track.pieces.get(next.saturating_sub(1))?;
        let spin = piece.turn.spin + piece.turn.own * (piece.orientation(time) * DVec3::Z);
        Some(Moving { velocity: piece.velocity(time), spin })
    }

    /// The known motion of a body in a window.
    pub(super) fn legs(&self, name: &str, window: Window) -> Vec<Leg> {
        let Some((track, [from, to])) = self.track(name).zip(self.seen(window)) else { return Vec::new() };
        ways::legs(track, from, to)
    }

    /// Impacts of bodies that match `body` with those that match `with` (anything, if it is empty) at `faster` m/s or
    /// more, in order of time, as far as they are known.
    pub(super) fn hits<'b>(&self, body: &'b str, with: &'b str, faster: f64) -> impl Iterator<Item = &'a Impact> + 'b
    where
        'a: 'b,
    {
        let (body, known) = (self.name(body), self.known);
        let fits = move |one: &str, other: &str| matches(body, one) && (with.is_empty() || matches(with, other));
        self.motion.impacts.iter().filter(move |hit| {
            hit.time < known && hit.speed >= faster && (fits(&hit.body, &hit.other) || fits(&hit.other, &hit.body))
        })
    }

    /// When a body comes to rest.
    pub(super) fn rest(&self, name: &str) -> Span {
        let last = self.track(name).and_then(|track| track.pieces.last());
        match (last.filter(|piece| piece.rests()), self.is_whole()) {
            (Some(piece), true) => Span::at(piece.start.max(0.0)),
            (None, true) => Span::NEVER,
            // A body that lies still may be struck again.
            (Some(piece), false) => Span::from(piece.start.clamp(0.0, self.known)),
            (None, false) => Span::from(self.known),
        }
    }

    /// When a body's third axis first leans so many degrees.
    pub(super) fn fall(&self, name: &str, degrees: f64) -> Span {
        let (cosine, mut begin) = (math::cos(degrees.to_radians()), 0.0);
        for leg in self.legs(name, When::default().window()) {
            if let Some(after) = leg.leans(cosine) {
                return Span::at(begin + after);
            }
            begin += leg.length;
        }
        if self.is_whole() { Span::NEVER } else { Span::from(self.known) }
    }

    /// Everything that is known of the motion.
    pub(super) fn motion(&self) -> &'a Motion {
        self.motion
    }

    /// What stands around the motion.
    pub(super) fn scenery(&self) -> &'a [Prop] {
        self.scenery
    }
}

#[cfg(test)]
mod tests {
    use super::matches;

    #[test]
    fn stars_stand_for_any_letters() {
        for (pattern, name, fits) in [
            ("die_1", "die_1", true),
            ("die_1", "die_10", false),
            ("die_*", "die_10", true),
            ("*", "", true),
            ("*_1*", "die_10", true),
            ("*x", "die", false),
            ("ä*", "äb", true),
        ] {
            assert_eq!(matches(pattern, name), fits, "{pattern} {name}");
        }
    }
}

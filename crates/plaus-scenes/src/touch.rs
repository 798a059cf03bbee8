//! Lasting contacts, found in the pieces of a motion: for sound, without influence on anything that is sampled.

use crate::animation::{Contact, Piece, Shape};
use glam::DVec3;
use plaus_sim::is_interrupted;

/// Longest contact of moving bodies reported as one, in s. It is short, so that a sound that fades during a longer
/// contact is heard to fade.
pub(crate) const LONGEST: f64 = 0.05;

/// Slowest reported motion, in m/s.
const SLOWEST: f64 = 1e-3;
/// Gravity in an animation's axes, m/s².
const GRAVITY: DVec3 = DVec3::new(0.0, -9.81, 0.0);

/// A body that may touch something for a while.
pub(crate) struct Toucher<'a> {
    pub(crate) name: &'a str,
    pub(crate) shape: &'a Shape,
    /// In kg.
    pub(crate) mass: f64,
    pub(crate) pieces: &'a [Piece],
    /// When its motion ends, in s.
    pub(crate) end: f64,
}

impl Toucher<'_> {
    /// Its contacts, if `touches` gives what it touches during a piece, by the piece's index; and the time before which
    /// these are all, if the motion is known before `known`.
    pub(crate) fn contacts(&self, known: f64, touches: impl Fn(usize) -> Option<String>) -> (Vec<Contact>, f64) {
        let mut contacts = Vec::new();
        let mut first = 0;
        while first < self.pieces.len() && !is_interrupted() {
            let Some(other) = touches(first).filter(|_| !self.pieces[first].rests()) else {
                first += 1;
                continue;
            };
            let mut after = first + 1;
            while after < self.pieces.len()
                && self.until(after) - self.pieces[first].start <= LONGEST
                && !self.pieces[after].rests()
                && touches(after).as_ref() == Some(&other)
            {
                after += 1;
            }
            if self.until(after - 1) >= known {
                // It may go on, and what it is then divided into is not known.
                return (contacts, self.pieces[first].start);
            }
            contacts.extend(self.one(first, after, other));
            first = after;
        }
        (contacts, known)
    }

    /// When a piece ends.
    fn until(&self, index: usize) -> f64 {
        self.pieces.get(index + 1).map_or(self.end, |next| next.start).max(self.pieces[index].start)
    }

    /// The contact over some pieces, the last of which is before `after`; cut into equal parts if one piece is long.
    fn one(&self, first: usize, after: usize, other: String) -> Vec<Contact> {
        let (start, end) = (self.pieces[first].start, self.until(after - 1));
        let parts = ((end - start) / LONGEST).ceil().clamp(1.0, 1e4) as u32;
        let force = self.mass * (self.acceleration(first, after) - GRAVITY).length();
        let part = |part: u32| {
            let time = |part: u32| start + (end - start) * f64::from(part) / f64::from(parts);
            let (from, to) = (time(part), time(part + 1));
            let (point, slip, roll) = self.means(first, after, from, to);
            let other = other.clone();
            let (body, normal) = (self.name.to_owned(), DVec3::ZERO);
            Contact { start: from, end: to, body, other, point, normal, slip, roll, force }
        };
        (0..parts)
            .map(part)
            .filter(|contact| contact.end > contact.start && contact.slip + contact.roll > SLOWEST)
            .collect()
    }

    /// Mean acceleration; for several pieces, that between the middles of the first and the last.
    fn acceleration(&self, first: usize, after: usize) -> DVec3 {
        let middle = |index: usize| 0.5 * (self.pieces[index].start + self.until(index));
        let (a, b) = (middle(first), middle(after - 1));
        if b <= a {
            return self.pieces[first].acceleration;
        }
        (self.pieces[after - 1].velocity(b) - self.pieces[first].velocity(a)) / (b - a)
    }

    /// Its first place of contact, and the mean speeds of slipping and of rolling between two times.
    fn means(&self, first: usize, after: usize, from: f64, to: f64) -> (DVec3, f64, f64) {
        let (mut point, mut slip, mut roll, mut whole) = (None, 0.0, 0.0, 0.0);
        for index in first..after {
            let piece = &self.pieces[index];
            let (begin, end) = (piece.start.max(from), self.until(index).min(to));
            if end <= begin {
                continue;
            }
            let middle = 0.5 * (begin + end);
            let turn = piece.orientation(middle);
            let arm = turn * self.shape.support(turn.inverse() * DVec3::NEG_Y);
            let spin = piece.turn.spin + turn * DVec3::Z * piece.turn.own;
            let level = |v: DVec3| v.with_y(0.0);
            let along = level(piece.velocity(middle));
            let sliding = level(piece.velocity(middle) + spin.cross(arm));
            slip += (end - begin) * sliding.length();
            roll += (end - begin) * (along - sliding).length();
            whole += end - begin;
            point.get_or_insert(piece.position(begin) + arm);
        }
        let whole = whole.max(f64::MIN_POSITIVE);
        (point.unwrap_or_default(), slip / whole, roll / whole)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::animation::Turn;

    /// A ball of 6 kg and radius 0.1 m: it rolls at 5 m/s, then slides at 2 m/s without turning, slowed down by a
    /// friction of 0.2, then flies.
    #[test]
    fn rolling_and_sliding_are_distinguished() {
        let ball = Shape::ball(0.1);
        let rolling = Turn { spin: DVec3::new(0.0, 0.0, -50.0), ..Turn::default() };
        let pieces = [
            Piece::ballistic(0.0, DVec3::Y * 0.1, DVec3::X * 5.0, DVec3::ZERO).turning(rolling),
            Piece::ballistic(0.1, DVec3::Y * 0.1, DVec3::X * 2.0, DVec3::X * -1.962),
            Piece::ballistic(0.14, DVec3::Y * 0.1, DVec3::X, GRAVITY),
        ];
        let toucher = Toucher { name: "ball", shape: &ball, mass: 6.0, pieces: &pieces, end: 1.0 };
        let touches = |piece: usize| ["lane", "gutter"].get(piece).map(|&name| name.to_owned());
        let (contacts, _) = toucher.contacts(f64::INFINITY, touches);
        assert_eq!(contacts.len(), 3, "{contacts:?}");
        let [a, b, c] = &contacts[..] else { panic!() };
        assert!(a.slip < 1e-12 && (a.roll - 5.0).abs() < 1e-12 && (a.force - 6.0 * 9.81).abs() < 1e-9);
        assert_eq!((a.start, a.end, b.end, a.other.as_str()), (0.0, 0.05, 0.1, "lane"));
        assert!(c.roll < 1e-12 && (c.slip - (2.0 - 0.02 * 1.962)).abs() < 1e-12, "{c:?}");
        assert!((c.force - 6.0 * (9.81_f64 * 9.81 + 1.962 * 1.962).sqrt()).abs() < 1e-9);
        assert_eq!((c.start, c.end, c.point.y), (0.1, 0.14, 0.0));
        // Until the second piece ends, nobody knows how long it slides.
        let begun = Toucher { pieces: &pieces[..2], end: 0.12, ..toucher };
        assert_eq!(begun.contacts(0.12, touches), (contacts[..2].to_vec(), 0.1));
    }
}

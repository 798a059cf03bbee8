//! What bears on what during a run, pair by pair, from the forces that the simulator tells.

use crate::animation::{Contact, Piece, Shape, Track, upright};
use crate::film::Figure;
use crate::touch::LONGEST;
use glam::DVec3;
use plaus_sim::is_interrupted;
use plaus_sim::mechanics::{ContactForce, Island, Mechanics, Other};
use std::collections::BTreeMap;

/// Change of a force at rest, over the force, that is none. Default 1e-5, ten times what static equilibrium may leave.
const SAME: f64 = 1e-5;

/// A pair that bears load while neither settles anew.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Span {
    /// Numbers of a body and of what it touches, the lower first.
    pair: [u32; 2],
    /// When it begins and ends, in s; infinite as long as it has not ended.
    start: f64,
    end: f64,
    /// Where the load acts at the start, in m: the mean of all points.
    point: DVec3,
    /// Direction of the normal forces on the first.
    normal: DVec3,
    /// Force on the first, in N.
    force: DVec3,
}

/// Listens to which bodies bear on each other.
#[derive(Debug)]
pub(crate) struct Loads<M: Mechanics> {
    work: M::Scratch,
    spans: Vec<Span>,
    /// For each body, those of its spans that have not ended, and some that have.
    open: Vec<Vec<u32>>,
    told: Vec<([u32; 2], ContactForce)>,
}

impl<M: Mechanics> Default for Loads<M> {
    fn default() -> Self {
        Self { work: M::Scratch::default(), spans: Vec::new(), open: Vec::new(), told: Vec::new() }
    }
}

impl<M: Mechanics> Loads<M> {
    /// Notes what an island carries that has just settled. `number` gives the number of what a body touches: bodies
    /// keep theirs, parts of the scenery have higher ones.
    pub(crate) fn settled(&mut self, mechanics: &M, island: &Island<'_, M>, number: impl Fn(Other) -> u32) {
        let Some(&first) = island.members.first() else { return };
        let time = mechanics.clock(&island.bodies[first as usize]);
        let Self { work, spans, open, told } = self;
        open.resize_with(island.bodies.len(), Vec::new);
        told.clear();
        mechanics.contact_forces(island, work, &mut |force| {
            told.push(([force.body as u32, number(force.other)], *force));
        });
        told.sort_by_key(|(pair, _)| *pair);
        let count = island.bodies.len() as u32;
        let concerned = told.iter().flat_map(|(pair, _)| *pair).filter(|&k| k < count);
        for body in island.members.iter().copied().chain(concerned) {
            for span in open[body as usize].drain(..) {
                let span = &mut spans[span as usize];
                span.end = span.end.min(time);
            }
        }
        for of_pair in told.chunk_by(|a, b| a.0 == b.0) {
            let pair = of_pair[0].0;
            for body in pair.into_iter().filter(|&k| k < count) {
                open[body as usize].push(spans.len() as u32);
            }
            spans.push(Span::of(pair, of_pair.iter().map(|(_, force)| force), time));
        }
    }

    /// All pairs that bore load, in the order in which they began to.
    pub(crate) fn spans(&self) -> &[Span] {
        &self.spans
    }

    /// The same, when nobody listens any more.
    pub(crate) fn into_spans(self) -> Vec<Span> {
        self.spans
    }
}

impl Span {
    /// What the points of a pair carry together from a time on.
    fn of<'f>(pair: [u32; 2], points: impl Iterator<Item = &'f ContactForce>, start: f64) -> Self {
        let (mut whole, mut place, mut normal, mut force) = (0.0, DVec3::ZERO, DVec3::ZERO, DVec3::ZERO);
        for point in points {
            let press = point.force.dot(point.normal);
            (whole, place) = (whole + press, place + point.point * press);
            (normal, force) = (normal + point.normal * press, force + point.force);
        }
        let point = upright(place / whole);
        let [normal, force] = [normal.normalize_or_zero(), force].map(upright);
        Self { pair, start, end: f64::INFINITY, point, normal, force }
    }
}

/// The contacts of bodies that bear on each other or on the scenery: those of `spans` that begin before `known`, up to
/// there, or up to the end of the motion. `name` gives the names of things by their numbers; bodies come first.
pub(crate) fn contacts(
    spans: &[Span],
    figures: &[Figure],
    name: impl Fn(u32) -> String,
    [end, known]: [f64; 2],
) -> Vec<Contact> {
    let last = end.min(known);
    let mut pairs: BTreeMap<[u32; 2], Vec<Span>> = BTreeMap::new();
    // A span of no length is over before anything has happened, unless the motion ends with it.
    let begun = spans.iter().filter(|span| span.start < known && (span.end > span.start));
    for span in begun.filter(|span| span.start <= last) {
        pairs.entry(span.pair).or_default().push(Span { end: span.end.min(last), ..*span });
    }
    let mut contacts = Vec::new();
    for (pair, spans) in &pairs {
        let track = |number: u32| figures.get(number as usize).map(|figure| &figure.track);
        let Some(body) = track(pair[0]) else { continue };
        let both = Pair { names: pair.map(&name), body, other: track(pair[1]) };
        let mut rest = spans.as_slice();
        while let Some(first) = rest.first().filter(|_| !is_interrupted()) {
            let is_still = both.is_still(first);
            let goes_on = |a: &Span, b: &Span| {
                let is_same = (a.force - b.force).length() <= SAME * a.force.length();
                let fits = if is_still { is_same } else { b.end - first.start <= LONGEST };
                a.end == b.start && fits && both.is_still(b) == is_still
            };
            let count = 1 + rest.windows(2).take_while(|two| goes_on(&two[0], &two[1])).count();
            let (now, later) = rest.split_at(count);
            both.tell(now, is_still, &mut contacts);
            rest = later;
        }
    }
    contacts
}

/// Two things that bear on each other.
struct Pair<'a> {
    names: [String; 2],
    body: &'a Track,
    /// None if it is scenery.
    other: Option<&'a Track>,
}

/// The piece of a track that is valid at a time.
fn piece_at(track: &Track, time: f64) -> Option<&Piece> {
    let after = track.pieces.partition_point(|piece| piece.start <= time);
    track.pieces.get(after.saturating_sub(1))
}

/// Velocity and angular velocity of a body, with the place and the orientation that it has then.
fn motion_at(track: &Track, time: f64) -> [DVec3; 3] {
    let Some(piece) = piece_at(track, time) else { return [DVec3::ZERO; 3] };
    let spin = piece.turn.spin + piece.orientation(time) * DVec3::Z * piece.turn.own;
    [piece.position(time), piece.velocity(time), spin]
}

impl Pair<'_> {
    /// Whether both are at rest during a span.
    fn is_still(&self, span: &Span) -> bool {
        let rests = |track: &Track| piece_at(track, span.start).is_none_or(Piece::rests);
        rests(self.body) && self.other.is_none_or(rests)
    }

    /// Adds the contact over some spans that follow each other; if the bodies move, cut into equal parts where one is
    /// long.
    fn tell(&self, spans: &[Span], is_still: bool, contacts: &mut Vec<Contact>) {
        let (Some(first), Some(last)) = (spans.first(), spans.last()) else { return };
        let (start, end) = (first.start, last.end);
        let parts = if is_still { 1 } else { ((end - start) / LONGEST).ceil().clamp(1.0, 1e4) as u32 };
        let time = |part: u32| start + (end - start) * f64::from(part) / f64::from(parts);
        for part in 0..parts {
            let [body, other] = self.names.clone();
            let (start, end) = (time(part), time(part + 1));
            let mut told = Contact {
                start,
                end,
                body,
                other,
                point: first.point,
                normal: first.normal,
                slip: 0.0,
                roll: 0.0,
                force: 0.0,
            };
            let (mut whole, mut force) = (0.0, DVec3::ZERO);
            for span in spans {
                let [from, to] = [span.start.max(start), span.end.min(end)];
                if to <= from && end > start {
                    continue;
                }
                // All of a contact that has no length yet.
                let weight = if end > start { to - from } else { 1.0 };
                if whole == 0.0 {
                    (told.point, told.normal) = (self.point_at(span, from), span.normal);
                }
                if !is_still {
                    let [slip, roll] = self.speeds(span, 0.5 * (from + to));
                    (told.slip, told.roll) = (told.slip + slip * weight, told.roll + roll * weight);
                }
                (whole, force) = (whole + weight, force + span.force * weight);
            }
            let whole = whole.max(f64::MIN_POSITIVE);
            (told.slip, told.roll, told.force) = (told.slip / whole, told.roll / whole, (force / whole).length());
            contacts.push(told);
        }
    }

    /// From the body's origin to the point of contact: where it begins it is fixed in the body, but for a ball.
    fn arm(&self, span: &Span, time: f64) -> DVec3 {
        let Some(piece) = piece_at(self.body, span.start) else { return DVec3::ZERO };
        let arm = span.point - piece.position(span.start);
        match (&*self.body.shape, piece_at(self.body, time)) {
            (Shape::Sphere { .. }, _) | (_, None) => arm,
            (_, Some(now)) => now.orientation(time) * (piece.orientation(span.start).inverse() * arm),
        }
    }

    fn point_at(&self, span: &Span, time: f64) -> DVec3 {
        if time == span.start { span.point } else { motion_at(self.body, time)[0] + self.arm(span, time) }
    }

    /// Speeds at a time: of the body's surface over the other's, and of the point of contact along the surface without
    /// slipping.
    fn speeds(&self, span: &Span, time: f64) -> [f64; 2] {
        let arm = self.arm(span, time);
        let [x, v, spin] = motion_at(self.body, time);
        let mut turning = spin.cross(arm);
        let mut centres = v;
        if let Some(other) = self.other {
            let [y, u, whirl] = motion_at(other, time);
            turning -= whirl.cross(x + arm - y);
            centres -= u;
        }
        let along = |v: DVec3| v - span.normal * v.dot(span.normal);
        [along(centres + turning).length(), along(turning).length()]
    }
}

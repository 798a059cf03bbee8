//! From recorded motions to that of an animation: what all scenes with a simulator share. A scene says how its bodies
//! look, how they turn, and what the things are called that they touch.

use crate::animation::{Contact, Impact, Motion, Piece, Track, Turn, upright};
use crate::require::{Begun, Stop};
use crate::touch::Toucher;
use glam::{DQuat, DVec3};
use plaus_dist::LogPotential;
use plaus_sim::rigid::{Phase, RigidBodyState};
use plaus_sim::trace::Trace;
use plaus_sim::{is_interrupted, mechanics};

/// Pieces of a body's motion, in order of their starts.
#[derive(Debug, Default)]
pub(crate) struct Pieces(pub(crate) Vec<Piece>);

impl Pieces {
    /// Adds how a turning body moves from the time `start` on, from `place` in the simulator's axes. `orientation` is
    /// that of its shape, in the animation's axes; at the rate `own`, in rad/s, it turns about its own third axis.
    pub(crate) fn add(&mut self, body: &RigidBodyState, (start, place): (f64, DVec3), orientation: DQuat, own: f64) {
        let moves = !matches!(body.phase, Phase::Rest | Phase::Waiting | Phase::Gone);
        let [v, a, spin] = if moves { [body.path.v, body.path.a, body.spin] } else { [DVec3::ZERO; 3] };
        let spin = if own == 0.0 { spin } else { spin - body.turn * DVec3::Z * own };
        let turn = Turn { orientation: orientation.normalize(), spin: upright(spin), own };
        self.push(Piece::ballistic(start, upright(place), upright(v), upright(a)).turning(turn));
    }

    /// Adds a piece. Of pieces that begin at the same time only the last takes effect.
    pub(crate) fn push(&mut self, piece: Piece) {
        if self.0.last().is_some_and(|last| last.start >= piece.start) {
            self.0.pop();
        }
        self.0.push(piece);
    }
}

/// Those of a body's motions that begin before `known`, and when the last of them begins; if the body does not turn
/// then, `known`.
pub(crate) fn begun(motions: &[RigidBodyState], known: f64) -> (&[RigidBodyState], f64) {
    let motions = &motions[..motions.partition_point(|motion| motion.path.t < known).max(1).min(motions.len())];
    let turns = motions.last().filter(|last| last.phase != Phase::Rest && last.spin != DVec3::ZERO);
    (motions, turns.map_or(known, |last| last.path.t.min(known)))
}

/// A body's motions with their numbers. An interrupt ends them after the first: the animation is dropped then.
pub(crate) fn while_wanted<B>(motions: &[B]) -> impl Iterator<Item = (usize, &B)> {
    motions.iter().enumerate().take_while(|(k, _)| *k == 0 || !is_interrupted())
}

/// A body of an animation.
#[derive(Debug)]
pub(crate) struct Figure {
    pub(crate) track: Track,
    /// In kg.
    pub(crate) mass: f64,
    /// When its last contact ends at the latest, in s.
    pub(crate) end: f64,
}

/// An impact of the simulator with the names of those who met, `shift` farther on in place, in m.
pub(crate) fn impact(hit: &mechanics::Impact, names: [String; 2], time: f64, shift: DVec3) -> Impact {
    let [body, other] = names;
    Impact::new(time, body, other, upright(hit.point + shift), upright(hit.normal))
        .with_strength(hit.approach, hit.impulse.length())
}

/// The motion of some bodies, as far as it is known. `touches` gives what a body, by its place among the others,
/// touches during one of its pieces.
pub(crate) fn film(
    figures: Vec<Figure>,
    impacts: Vec<Impact>,
    (duration, known, turns): (f64, f64, f64),
    touches: impl Fn(usize, usize, &[Figure], &[Impact]) -> Option<String>,
) -> Begun {
    let (mut contacts, mut final_before) = (Vec::new(), known);
    for (index, Figure { track, mass, end }) in figures.iter().enumerate() {
        let Track { name, shape, pieces, .. } = track;
        let toucher = Toucher { name, shape, mass: *mass, pieces, end: end.min(known) };
        let (found, until) = toucher.contacts(known, |piece| touches(index, piece, &figures, &impacts));
        contacts.extend(found);
        final_before = final_before.min(until);
    }
    with_contacts(figures, impacts, (duration, known, turns), contacts, final_before.min(turns))
}

/// The same with contacts that are known before `final_before`.
pub(crate) fn with_contacts(
    figures: Vec<Figure>,
    impacts: Vec<Impact>,
    (duration, known, turns): (f64, f64, f64),
    mut contacts: Vec<Contact>,
    final_before: f64,
) -> Begun {
    contacts.sort_by(|a: &Contact, b| a.start.total_cmp(&b.start));
    let tracks = figures.into_iter().map(|figure| figure.track).collect();
    let motion = Motion::new(duration.min(known), tracks, impacts).with_contacts(contacts);
    Begun { motion, known, turns, contacts: final_before }
}

/// What a body has met before one of its pieces begins, the last first.
pub(crate) fn met_last<'a>(track: &'a Track, piece: usize, impacts: &'a [Impact]) -> impl Iterator<Item = &'a String> {
    let hits = impacts.iter().rev().filter(move |hit| hit.time <= track.pieces[piece].start);
    hits.filter(|hit| hit.involves(&track.name)).map(|hit| if hit.body == track.name { &hit.other } else { &hit.body })
}

/// Bytes after which a recording is full, with the animation that is made of it: its draw then counts as failed.
/// Default
/// 80 MB, so that a draw takes less than 100 MB beside its world.
const MOST_BYTES: usize = 80_000_000;

/// Bytes of an impact's two names.
const NAMES: usize = 64;

/// Records a run, and says when it can end because its motion can no longer be accepted.
#[derive(Debug)]
pub(crate) struct Reel<B = RigidBodyState> {
    pub(crate) trace: Trace<B>,
    stop: Option<Stop>,
    /// Bytes that motions and impacts take, here and in an animation.
    bytes: usize,
    /// True once the run was stopped early.
    pub(crate) is_hopeless: bool,
}

impl<B: Clone> Reel<B> {
    pub(crate) fn new(stop: Option<Stop>) -> Self {
        Self { trace: Trace::default(), stop, bytes: 0, is_hopeless: false }
    }

    pub(crate) fn impact(&mut self, impact: &mechanics::Impact) {
        self.bytes += make_room(&mut self.trace.impacts) + size_of::<Impact>() + NAMES;
        self.trace.impacts.push(*impact);
    }

    /// Adds the next motion of a body.
    pub(crate) fn motion(&mut self, index: usize, body: B) {
        if self.trace.motions.len() <= index {
            self.trace.motions.resize_with(index + 1, Vec::new);
        }
        self.bytes += make_room(&mut self.trace.motions[index]) + size_of::<Piece>();
        self.trace.motions[index].push(body);
    }

    /// Reckons with so many more pieces of the animation than there are motions.
    pub(crate) fn reckon(&mut self, pieces: usize) {
        self.bytes += pieces * size_of::<Piece>();
    }

    /// Whether there is no room for more.
    pub(crate) fn is_full(&self) -> bool {
        self.bytes >= MOST_BYTES
    }

    /// The body with the most motions, the first of several.
    pub(crate) fn busiest(&self) -> usize {
        let motions = self.trace.motions.iter().map(Vec::len).enumerate();
        motions.fold((0, 0), |most, (index, count)| if count > most.1 { (index, count) } else { most }).0
    }

    /// Whether to go on after an event at this time, in s of the animation. `begun` makes what is known of the motion,
    /// if that makes sense yet; the scene's own log constraint is `own` at most.
    pub(crate) fn goes_on(
        &mut self,
        time: f64,
        own: LogPotential,
        begun: impl FnOnce(&Trace<B>) -> Option<Begun>,
    ) -> bool {
        let Some(stop) = self.stop.as_mut() else { return true };
        if stop.is_due(time) {
            self.is_hopeless = begun(&self.trace).is_some_and(|begun| stop.is_hopeless(own, &begun));
        }
        !self.is_hopeless
    }
}

/// Makes room for one more, an eighth of what there is at a time; gives the bytes that are newly set aside.
fn make_room<B>(list: &mut Vec<B>) -> usize {
    let before = list.capacity();
    if list.len() == before {
        list.reserve_exact((before / 8).max(16));
    }
    (list.capacity() - before) * size_of::<B>()
}

#[cfg(test)]
mod tests {
    use super::*;
    use plaus_sim::interruptible;
    use std::sync::Arc;
    use std::sync::atomic::{AtomicBool, Ordering};

    #[test]
    fn a_reel_is_full_after_so_many_bytes() {
        let mut reel = Reel::<[u64; 100]>::new(None);
        let mut made = 0;
        while !reel.is_full() {
            reel.motion(made % 30, [0; 100]);
            made += 1;
        }
        // An eighth of what is set aside may be empty, and the last step may go as much too far.
        let each = 800 + size_of::<Piece>();
        assert!((8 * MOST_BYTES / 9..9 * MOST_BYTES / 8).contains(&(made * each)), "{made}");
        let held: usize = reel.trace.motions.iter().map(|motions| motions.capacity() * 800).sum();
        assert_eq!(held + made * size_of::<Piece>(), reel.bytes);
        assert_eq!(reel.busiest(), 0, "the first of those with the most");
    }

    /// Making the animation of a long recording takes seconds, so it asks whether it is still wanted.
    #[test]
    fn an_interrupt_ends_what_is_made_of_a_recording() {
        let motions = [(); 1000];
        let flag = Arc::new(AtomicBool::new(false));
        let count = || while_wanted(&motions).count();
        assert_eq!(interruptible(&flag, count), Some(1000));
        let mut seen = 0;
        let cut = interruptible(&flag, || {
            seen = while_wanted(&motions).inspect(|(k, ())| flag.store(*k == 9, Ordering::Relaxed)).count();
        });
        assert_eq!((cut, seen), (None, 10));
        assert_eq!(count(), 1000, "outside of a job, nothing is cut");
    }
}

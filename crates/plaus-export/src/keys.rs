//! The times at which a body has keys, and its pose there.

use crate::clip::Cut;
use glam::{DQuat, DVec3};
use plaus_animation::{Animation, Piece, Track};

/// Largest angle between two keys of an orientation, in rad: interpolation takes the short way, and is exact for
/// constant angular velocity.
const LARGEST_TURN: f64 = 1.0;
/// The same for bodies that turn about two axes at once, for which interpolation is an approximation.
const LARGEST_TOP_TURN: f64 = 0.1;

/// A moment of a body's motion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Key {
    /// Seconds of the animation.
    pub time: f64,
    /// Whether the body takes part in an impact at this very time.
    pub impact: bool,
    /// Position.
    pub position: DVec3,
    /// Velocity just before; the same as after for the first key.
    pub arriving: DVec3,
    /// Velocity just after.
    pub leaving: DVec3,
    /// Orientation.
    pub orientation: DQuat,
}

/// Keys of a body: at every frame, at the start of every piece of its motion, at every impact that it takes part in,
/// and at the end of the cut.
#[must_use]
pub fn of_track(animation: &Animation, track: &Track, cut: &Cut) -> Vec<Key> {
    let hits: Vec<f64> =
        animation.motion.impacts.iter().filter(|hit| hit.involves(&track.name)).map(|hit| hit.time).collect();
    let (from, to) = (cut.from(), cut.to());
    let frames = ((to - from) * cut.fps()).floor() as u64;
    let mut times: Vec<f64> = (0..=frames).map(|frame| from + frame as f64 / cut.fps()).collect();
    times.extend(track.pieces.iter().map(|piece| piece.start));
    times.extend(&hits);
    times.push(to);
    times.retain(|&time| cut.holds(time));
    times.sort_by(f64::total_cmp);
    times.dedup();
    times.into_iter().map(|time| key(track, time, hits.contains(&time))).collect()
}

fn key(track: &Track, time: f64, impact: bool) -> Key {
    let still = Piece::resting(0.0, DVec3::ZERO);
    let piece = track.piece(time).unwrap_or(&still);
    let before = track.pieces.partition_point(|piece| piece.start < time);
    let before = before.checked_sub(1).and_then(|index| track.pieces.get(index)).unwrap_or(piece);
    let leaving = if time < piece.start { DVec3::ZERO } else { piece.velocity(time) };
    let arriving = if time <= before.start { leaving } else { before.velocity(time) };
    Key { time, impact, position: piece.position(time), arriving, leaving, orientation: piece.orientation(time) }
}

/// Times and orientations between which the shortest turn is the right one: at the keys, and between them if the body
/// turns fast.
#[must_use]
pub fn orientations(track: &Track, keys: &[Key]) -> Vec<(f64, DQuat)> {
    let mut turns = Vec::with_capacity(keys.len());
    for (index, key) in keys.iter().enumerate() {
        turns.push((key.time, key.orientation));
        let (Some(next), Some(piece)) = (keys.get(index + 1), track.piece(key.time)) else { continue };
        let (spin, own) = (piece.turn.spin.length(), piece.turn.own.abs());
        let largest = if spin > 0.0 && own > 0.0 { LARGEST_TOP_TURN } else { LARGEST_TURN };
        let parts = ((spin + own) * (next.time - key.time) / largest).ceil().max(1.0) as u64;
        turns.extend((1..parts).map(|part| {
            let time = key.time + (next.time - key.time) * part as f64 / parts as f64;
            (time, piece.orientation(time))
        }));
    }
    // q and −q are the same orientation. Of the two, the one near the previous key is taken, so that interpolation of
    // components goes the short way too.
    for index in 1..turns.len() {
        if turns[index].1.dot(turns[index - 1].1) < 0.0 {
            turns[index].1 = -turns[index].1;
        }
    }
    turns
}

#[cfg(test)]
mod tests {
    use super::*;
    use plaus_animation::{Impact, Look, Shape, Turn};

    fn two_bodies() -> Animation {
        let zero = Piece::resting(0.0, DVec3::ZERO);
        let moved = Piece::ballistic(0.3, DVec3::ZERO, DVec3::X, DVec3::ZERO);
        let track = |name: &str, pieces| Track::new(name, Shape::ball(0.1), Look::nth(0), pieces);
        let hit = |time| Impact::new(time, "a", "table", DVec3::ZERO, DVec3::Y);
        Animation::new(1.0, vec![track("a", vec![zero, moved]), track("b", vec![zero])], vec![hit(0.3), hit(0.6)])
    }

    #[test]
    fn every_impact_has_a_key_at_its_very_time() {
        let animation = two_bodies();
        let cut = Cut::new(4.0, None, &animation).unwrap();
        let times = |track: &Track| -> Vec<(f64, bool)> {
            of_track(&animation, track, &cut).iter().map(|key| (key.time, key.impact)).collect()
        };
        assert_eq!(times(&animation.motion.tracks[1]), [0.0, 0.25, 0.5, 0.75, 1.0].map(|t| (t, false)));
        let expected =
            [(0.0, false), (0.25, false), (0.3, true), (0.5, false), (0.6, true), (0.75, false), (1.0, false)];
        assert_eq!(times(&animation.motion.tracks[0]), expected);
        let key = of_track(&animation, &animation.motion.tracks[0], &cut)[2];
        assert_eq!((key.arriving, key.leaving), (DVec3::ZERO, DVec3::X));
    }

    #[test]
    fn a_cut_begins_and_ends_with_a_key() {
        let animation = two_bodies();
        let cut = Cut::new(10.0, Some((0.25, 0.5)), &animation).unwrap();
        let times: Vec<f64> =
            of_track(&animation, &animation.motion.tracks[0], &cut).iter().map(|key| key.time).collect();
        assert_eq!(times, [0.25, 0.3, 0.35, 0.45, 0.5]);
        for wrong in [(0.5, 0.5), (-0.1, 0.5), (2.0, 3.0), (f64::NAN, 1.0)] {
            assert!(Cut::new(10.0, Some(wrong), &animation).is_err(), "{wrong:?}");
        }
        for fps in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e9] {
            assert!(Cut::new(fps, None, &animation).is_err(), "{fps}");
        }
    }

    #[test]
    fn fast_turns_have_keys_between_frames() {
        let turn = Turn { orientation: DQuat::IDENTITY, spin: DVec3::Y * 300.0, own: 0.0 };
        let piece = Piece::resting(0.0, DVec3::ZERO).turning(turn);
        let track = Track::new("a", Shape::ball(0.1), Look::nth(0), vec![piece]);
        let animation = Animation::new(0.5, vec![track], vec![]);
        let keys = of_track(&animation, &animation.motion.tracks[0], &Cut::new(60.0, None, &animation).unwrap());
        let turns = orientations(&animation.motion.tracks[0], &keys);
        for pair in turns.windows(2) {
            assert!(pair[0].1.dot(pair[1].1) > 0.8, "the half angle is below 0.6");
            let middle = pair[0].1.slerp(pair[1].1, 0.5);
            let exact = animation.motion.tracks[0].orientation(0.5 * (pair[0].0 + pair[1].0));
            assert!(middle.dot(exact).abs() > 1.0 - 1e-12);
        }
    }
}

//! The fewest keys with which straight lines stay near a motion.

use crate::keys::Key;
use glam::{DQuat, DVec3};
use plaus_animation::{Piece, Track};

/// Largest distance of a body's centre from a straight line between two keys, in m. Default 2e-4, so that, including
/// rotation and single precision, every point of a body stays within 0.5 mm.
const OFF: f64 = 2e-4;
/// The same as a share of the body's reach, because small things are looked at from close by. Default 0.01.
const OFF_SHARE: f64 = 0.01;
/// Largest angle of an orientation from the interpolated one, in rad, whether a program turns evenly or interpolates
/// the four components linearly. Default 5e-4: 0.03°.
const TURNED: f64 = 5e-4;
/// The share of what may be off that is allowed at the times that are looked at: keys that are left out, and half-way
/// between neighbours. Between these times a motion may be off by a little more.
const LOOKED_AT: f64 = 0.85;
/// Largest turn between two keys, in rad: up to this angle, linear interpolation of the four components is off by at
/// most [`TURNED`].
const LARGEST_TURN: f64 = 0.5;
/// Smallest time between two keys of a file that Blender may read, in s. Blender merges keys that are less than a
/// hundredth of a frame apart into one, with the time of the first and the value of the last. Its scenes have 24 frames
/// per second.
pub const APART: f64 = 0.0102 / 24.0;
/// Times no farther apart than this are equal.
const EQUAL: f64 = 1e-9;
/// Most keys between two neighbouring candidates: a safeguard against meaningless numbers.
const MOST_PARTS: f64 = 1e4;

/// How far a straight line may be off for a body with this reach, in m.
#[must_use]
pub fn tolerance(reach: f64) -> f64 {
    OFF.min(OFF_SHARE * reach)
}

/// A key of an orientation.
pub type TurnKey = (f64, DQuat);
/// A key of a position.
pub type PlaceKey = (f64, DVec3);

/// Positions between which straight lines stay within [`tolerance`] of the motion: at both ends, at every impact, and
/// at as few other times as necessary, at frames if possible. Of keys that are less than `apart` s from each other, one
/// is kept.
#[must_use]
pub fn places(track: &Track, keys: &[Key], apart: f64) -> Vec<PlaceKey> {
    let most = LOOKED_AT * tolerance(track.shape.reach());
    // A parabola leaves its chord by an eighth of its acceleration times the square of the time. Half of the tolerance
    // is reserved for keys that are left out.
    let parts = |piece: &Piece| (piece.acceleration.length() / (8.0 * 0.5 * most)).sqrt();
    let rough = candidates(track, keys, apart, parts, |time| track.position(time));
    let middles = middles(&rough, |time| track.position(time));
    let line = |a: &PlaceKey, b: &PlaceKey, time: f64| a.1.lerp(b.1, (time - a.0) / (b.0 - a.0));
    let fits = |from: usize, to: usize| {
        let (a, b) = (&rough[from].0, &rough[to].0);
        let near = |&(time, place): &PlaceKey| line(a, b, time).distance_squared(place) <= most * most;
        rough[from + 1..to].iter().all(|(key, _)| near(key)) && middles[from..to].iter().all(near)
    };
    kept(rough.len(), |index| rough[index].1, fits).into_iter().map(|index| rough[index].0).collect()
}

/// Orientations between which both even turning and linear interpolation of the four components stay within 0.03° of
/// the motion. Neighbours have the signs for which the short way is the right one. Of keys that are less than `apart` s
/// from each other, one is kept.
#[must_use]
pub fn turns(track: &Track, keys: &[Key], apart: f64) -> Vec<TurnKey> {
    let parts = |piece: &Piece| {
        let (spin, own) = (piece.turn.spin.length(), piece.turn.own.abs());
        // If a body turns about two axes at once, the angular velocity itself turns with `spin`.
        let both = if spin > 0.0 && own > 0.0 { (spin * own / (8.0 * 0.5 * TURNED)).sqrt() } else { 0.0 };
        ((spin + own) / LARGEST_TURN).max(both)
    };
    let mut rough = candidates(track, keys, apart, parts, |time| track.orientation(time));
    for index in 1..rough.len() {
        if rough[index].0.1.dot(rough[index - 1].0.1) < 0.0 {
            rough[index].0.1 = -rough[index].0.1;
        }
    }
    let middles = middles(&rough, |time| track.orientation(time));
    // The dot product of two orientations that are an angle of 2 x apart is cos x.
    let turned = LOOKED_AT * TURNED;
    let (alike, near_enough) = (1.0 - 0.125 * turned * turned, 1.0 - 0.125 * LARGEST_TURN * LARGEST_TURN);
    let fits = |from: usize, to: usize| {
        let (a, b) = (&rough[from].0, &rough[to].0);
        let near = |&(time, turn): &TurnKey| {
            let share = (time - a.0) / (b.0 - a.0);
            (a.1 * (1.0 - share) + b.1 * share).normalize().dot(turn).abs() >= alike
        };
        a.1.dot(b.1) >= near_enough
            && rough[from + 1..to].iter().all(|(key, _)| near(key))
            && middles[from..to].iter().all(near)
    };
    kept(rough.len(), |index| rough[index].1, fits).into_iter().map(|index| rough[index].0).collect()
}

/// A time with its value, and whether a key must be there.
type Candidate<T> = ((f64, T), bool);

/// Where keys may be: at the keys that are far enough apart, near the other keys between them, and densely enough for
/// the `parts` straight lines per second that a piece of the motion requires.
fn candidates<T>(
    track: &Track,
    keys: &[Key],
    apart: f64,
    parts: impl Fn(&Piece) -> f64,
    at: impl Fn(f64) -> T,
) -> Vec<Candidate<T>> {
    let begins = |time: f64| track.pieces.binary_search_by(|piece| piece.start.total_cmp(&time)).is_ok();
    let keys = spaced(keys, apart, |key| if key.impact { 2 } else { u8::from(begins(key.time)) });
    let mut all = Vec::with_capacity(keys.len());
    for (index, key) in keys.iter().enumerate() {
        all.push(((key.time, at(key.time)), key.impact));
        let Some(next) = keys.get(index + 1) else { continue };
        // Pieces of the motion that begin in between: if keys are too close to each other, some pieces have none.
        let first = track.pieces.partition_point(|piece| piece.start <= key.time + EQUAL);
        let end = track.pieces.partition_point(|piece| piece.start < next.time - EQUAL).max(first);
        let on_the_way = &track.pieces[first..end];
        // As near as possible to the first and to the last of these pieces.
        let before = on_the_way.first().map(|piece| piece.start.min(next.time - apart));
        let before = before.filter(|time| time - key.time >= apart);
        let after = on_the_way.last().map(|piece| piece.start.max(before.unwrap_or(key.time) + apart));
        let after = after.filter(|time| next.time - time >= apart);
        let most = track.pieces[first.saturating_sub(1)..end].iter().map(&parts).fold(0.0, f64::max);
        let mut from = key.time;
        for to in before.into_iter().chain(after).chain([next.time]) {
            let count = ((to - from) * most).ceil().clamp(1.0, MOST_PARTS);
            let times = (1..count as u64).map(|part| from + (to - from) * part as f64 / count);
            all.extend(times.chain((to < next.time).then_some(to)).map(|time| ((time, at(time)), false)));
            from = to;
        }
    }
    all
}

/// Keys that are at least `apart` s after the previous one. Keys of higher `rank` are preferred, and among equals the
/// first; both ends are kept.
fn spaced(keys: &[Key], apart: f64, rank: impl Fn(&Key) -> u8) -> Vec<Key> {
    let mut left: Vec<Key> = Vec::with_capacity(keys.len());
    for (index, key) in keys.iter().enumerate() {
        let is_end = index + 1 == keys.len();
        while let Some(last) = left.last().filter(|last| key.time - last.time < apart) {
            let goes = left.len() > 1 && (is_end || rank(key) > rank(last));
            if !goes {
                break;
            }
            left.pop();
        }
        if is_end || left.last().is_none_or(|last| key.time - last.time >= apart) {
            left.push(*key);
        }
    }
    left
}

/// The values half-way between neighbours.
fn middles<T>(rough: &[Candidate<T>], at: impl Fn(f64) -> T) -> Vec<(f64, T)> {
    let middle = |pair: &[Candidate<T>]| {
        let time = 0.5 * (pair[0].0.0 + pair[1].0.0);
        (time, at(time))
    };
    rough.windows(2).map(middle).collect()
}

/// Which of `count` keys to keep: both ends, those that must be kept, and after each kept key the farthest one for
/// which `fits` is true. If nothing fits, the next key is kept.
fn kept(count: usize, must: impl Fn(usize) -> bool, fits: impl Fn(usize, usize) -> bool) -> Vec<usize> {
    let Some(last) = count.checked_sub(1) else { return Vec::new() };
    let mut kept = vec![0];
    let mut at = 0;
    while at < last {
        let limit = (at + 1..last).find(|&index| must(index)).unwrap_or(last);
        // Doubles the distance as long as it fits, then searches between the last that fitted and the first that did
        // not.
        let (mut good, mut bad) = (at + 1, limit + 1);
        while good < limit && bad > limit {
            let next = (at + 2 * (good - at)).min(limit);
            if fits(at, next) { good = next } else { bad = next }
        }
        while bad - good > 1 {
            let middle = good + (bad - good) / 2;
            if fits(at, middle) { good = middle } else { bad = middle }
        }
        kept.push(good);
        at = good;
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn of_keys_close_to_each_other_the_impact_stays() {
        let key = |time: f64, impact| Key {
            time,
            impact,
            position: DVec3::ZERO,
            arriving: DVec3::ZERO,
            leaving: DVec3::ZERO,
            orientation: DQuat::IDENTITY,
        };
        let times = |keys: &[(f64, bool)], apart| -> Vec<f64> {
            let keys: Vec<Key> = keys.iter().map(|&(time, impact)| key(time, impact)).collect();
            spaced(&keys, apart, |key| u8::from(key.impact)).iter().map(|key| key.time).collect()
        };
        let all = [
            (0.0, false),
            (0.04, true),
            (0.2, false),
            (0.25, true),
            (0.3, true),
            (0.5, false),
            (0.97, true),
            (1.0, false),
        ];
        assert_eq!(times(&all, 0.0).len(), 8);
        assert_eq!(times(&all, 0.1), [0.0, 0.25, 0.5, 1.0]);
        assert_eq!(times(&[(0.0, false), (0.01, false)], 0.1), [0.0, 0.01], "both ends stay");
    }

    #[test]
    fn kept_keys_are_as_far_apart_as_fits() {
        let fits = |from: usize, to: usize| to - from <= 5;
        assert_eq!(kept(12, |index| index == 3, fits), [0, 3, 8, 11]);
        assert_eq!(kept(4, |_| false, |_, _| false), [0, 1, 2, 3]);
        assert_eq!(kept(1, |_| false, fits), [0]);
        assert!(kept(0, |_| false, fits).is_empty());
    }
}

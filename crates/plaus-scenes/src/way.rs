//! The paths of bodies that were simulated separately: paths that come near each other show which bodies have to be
//! simulated together.

use plaus_sim::motion::Parabola;
use plaus_sim::scenery::Aabb;

/// The path of one body's centre.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Way {
    pub(crate) pieces: Vec<Piece>,
    /// Around the centre at all times.
    around: Option<Aabb>,
}

/// A parabola of a path; it ends where the next begins.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Piece {
    pub(crate) path: Parabola,
    pub(crate) until: f64,
    /// Around the centre.
    pub(crate) around: Aabb,
}

/// Adds a motion to those of a body; a motion that ended when it began is left out.
#[inline]
pub(crate) fn follow(paths: &mut Vec<Parabola>, path: Parabola) {
    if paths.last().is_some_and(|last| last.t >= path.t) {
        paths.pop();
    }
    paths.push(path);
}

impl Way {
    /// A path of motions in succession; the last one lasts until `end`.
    pub(crate) fn new(paths: &[Parabola], end: f64) -> Self {
        let pieces: Vec<Piece> = paths
            .iter()
            .enumerate()
            .map(|(k, path)| {
                let until = paths.get(k + 1).map_or(end.max(path.t), |next| next.t);
                Piece { path: *path, until, around: path.bounds(0.0, until - path.t) }
            })
            .collect();
        let around = pieces.iter().map(|piece| piece.around).reduce(Aabb::union);
        Self { pieces, around }
    }

    /// A time before which the two centres are not nearer than `reach`; `None` if they never are. Answers with a time
    /// if in doubt: then the bodies are simulated together, which is always correct.
    pub(crate) fn meets(&self, other: &Self, reach: f64) -> Option<f64> {
        let (a, b) = (self.around.as_ref()?, other.around.as_ref()?);
        if !a.grown(reach).meets(b) {
            return None;
        }
        let (mut i, mut j) = (0, 0);
        while let (Some(a), Some(b)) = (self.pieces.get(i), other.pieces.get(j)) {
            let (from, until) = (a.path.t.max(b.path.t), a.until.min(b.until));
            if from < until && a.around.grown(reach).meets(&b.around) {
                let near = come_near(a, b, from, until, reach);
                if near.is_some() {
                    return near;
                }
            }
            if a.until <= b.until {
                i += 1;
            } else {
                j += 1;
            }
        }
        None
    }
}

/// Centres that could be near each other for fewer seconds than this count as near. Default 1e-7; a larger value merges
/// more groups than needed.
const SHORTEST: f64 = 1e-7;

/// A time before which two centres are not nearer than `reach`, if they may come nearer between two times. They cannot
/// if their distance in the middle, minus what they can cover until the ends, is more.
fn come_near(a: &Piece, b: &Piece, from: f64, until: f64, reach: f64) -> Option<f64> {
    let velocity = |t: f64| a.path.velocity_after(t - a.path.t) - b.path.velocity_after(t - b.path.t);
    // A linearly changing velocity is largest at an end.
    let fastest = velocity(from).length_squared().max(velocity(until).length_squared()).sqrt();
    let (middle, half) = (0.5 * (from + until), 0.5 * (until - from));
    let distance = (a.path.at(middle) - b.path.at(middle)).length();
    if distance - fastest * half > reach {
        return None;
    }
    if half < SHORTEST {
        return Some(from);
    }
    let before = || come_near(a, b, from, middle, reach);
    if distance <= reach {
        return Some(before().unwrap_or(middle).min(middle));
    }
    before().or_else(|| come_near(a, b, middle, until, reach))
}

/// Groups of `count` things that meet, directly or through others, as lists of indices in order of the first. `meets`
/// is called with indices that are not in one group yet, the larger first.
pub(crate) fn merge(count: usize, meets: impl Fn(usize, usize) -> bool) -> Vec<Vec<usize>> {
    let mut leader: Vec<usize> = (0..count).collect();
    for a in 0..count {
        for b in 0..a {
            if leader[a] != leader[b] && meets(a, b) {
                let (low, high) = (leader[a].min(leader[b]), leader[a].max(leader[b]));
                leader.iter_mut().filter(|leader| **leader == high).for_each(|leader| *leader = low);
            }
        }
    }
    let leaders = (0..count).filter(|&k| leader[k] == k);
    leaders.map(|first| (0..count).filter(|&k| leader[k] == first).collect()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    fn way(x: DVec3, v: DVec3, until: f64) -> Way {
        let flight = Parabola { t: 0.0, x, v, a: DVec3::new(0.0, 0.0, -2.0) };
        let rest = Parabola { t: until, x: flight.at(until), v: DVec3::ZERO, a: DVec3::ZERO };
        Way::new(&[flight, rest], 10.0)
    }

    /// Two bodies that cross the same place: at the same time, at different times, and one that passes where the other
    /// rests.
    #[test]
    fn ways_meet_in_space_and_time() {
        let right = way(DVec3::new(-1.0, 0.0, 0.0), DVec3::X, 2.0);
        let left = |start: f64, until: f64| way(DVec3::new(start, 0.05, 0.0), -DVec3::X, until);
        // At 1 s they are 0.05 m apart, and 0.1 m when each is √(0.1² − 0.05²) / 2 m from the middle.
        let when = 1.0 - 0.5 * (0.01_f64 - 0.0025).sqrt();
        for near in [right.meets(&left(1.0, 2.0), 0.1), left(1.0, 2.0).meets(&right, 0.1)] {
            assert!(near.is_some_and(|near| near <= when && near > when - 1e-6), "{near:?} {when}");
        }
        assert!(right.meets(&left(1.0, 2.0), 0.04).is_none());
        // It falls under its own gravity while the other still waits at another height.
        let late = Way::new(
            &[
                Parabola { t: 0.0, x: DVec3::new(0.0, 5.0, 0.0), v: DVec3::ZERO, a: DVec3::ZERO },
                Parabola { t: 3.0, x: DVec3::new(0.0, 5.0, -1.0), v: -5.0 * DVec3::Y, a: DVec3::ZERO },
            ],
            10.0,
        );
        assert!(right.meets(&late, 0.2).is_none(), "when it comes, the other has passed");
        let resting = way(DVec3::new(0.0, -20.0, 0.0), 5.0 * DVec3::Y, 1.0);
        assert!(right.meets(&resting, 0.5).is_none());
        let rests_there =
            Way::new(&[Parabola { t: 0.0, x: DVec3::new(0.0, 0.0, -1.0), v: DVec3::ZERO, a: DVec3::ZERO }], 10.0);
        assert!(right.meets(&rests_there, 0.05).is_some() && late.meets(&rests_there, 0.05).is_some());
    }

    #[test]
    fn groups_are_joined_through_others() {
        let meets = |a: usize, b: usize| [(4, 1), (3, 1), (5, 2)].contains(&(a, b));
        assert_eq!(merge(6, meets), [vec![0], vec![1, 3, 4], vec![2, 5]]);
        assert!(merge(0, meets).is_empty());
    }
}

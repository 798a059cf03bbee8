//! Bodies that follow keyframes, whatever they meet: a foot, a paddle, a tray.
//!
//! Between keys a track stands still, is straight, or is a cubic, like animations in glTF. Wherever a body is asked for
//! at a time, and wherever others feel its position, velocity or turning, it is where the tracks have it, to rounding.
//! Only the search for a first contact sees a simpler motion. Its orientation is that of the track too, but its origin
//! is on a parabola from where and as fast as it is to where it will be. On a cubic the two part by at most
//! `2/81 · |x‴| h³` within `h` seconds, so each parabola is so short that this is a tenth of the gap at which bodies
//! touch; it begins anew with each event of the body. In lasting contact it is as long as the step: others move
//! straight within a step, which is an error of a lower order.

use super::free_rotation::FreeRotation;
use super::inertia::rotation;
use super::keyed_rotation::{Cubic, Turned, Turns, at};
use crate::error::WorldError;
use crate::rigid::BodyDef;
use crate::rigid::body_state::{Phase, RigidBodyState};
use crate::rigid::tolerances::PATH_ERROR;
use glam::{DQuat, DVec3, DVec4};
use plaus_dist::math;

/// How a track goes from one key to the next.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Interpolation {
    /// It stands still and jumps at the next key. A body that it jumps into is pushed out as from any overlap; the jump
    /// itself hits nothing.
    Step,
    /// Straight, at a steady rate; rotations take the shorter way.
    Linear,
    /// On the cubic with the keys' slopes.
    Cubic,
}

/// A value at a time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Key<T> {
    /// In s, from 0 on.
    pub time: f64,
    /// The value.
    pub value: T,
    /// Its rates of change per second before and after the key, for cubics.
    pub slopes: [T; 2],
}

/// A value over time. Before the first key and after the last it stands still.
#[derive(Debug, Clone, PartialEq)]
pub struct Track<T> {
    /// How it goes between keys.
    pub between: Interpolation,
    /// At least one, in order of their times.
    pub keys: Vec<Key<T>>,
}

/// The motion of a driven body: its origin in m, and the rotation that turns its axes into those of the world. The
/// origin is the centre of gravity, unless its shape is [about another point](crate::shape::Shape::about).
///
/// For rotations on cubics, the quaternion's components follow the cubic, and the quaternion is then normalised.
#[derive(Debug, Clone, PartialEq)]
pub struct Keyframes {
    /// Where the origin is.
    pub position: Track<DVec3>,
    /// How the body is turned.
    pub rotation: Track<DQuat>,
}

impl<T: Copy> Track<T> {
    /// A constant value.
    #[must_use]
    pub fn fixed(value: T) -> Self {
        Self { between: Interpolation::Step, keys: vec![Key { time: 0.0, value, slopes: [value; 2] }] }
    }

    /// Linear between these times and values.
    #[must_use]
    pub fn linear(keys: impl IntoIterator<Item = (f64, T)>) -> Self {
        let key = |(time, value)| Key { time, value, slopes: [value; 2] };
        Self { between: Interpolation::Linear, keys: keys.into_iter().map(key).collect() }
    }

    /// The key before a time, and the key after it.
    fn around(&self, time: f64) -> (&Key<T>, Option<&Key<T>>) {
        let after = self.keys.partition_point(|k| k.time <= time);
        if after == 0 { (&self.keys[0], None) } else { (&self.keys[after - 1], self.keys.get(after)) }
    }

    fn check(&self, name: &'static str, parts: impl Fn(&T) -> [f64; 4]) -> Result<(), (usize, &'static str, f64)> {
        let mut last = f64::NEG_INFINITY;
        for (k, key) in self.keys.iter().enumerate() {
            if !(key.time >= 0.0 && key.time.is_finite() && key.time > last) {
                return Err((k, "time", key.time));
            }
            last = key.time;
            let slopes = if self.between == Interpolation::Cubic { &key.slopes[..] } else { &[] };
            for value in std::iter::once(&key.value).chain(slopes) {
                if let Some(bad) = parts(value).into_iter().find(|x| !x.is_finite()) {
                    return Err((k, name, bad));
                }
            }
        }
        if self.keys.is_empty() { Err((0, "number of keys", 0.0)) } else { Ok(()) }
    }
}

fn as_vectors<T: Copy>(key: &Key<T>, vector: impl Fn(T) -> DVec4) -> Key<DVec4> {
    Key { time: key.time, value: vector(key.value), slopes: key.slopes.map(vector) }
}

/// The rotation vector that takes one orientation to another, the shorter way.
pub(crate) fn rotation_vector(from: DQuat, to: DQuat) -> DVec3 {
    let q = to * from.conjugate();
    let q = if q.w < 0.0 { -q } else { q };
    let v = q.xyz();
    let sine = v.length();
    if sine > 0.0 { v * (2.0 * math::atan2(sine, q.w) / sine) } else { DVec3::ZERO }
}

/// The cubic between two keys, by the time since the first.
fn cubic(from: &Key<DVec4>, to: &Key<DVec4>) -> Cubic<DVec4> {
    let h = to.time - from.time;
    let (m, n) = (from.slopes[1] * h, to.slopes[0] * h);
    let rise = to.value - from.value;
    [from.value, from.slopes[1], (rise * 3.0 - m * 2.0 - n) / (h * h), (m + n - rise * 2.0) / (h * h * h)]
}

/// The same cubic from a later time on.
fn later(cubic: Cubic<DVec4>, by: f64) -> Cubic<DVec4> {
    let [x, v, a] = at(&cubic, by);
    [x, v, a * 0.5, cubic[3]]
}

impl Keyframes {
    /// The path of the origin from a time on, up to the next key; `inside` is a time between the two.
    fn way(&self, time: f64, inside: f64) -> Cubic<DVec3> {
        let (from, to) = self.position.around(inside);
        let collider = [from.value, DVec3::ZERO, DVec3::ZERO, DVec3::ZERO];
        let Some(to) = to else { return collider };
        match self.position.between {
            Interpolation::Step => collider,
            Interpolation::Linear => {
                let (rise, part) = (to.value - from.value, (time - from.time) / (to.time - from.time));
                [from.value + rise * part, rise / (to.time - from.time), DVec3::ZERO, DVec3::ZERO]
            }
            Interpolation::Cubic => {
                let keys = [from, to].map(|k| as_vectors(k, |v: DVec3| v.extend(0.0)));
                later(cubic(&keys[0], &keys[1]), time - from.time).map(DVec4::truncate)
            }
        }
    }

    /// The rotation at a time, where it is not a cubic.
    fn turn(&self, time: f64, inside: f64) -> DQuat {
        let (from, to) = self.rotation.around(inside);
        let start = from.value.normalize();
        match to {
            Some(to) if self.rotation.between == Interpolation::Linear => {
                let part = (time - from.time) / (to.time - from.time);
                (rotation(rotation_vector(start, to.value.normalize()) * part) * start).normalize()
            }
            _ => start,
        }
    }

    /// How it turns between two times that have no key between them.
    fn turns(&self, [time, until]: [f64; 2]) -> Turns {
        let inside = 0.5 * (time + until);
        let (from, to) = self.rotation.around(inside);
        if let Some(to) = to.filter(|_| self.rotation.between == Interpolation::Cubic) {
            let mut keys = [from, to].map(|k| as_vectors(k, DVec4::from));
            if keys[0].value.dot(keys[1].value) < 0.0 {
                keys[1].value = -keys[1].value;
                keys[1].slopes = keys[1].slopes.map(|s| -s);
            }
            let turns = later(cubic(&keys[0], &keys[1]), time - from.time);
            if turns[1..] != [DVec4::ZERO; 3] {
                return Turns::Cubic(turns);
            }
        }
        let [turn, end] = [time, until].map(|time| self.turn(time, inside));
        Turns::Steady { turn, spin: rotation_vector(turn, end) / (until - time) }
    }

    /// Checks the numbers of a body's keys.
    fn check(&self, body: usize) -> Result<(), WorldError> {
        let three = |v: &DVec3| v.extend(0.0).to_array();
        let named = |track: &'static str| {
            move |(key, field, value)| WorldError::BadKey {
                body,
                track,
                key,
                field,
                value,
                expected: "finite numbers, rotations of a length that is not 0, and ascending times of at least 0",
            }
        };
        self.position.check("value", three).map_err(named("position"))?;
        self.rotation.check("value", |q| q.to_array()).map_err(named("rotation"))?;
        match self.rotation.keys.iter().position(|k| k.value.length() == 0.0) {
            Some(key) => Err(named("rotation")((key, "length", 0.0))),
            None => Ok(()),
        }
    }

    /// Times at which one of the tracks has a key, from 0 on.
    fn times(&self) -> Vec<f64> {
        let of = self.position.keys.iter().map(|k| k.time).chain(self.rotation.keys.iter().map(|k| k.time));
        let mut times: Vec<f64> = of.chain([0.0]).collect();
        times.sort_by(f64::total_cmp);
        times.dedup();
        times
    }
}

/// A driven body's path from one key to the next.
#[derive(Debug, Clone, Copy)]
struct PathPiece {
    t: f64,
    /// The path of its origin.
    way: Cubic<DVec3>,
    turns: Turns,
}

/// A driven body's path, in stretches. In the last it stands still.
#[derive(Debug, Clone)]
pub(crate) struct KinematicPath {
    stretches: Vec<PathPiece>,
    /// How far off a parabola may be on which a search sees the origin, in m.
    off: f64,
}

/// How a driven body moves in a step: its mean velocities, and those at the end.
pub(crate) struct Carried {
    pub(crate) mean: (DVec3, DVec3),
    pub(crate) end: (DVec3, DVec3),
}

/// Place, velocity and acceleration of a driven body's origin; orientation, angular velocity and its rate.
pub(crate) struct Moved {
    pub(crate) x: DVec3,
    pub(crate) v: DVec3,
    pub(crate) a: DVec3,
    pub(crate) turn: DQuat,
    pub(crate) spin: DVec3,
    pub(crate) angular_acceleration: DVec3,
}

impl KinematicPath {
    /// The path of the body with this index.
    pub(crate) fn new(body: usize, spec: &BodyDef, keys: &Keyframes) -> Result<Self, WorldError> {
        keys.check(body)?;
        let times = keys.times();
        let stretch = |pair: &[f64]| {
            let (t, inside) = (pair[0], 0.5 * (pair[0] + pair[1]));
            PathPiece { t, way: keys.way(t, inside), turns: keys.turns([pair[0], pair[1]]) }
        };
        let mut stretches: Vec<PathPiece> = times.windows(2).map(stretch).collect();
        let last = times[times.len() - 1];
        let turns = Turns::Steady { turn: keys.turn(last, last), spin: DVec3::ZERO };
        stretches.push(PathPiece { t: last, way: keys.way(last, last), turns });
        Ok(Self { stretches, off: PATH_ERROR * spec.gap })
    }

    /// The stretch at a time, and the next.
    fn around(&self, time: f64) -> (&PathPiece, Option<&PathPiece>) {
        let next = self.stretches.partition_point(|s| s.t <= time).max(1);
        (&self.stretches[next - 1], self.stretches.get(next))
    }

    /// Puts a body where its path is at a time.
    pub(crate) fn follow(&self, body: &mut RigidBodyState, time: f64) {
        let (s, next) = self.around(time);
        let dt = (time - s.t).max(0.0);
        let ([x, v, a], jerk) = (at(&s.way, dt), s.way[3] * 6.0);
        let Turned { turn, spin, .. } = s.turns.at(dt);
        (body.path.t, body.path.x, body.path.v, body.path.a) = (time, x, v, a);
        (body.turn, body.spin) = (turn, spin);
        let Some(next) = next else {
            (body.phase, body.expiry) = (Phase::Rest, crate::rigid::body_state::NEVER);
            return;
        };
        (body.phase, body.expiry) = (Phase::Driven, next.t);
        if jerk != DVec3::ZERO {
            let left = next.t - time;
            let longest = math::cbrt(self.off * 40.5 / jerk.length());
            let h = left / (left / longest).ceil().max(1.0);
            if h < left {
                body.expiry = time + h;
            }
            body.path.a = a + jerk * (h / 3.0);
        }
    }

    /// Lets searches see a body on a single parabola during a step of lasting contact of `h` seconds.
    pub(crate) fn hold(&self, body: &mut RigidBodyState, h: f64) {
        let time = body.path.t;
        let (s, next) = self.around(time);
        let jerk = s.way[3] * 6.0;
        if jerk != DVec3::ZERO {
            body.expiry = next.map_or(crate::rigid::body_state::NEVER, |next| next.t.min(time + h));
            body.path.a = at(&s.way, (time - s.t).max(0.0))[2] + jerk * (h / 3.0);
        }
    }

    /// The motion `dt` after a time, without a key between.
    pub(crate) fn moved(&self, time: f64, dt: f64) -> Moved {
        let s = self.around(time).0;
        let t = (time - s.t).max(0.0) + dt;
        let [x, v, a] = at(&s.way, t);
        let Turned { turn, spin, angular_acceleration } = s.turns.at(t);
        Moved { x, v, a, turn, spin, angular_acceleration }
    }

    /// How long after a time the next key comes.
    pub(crate) fn left(&self, time: f64) -> f64 {
        self.around(time).1.map_or(crate::rigid::body_state::NEVER, |next| next.t) - time
    }

    /// The rotation from a time on.
    pub(crate) fn free_rotation(&self, time: f64) -> FreeRotation {
        let s = self.around(time).0;
        match s.turns {
            Turns::Steady { .. } => {
                let Turned { turn, spin, .. } = s.turns.at((time - s.t).max(0.0));
                FreeRotation::steady(turn, spin)
            }
            Turns::Cubic(_) => FreeRotation::keyed(s.turns, (time - s.t).max(0.0)),
        }
    }

    /// The angular velocity `dt` after a time, without a key between.
    pub(crate) fn spin(&self, time: f64, dt: f64) -> DVec3 {
        let s = self.around(time).0;
        s.turns.at((time - s.t).max(0.0) + dt).spin
    }

    /// The velocity `dt` after a time, without a key between.
    pub(crate) fn velocity(&self, time: f64, dt: f64) -> DVec3 {
        let s = self.around(time).0;
        at(&s.way, (time - s.t).max(0.0) + dt)[1]
    }

    /// An upper bound on the angular speed between two times without a key between, as searches need it.
    pub(crate) fn fastest(&self, [from, until]: [f64; 2]) -> f64 {
        let (s, next) = self.around(from);
        let until = next.map_or(from, |next| until.min(next.t));
        s.turns.fastest([from, until].map(|time| (time - s.t).max(0.0)))
    }

    /// How the body moves in a step of `h` seconds from a time on, without a key between.
    pub(crate) fn carried(&self, time: f64, h: f64) -> Carried {
        let s = self.around(time).0;
        let dt = (time - s.t).max(0.0);
        let [_, v, a] = at(&s.way, dt);
        let jerk = s.way[3] * 6.0;
        let mean = v + (a * 0.5 + jerk * (h / 6.0)) * h;
        let [spin, end] = match s.turns {
            Turns::Steady { spin, .. } => [spin; 2],
            Turns::Cubic(_) => {
                let (now, then) = (s.turns.at(dt), s.turns.at(dt + h));
                [rotation_vector(now.turn, then.turn) / h, then.spin]
            }
        };
        Carried { mean: (mean, spin), end: (v + (a + jerk * (0.5 * h)) * h, end) }
    }

    /// A bound on the acceleration of points at this distance from the origin, but for what their speed says.
    pub(crate) fn push(&self, time: f64, bounding_radius: f64) -> f64 {
        let s = self.around(time).0;
        let dt = (time - s.t).max(0.0);
        at(&s.way, dt)[2].length() + s.turns.at(dt).angular_acceleration.length() * bounding_radius
    }

    /// Whether it stands still from a time on to the next key.
    pub(crate) fn is_still(&self, time: f64) -> bool {
        let s = self.around(time).0;
        let is_turned = matches!(s.turns, Turns::Steady { spin: DVec3::ZERO, .. });
        is_turned && s.way[1..] == [DVec3::ZERO; 3]
    }
}

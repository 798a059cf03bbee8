//! Bodies that follow keyframes, whatever they meet: a foot, a paddle, a tray.
//!
//! Between keys a track stands still, is straight, or is a cubic, like animations in glTF. A body's path is cut into
//! pieces of the simulator's own closed form, a parabola with a steady rotation. Straight tracks are represented
//! exactly. Cubics are cut into pieces so short that no point of the body is off by more than a tenth of the gap at
//! which bodies touch. At the ends of the pieces, positions and velocities are those of the tracks; angular velocities
//! are means over each piece.

use super::Spec;
use super::body::{Phase, Turning};
use super::tumble::rotation;
use crate::error::WorldError;
use glam::{DQuat, DVec3, DVec4};
use plaus_dist::math;

/// How a track goes from one key to the next.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Between {
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
    pub between: Between,
    /// At least one, in order of their times.
    pub keys: Vec<Key<T>>,
}

/// The motion of a driven body: its centre of gravity in m, and the rotation that turns its axes into those of the
/// world.
///
/// For rotations on cubics, the quaternion's components follow the cubic, and the quaternion is then normalised.
#[derive(Debug, Clone, PartialEq)]
pub struct Keyframes {
    /// Where the centre of gravity is.
    pub position: Track<DVec3>,
    /// How the body is turned.
    pub rotation: Track<DQuat>,
}

impl<T: Copy> Track<T> {
    /// A constant value.
    #[must_use]
    pub fn fixed(value: T) -> Self {
        Self { between: Between::Step, keys: vec![Key { time: 0.0, value, slopes: [value; 2] }] }
    }

    /// Linear between these times and values.
    #[must_use]
    pub fn linear(keys: impl IntoIterator<Item = (f64, T)>) -> Self {
        let key = |(time, value)| Key { time, value, slopes: [value; 2] };
        Self { between: Between::Linear, keys: keys.into_iter().map(key).collect() }
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
            let slopes = if self.between == Between::Cubic { &key.slopes[..] } else { &[] };
            for value in std::iter::once(&key.value).chain(slopes) {
                if let Some(bad) = parts(value).into_iter().find(|x| !x.is_finite()) {
                    return Err((k, name, bad));
                }
            }
        }
        if self.keys.is_empty() { Err((0, "number of keys", 0.0)) } else { Ok(()) }
    }
}

/// A vector on the cubic between two keys at the fraction `part` of the time, and its rate.
fn cubic(from: &Key<DVec4>, to: &Key<DVec4>, part: f64) -> [DVec4; 2] {
    let (h, s) = (to.time - from.time, part);
    let (m, n) = (from.slopes[1] * h, to.slopes[0] * h);
    let rise = to.value - from.value;
    let value = from.value + (m + (rise * 3.0 - m * 2.0 - n + (m + n - rise * 2.0) * s) * s) * s;
    let rate = (m + ((rise * 3.0 - m * 2.0 - n) * 2.0 + (m + n - rise * 2.0) * (3.0 * s)) * s) / h;
    [value, rate]
}

fn as_vectors<T: Copy>(key: &Key<T>, vector: impl Fn(T) -> DVec4) -> Key<DVec4> {
    Key { time: key.time, value: vector(key.value), slopes: key.slopes.map(vector) }
}

/// The rotation vector that takes one orientation to another, the shorter way.
pub(super) fn between(from: DQuat, to: DQuat) -> DVec3 {
    let q = to * from.conjugate();
    let q = if q.w < 0.0 { -q } else { q };
    let v = q.xyz();
    let sine = v.length();
    if sine > 0.0 { v * (2.0 * math::atan2(sine, q.w) / sine) } else { DVec3::ZERO }
}

impl Keyframes {
    /// Position and velocity, from the pair of keys whose times enclose `inside`.
    fn place(&self, time: f64, inside: f64) -> [DVec3; 2] {
        let (from, to) = self.position.around(inside);
        let Some(to) = to else { return [from.value, DVec3::ZERO] };
        let part = (time - from.time) / (to.time - from.time);
        match self.position.between {
            Between::Step => [from.value, DVec3::ZERO],
            Between::Linear => {
                let rise = to.value - from.value;
                [from.value + rise * part, rise / (to.time - from.time)]
            }
            Between::Cubic => {
                let vectors = [from, to].map(|k| as_vectors(k, |v: DVec3| v.extend(0.0)));
                cubic(&vectors[0], &vectors[1], part).map(DVec4::truncate)
            }
        }
    }

    fn turn(&self, time: f64, inside: f64) -> DQuat {
        let (from, to) = self.rotation.around(inside);
        let start = from.value.normalize();
        let Some(to) = to else { return start };
        let part = (time - from.time) / (to.time - from.time);
        match self.rotation.between {
            Between::Step => start,
            Between::Linear => (rotation(between(start, to.value.normalize()) * part) * start).normalize(),
            Between::Cubic => {
                let mut vectors = [from, to].map(|k| as_vectors(k, DVec4::from));
                if vectors[0].value.dot(vectors[1].value) < 0.0 {
                    vectors[1].value = -vectors[1].value;
                    vectors[1].slopes = vectors[1].slopes.map(|s| -s);
                }
                DQuat::from_vec4(cubic(&vectors[0], &vectors[1], part)[0]).normalize()
            }
        }
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

/// A stretch of a driven body's path.
#[derive(Debug, Clone, Copy)]
struct Stretch {
    t: f64,
    x: DVec3,
    v: DVec3,
    a: DVec3,
    turn: DQuat,
    spin: DVec3,
}

/// A driven body's path, in stretches.
#[derive(Debug, Clone)]
pub(super) struct Drive {
    stretches: Vec<Stretch>,
}

/// Maximum number of halvings of the time between keys.
const HALVINGS: u32 = 16;

/// Fraction of the gap at which bodies touch by which a path may be off. Default 0.1.
const OFF: f64 = 0.1;

impl Drive {
    /// The path of the body with this index.
    pub(super) fn new(body: usize, spec: &Spec, keys: &Keyframes) -> Result<Self, WorldError> {
        keys.check(body)?;
        let mut drive = Self { stretches: Vec::new() };
        let times = keys.times();
        for pair in times.windows(2) {
            drive.add(spec, keys, [pair[0], pair[1]], HALVINGS);
        }
        let last = times[times.len() - 1];
        let (x, turn) = (keys.place(last, last)[0], keys.turn(last, last));
        drive.stretches.push(Stretch { t: last, x, v: DVec3::ZERO, a: DVec3::ZERO, turn, spin: DVec3::ZERO });
        Ok(drive)
    }

    /// Adds the path between two times that have no key between them.
    fn add(&mut self, spec: &Spec, keys: &Keyframes, [from, to]: [f64; 2], halvings: u32) {
        let (h, inside) = (to - from, 0.5 * (from + to));
        let ([x, v], [y, w]) = (keys.place(from, inside), keys.place(to, inside));
        let (turn, end) = (keys.turn(from, inside), keys.turn(to, inside));
        let spin = between(turn, end) / h;
        // Two parabolas that meet half way, with exact positions and velocities at both ends.
        let middle = (y - x) * (2.0 / h) - (v + w) * 0.5;
        let is_cubic = keys.position.between == Between::Cubic;
        let (a, b) =
            if is_cubic { ((middle - v) * (2.0 / h), (w - middle) * (2.0 / h)) } else { (DVec3::ZERO, DVec3::ZERO) };
        let half = x + (v + middle) * (0.25 * h);
        let at = |part: f64| {
            let t = part * h;
            let s = t - 0.5 * h;
            if s <= 0.0 || !is_cubic { x + (v + a * (0.5 * t)) * t } else { half + (middle + b * (0.5 * s)) * s }
        };
        let off = [0.25, 0.5, 0.75].map(|part| {
            let time = from + part * h;
            let turned = between(rotation(spin * (part * h)) * turn, keys.turn(time, inside)).length() * spec.reach;
            (keys.place(time, inside)[0] - at(part)).length() + turned
        });
        if halvings > 0 && off.into_iter().fold(0.0, f64::max) > OFF * spec.gap {
            self.add(spec, keys, [from, inside], halvings - 1);
            return self.add(spec, keys, [inside, to], halvings - 1);
        }
        let first = Stretch { t: from, x, v, a, turn, spin };
        self.stretches.push(first);
        if is_cubic && a != b {
            let turned = (rotation(spin * (0.5 * h)) * turn).normalize();
            self.stretches.push(Stretch { t: inside, x: half, v: middle, a: b, turn: turned, spin });
        }
    }

    /// Puts a body where its path is at a time.
    pub(super) fn follow(&self, body: &mut Turning, time: f64) {
        let next = self.stretches.partition_point(|s| s.t <= time).max(1);
        let s = &self.stretches[next - 1];
        let dt = (time - s.t).max(0.0);
        (body.path.t, body.path.v) = (time, s.v + s.a * dt);
        (body.path.x, body.path.a) = (s.x + (s.v + s.a * (0.5 * dt)) * dt, s.a);
        body.turn = if dt > 0.0 { (rotation(s.spin * dt) * s.turn).normalize() } else { s.turn };
        body.spin = s.spin;
        match self.stretches.get(next) {
            Some(next) => (body.phase, body.expiry) = (Phase::Driven, next.t),
            None => (body.phase, body.expiry) = (Phase::Rest, super::body::NEVER),
        }
    }
}

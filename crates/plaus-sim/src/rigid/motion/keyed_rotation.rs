//! How a driven body turns from one key to the next.

use super::inertia::rotation;
use glam::{DQuat, DVec3, DVec4};
use std::ops::{Add, Mul};

/// A cubic of time, by the powers of the time since its start.
pub(super) type Cubic<T> = [T; 4];

/// Value, rate, and rate of that at a time.
pub(super) fn at<T: Copy + Add<Output = T> + Mul<f64, Output = T>>([x, v, a, j]: &Cubic<T>, t: f64) -> [T; 3] {
    [*x + (*v + (*a + *j * t) * t) * t, *v + (*a * 2.0 + *j * (3.0 * t)) * t, *a * 2.0 + *j * (6.0 * t)]
}

/// How a body turns from one key to the next, by the time since a start.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Turns {
    Steady {
        turn: DQuat,
        spin: DVec3,
    },
    /// The quaternion before it is normalised.
    Cubic(Cubic<DVec4>),
}

/// Orientation, angular velocity and its rate.
pub(super) struct Turned {
    pub(super) turn: DQuat,
    pub(super) spin: DVec3,
    pub(super) angular_acceleration: DVec3,
}

/// Parts into which a time is cut at most for bounds of an angular velocity within it.
const MOST_PARTS: u32 = 64;

/// Least length of a quaternion that bounds of an angular velocity reckon with: at 0, a rotation jumps.
const SHORTEST_QUATERNION: f64 = 1e-6;

impl Turns {
    pub(super) fn at(&self, t: f64) -> Turned {
        match self {
            Self::Steady { turn, spin } => {
                let turn = if t > 0.0 { (rotation(*spin * t) * *turn).normalize() } else { *turn };
                Turned { turn, spin: *spin, angular_acceleration: DVec3::ZERO }
            }
            Self::Cubic(turns) => {
                let [q, rate, bend] = at(turns, t);
                let square = q.length_squared();
                let back = DQuat::from_vec4(q).conjugate() * (2.0 / square);
                let [spin, angular_acceleration] = [rate, bend].map(|r| (DQuat::from_vec4(r) * back).xyz());
                let angular_acceleration = angular_acceleration - spin * (2.0 * q.dot(rate) / square);
                Turned { turn: DQuat::from_vec4(q).normalize(), spin, angular_acceleration }
            }
        }
    }

    /// Orientation and angular velocity at a time.
    pub(crate) fn turned(&self, t: f64) -> (DQuat, DVec3) {
        let Turned { turn, spin, .. } = self.at(t);
        (turn, spin)
    }

    /// An upper bound, between two times, on an angular speed whose square bounds the acceleration of any point of the
    /// body over its distance from the origin.
    ///
    /// With `u = q/|q|`, the angular velocity is `2 u̇ u*` and its rate the vector part of `2 ü u*`, so `|ω| ≤ 2
    /// |q̇|/|q|` and `|ω̇| ≤ 2 |q̈|/|q| + 6 |q̇|²/|q|²`. The second derivative of `q` is linear, so largest at an end;
    /// it bounds how far the first is from that in the middle, and this how far `q` is.
    pub(crate) fn fastest(&self, [from, until]: [f64; 2]) -> f64 {
        let Self::Cubic(turns) = self else { return self.at(0.0).spin.length() };
        let bound = |from: f64, until: f64| {
            let ([_, _, a], [q, v, _], [_, _, b]) =
                (at(turns, from), at(turns, 0.5 * (from + until)), at(turns, until));
            let (half, bend) = (0.5 * (until - from), a.length().max(b.length()));
            let rate = v.length() + bend * half;
            let least = q.length() - rate * half;
            let length = least.max(SHORTEST_QUATERNION);
            let spin = 2.0 * rate / length;
            (spin * spin * 2.5 + 2.0 * bend / length, least > 0.5 * q.length())
        };
        let mut parts = 1;
        loop {
            let time = |k: u32| from + (until - from) * (f64::from(k) / f64::from(parts));
            let bounds = || (0..parts).map(|k| bound(time(k), time(k + 1)));
            if parts >= MOST_PARTS || bounds().all(|b| b.1) {
                return bounds().map(|b| b.0).fold(0.0, f64::max).sqrt();
            }
            parts *= 2;
        }
    }
}

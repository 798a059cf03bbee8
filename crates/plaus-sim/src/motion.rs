//! One piece of closed-form motion: a parabola of the centre, valid from its own clock on.

use crate::scenery::{Aabb, greater, lesser};
use glam::DVec3;
use serde::{Deserialize, Serialize};

/// Centre `x + v τ + a τ²/2` with `τ = time − t`. Free flight, sliding, rolling, rest and the steps of a contact group
/// all have this form, so detection needs no other.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Parabola {
    /// The body's own clock: the time from which the motion is valid, in s.
    pub t: f64,
    /// Centre at `t` in m.
    pub x: DVec3,
    /// Velocity at `t` in m/s.
    pub v: DVec3,
    /// Acceleration in m/s².
    pub a: DVec3,
}

impl Parabola {
    /// Centre at an absolute time.
    #[inline]
    #[must_use]
    pub fn at(&self, time: f64) -> DVec3 {
        self.after(time - self.t)
    }

    /// Centre after `dt` seconds.
    #[inline]
    #[must_use]
    pub fn after(&self, dt: f64) -> DVec3 {
        self.x + (self.v + self.a * (0.5 * dt)) * dt
    }

    /// Velocity after `dt` seconds.
    #[inline]
    #[must_use]
    pub fn velocity_after(&self, dt: f64) -> DVec3 {
        self.v + self.a * dt
    }

    /// The smallest box around the centre between `from` and `until` seconds after `t`.
    #[inline]
    #[must_use]
    pub fn bounds(&self, from: f64, until: f64) -> Aabb {
        Course::new(self).bounds(from, self.after(from), until)
    }
}

/// A motion with the times at which its coordinates turn, in seconds after its clock, and their values then: for boxes
/// around many parts of the motion.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Course<'p> {
    path: &'p Parabola,
    turns: DVec3,
    peaks: DVec3,
}

impl<'p> Course<'p> {
    #[inline]
    pub(crate) fn new(path: &'p Parabola) -> Self {
        // The coordinate turns where v + a τ = 0; if it never does, this is NaN or infinite.
        let turns = -path.v / path.a;
        Self { path, turns, peaks: path.x + 0.5 * path.v * turns }
    }

    /// The smallest box around the centre between `from`, when it is at `x`, and `until` seconds after the clock.
    #[inline]
    pub(crate) fn bounds(&self, from: f64, x: DVec3, until: f64) -> Aabb {
        let end = self.path.after(until);
        let mut b = Aabb {
            min: DVec3::new(lesser(x.x, end.x), lesser(x.y, end.y), lesser(x.z, end.z)),
            max: DVec3::new(greater(x.x, end.x), greater(x.y, end.y), greater(x.z, end.z)),
        };
        for k in 0..3 {
            if self.turns[k] > from && self.turns[k] < until {
                b.min[k] = lesser(b.min[k], self.peaks[k]);
                b.max[k] = greater(b.max[k], self.peaks[k]);
            }
        }
        b
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bounds_hold_the_peak() {
        let p = Parabola { t: 1.0, x: DVec3::ZERO, v: DVec3::new(1.0, 0.0, 2.0), a: DVec3::new(0.0, 0.0, -2.0) };
        let b = p.bounds(0.0, 2.0);
        assert_eq!(b.max, DVec3::new(2.0, 0.0, 1.0));
        assert_eq!(b.min, DVec3::ZERO);
        assert_eq!(p.at(3.0), DVec3::new(2.0, 0.0, 0.0));
    }
}

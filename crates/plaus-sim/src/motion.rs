//! One stretch of closed-form motion: a parabola of the centre, valid from its own clock on.

use crate::scenery::{Aabb, greater, lesser};
use glam::DVec3;
use serde::{Deserialize, Serialize};

/// Centre `x + v τ + a τ²/2` with `τ = time − t`. Free flight, sliding, rolling, rest and the steps of a contact group are all of this form, so detection knows only it.
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
        let (p, q) = (self.after(from), self.after(until));
        let mut b = Aabb {
            min: DVec3::new(lesser(p.x, q.x), lesser(p.y, q.y), lesser(p.z, q.z)),
            max: DVec3::new(greater(p.x, q.x), greater(p.y, q.y), greater(p.z, q.z)),
        };
        if self.a != DVec3::ZERO {
            self.widen(&mut b, from, until);
        }
        b
    }

    #[inline]
    fn widen(&self, b: &mut Aabb, from: f64, until: f64) {
        for k in 0..3 {
            // The coordinate turns where v + a τ = 0.
            let turn = -self.v[k] / self.a[k];
            if turn > from && turn < until {
                let peak = self.x[k] + 0.5 * self.v[k] * turn;
                b.min[k] = lesser(b.min[k], peak);
                b.max[k] = greater(b.max[k], peak);
            }
        }
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

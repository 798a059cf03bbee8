//! Damping and constant torque.
//!
//! With rates `c` and `d`, `v̇ = a − c v` and `L̇ = T − d L` have closed forms: `v = a/c + (v₀ − a/c) e^(−ct)`, and
//! similarly for the angular momentum. Without a torque a body turns as it would without damping, but its time runs as
//! `(1 − e^(−dt))/d`. The search for contacts knows only parabolas and free rotation, so such a flight is cut into
//! legs. On each leg the body follows a parabola through the closed form's positions at both ends with its velocity at
//! the start, and turns freely with the leg's mean angular momentum. Legs are so short that the distance of any point
//! of the body from its place in the closed form is at most [`LEG_ERROR`] of the gap at which it touches. At the ends
//! of legs, velocity, position and angular momentum are those of the closed form to rounding. So is the orientation if
//! there is no torque, or if the torque does not change the axis; otherwise the orientation has an error that falls as
//! the square of the legs' length.

use super::free_rotation::drift;
use crate::rigid::body_state::{Momentum, Phase, RigidBodyState};
use crate::rigid::tolerances::{LEG_BALL_TURN, LEG_ERROR, SMALL_DECAY};
use crate::rigid::{BodyDef, RigidWorld};
use glam::{DMat3, DVec3};
use plaus_dist::math;

/// What slows a body down, and what turns it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Damping {
    /// Rate in 1/s at which velocity is lost.
    pub(crate) linear: f64,
    /// Rate in 1/s at which angular momentum is lost.
    pub(crate) angular: f64,
    /// In N m, in world axes.
    pub(crate) torque: DVec3,
}

/// `(1 − e^(−z))/z`: the mean of `e^(−z s)` over `s` from 0 to 1.
fn mean_decay(z: f64) -> f64 {
    if z == 0.0 { 1.0 } else { -math::exp_m1(-z) / z }
}

/// `(z − 1 + e^(−z))/z²`: the mean over `s` of what a steady gain has become; 1/2 without decay.
fn mean_gain(z: f64) -> f64 {
    if z >= SMALL_DECAY {
        return (z + math::exp_m1(-z)) / (z * z);
    }
    // Σ (−z)ⁿ/(n + 2)!, from the last term on.
    (3..=14).rev().fold(1.0, |sum, n| 1.0 - z / f64::from(n) * sum) * 0.5
}

/// A quantity that grows by `gain` and decays at `rate`, after `dt`.
fn after(start: DVec3, gain: DVec3, rate: f64, dt: f64) -> DVec3 {
    let z = rate * dt;
    start * math::exp(-z) + gain * (mean_decay(z) * dt)
}

/// The integral of that quantity over `dt`.
fn summed(start: DVec3, gain: DVec3, rate: f64, dt: f64) -> DVec3 {
    let z = rate * dt;
    start * (mean_decay(z) * dt) + gain * (mean_gain(z) * dt * dt)
}

impl BodyDef {
    /// Velocity and angular momentum in flight, `dt` later than `from`.
    pub(crate) fn damped(&self, damping: &Damping, from: &Momentum, dt: f64) -> Momentum {
        Momentum {
            v: after(from.v, self.gravity, damping.linear, dt),
            l: after(from.l, damping.torque, damping.angular, dt),
        }
    }

    /// Velocities `dt` later of a body with orientation `r` that stays where it is. A step of lasting contact begins
    /// and ends with them.
    #[inline]
    pub(crate) fn kicked(&self, r: &DMat3, [v, w]: [DVec3; 2], dt: f64) -> (DVec3, DVec3) {
        match &self.damping {
            None => (v + self.gravity * dt, w),
            Some(damping) => {
                let gain = self.inertia.inverse(r) * damping.torque;
                (after(v, self.gravity, damping.linear, dt), after(w, gain, damping.angular, dt))
            }
        }
    }

    /// The torque that acts on it, in N m.
    pub(crate) fn torque(&self) -> DVec3 {
        self.damping.map_or(DVec3::ZERO, |d| d.torque)
    }

    /// How long a leg may be.
    fn leg(&self, damping: &Damping, from: &Momentum) -> f64 {
        let stray = LEG_ERROR * self.gap;
        // The third derivative of the path is at most this. A parabola through both ends strays by 2/81 of it times h³.
        let jerk = damping.linear * (self.gravity - from.v * damping.linear).length();
        let straight = math::cbrt(stray * 40.5 / jerk);
        let turning = (damping.torque - from.l * damping.angular).length() / self.inertia.moments.min_element();
        let most = if self.is_ball { LEG_BALL_TURN } else { stray / self.bounding_radius };
        straight.min((8.0 * most / turning).sqrt())
    }
}

impl RigidBodyState {
    /// Velocity and angular momentum `dt` after the start of a leg.
    pub(crate) fn within_leg(&self, spec: &BodyDef, dt: f64) -> Momentum {
        spec.damping
            .as_ref()
            .filter(|_| dt > 0.0)
            .map_or(self.ends[0], |damping| spec.damped(damping, &self.ends[0], dt))
    }

    /// Moves along a leg to `dt` after its start, where its centre is already known to be.
    pub(crate) fn follow_leg(&mut self, spec: &BodyDef, dt: f64) {
        let now = self.within_leg(spec, dt);
        (self.turn, _) = drift(&spec.inertia, self.turn, self.spin, dt);
        (self.path.v, self.spin) = (now.v, spec.inertia.spin(self.turn, now.l));
        self.ends[0] = now;
    }
}

impl RigidWorld {
    /// Lets a body that touches nothing fly on.
    pub(crate) fn fly(&self, index: usize, body: &mut RigidBodyState) {
        let spec = &self.specs[index];
        let Some(damping) = &spec.damping else { return body.begin(Phase::Flight, spec.gravity) };
        let from = Momentum { v: body.path.v, l: spec.inertia.momentum(body.turn, body.spin) };
        let h = spec.leg(damping, &from).min(self.duration);
        let way = summed(from.v, spec.gravity, damping.linear, h);
        body.begin(Phase::Leg, (way / h - from.v) * (2.0 / h));
        body.ends[0] = from;
        body.spin = spec.inertia.spin(body.turn, summed(from.l, damping.torque, damping.angular, h) / h);
        body.expiry = body.path.t + h;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Compared with sums of a thousand terms of Simpson's rule, whose error is of the order of 1e-13.
    #[test]
    fn means_are_those_of_their_integrands() {
        for z in [0.0, 1e-9, 1e-3, 0.3, 0.499, 0.501, 2.0, 20.0] {
            let simpson = |f: &dyn Fn(f64) -> f64| {
                let weight = |k: usize| if k == 0 || k == 1000 { 1.0 } else { 2.0 + 2.0 * (k % 2) as f64 };
                (0..=1000).map(|k| weight(k) * f(k as f64 / 1000.0)).sum::<f64>() / 3000.0
            };
            let decay = simpson(&|s| math::exp(-z * s));
            let gain = simpson(&|s| (1.0 - s) * math::exp(-z * s));
            // Simpson's own error: the largest fourth derivative, z⁴ and z⁴ + 4 z³, over 180 · 1000⁴; and rounding.
            let (cube, simpsons) = (z * z * z, |fourth: f64| 1e-14 + fourth / 1.8e14);
            assert!((mean_decay(z) - decay).abs() < simpsons(cube * z), "{z}: {} for {decay}", mean_decay(z));
            // ∫₀¹ ∫₀ˢ e^(−z(s−r)) dr ds = ∫₀¹ (1 − u) e^(−z u) du.
            assert!((mean_gain(z) - gain).abs() < simpsons(cube * (z + 4.0)), "{z}: {} for {gain}", mean_gain(z));
        }
    }
}

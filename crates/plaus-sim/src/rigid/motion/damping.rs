//! Damping, constant torque, and forces and torques that turn with a body.
//!
//! With rates `c` and `d`, `v̇ = a − c v` and `L̇ = T − d L` have closed forms: `v = a/c + (v₀ − a/c) e^(−ct)`, and
//! similarly for the angular momentum. Without a torque a body turns as it would without damping, but its time runs as
//! `(1 − e^(−dt))/d`. The search for contacts knows only parabolas and free rotation, so such a flight is cut into
//! legs. On each leg the body follows a parabola through the closed form's positions at both ends with its velocity at
//! the start, and turns freely with the leg's mean angular momentum. Legs are so short that the distance of any point
//! of the body from its place in the closed form is at most [`LEG_ERROR`] of the gap at which it touches. At the ends
//! of legs, velocity, position and angular momentum are those of the closed form to rounding. So is the orientation if
//! there is no torque, or if the torque does not change the axis; otherwise the orientation has an error that falls as
//! the square of the legs' length. A force or torque that turns with the body is summed over the leg's rotation by
//! Gauss's rule with three points, of sixth order.

use super::free_rotation::drift;
use crate::rigid::body_state::{Momentum, Phase, RigidBodyState};
use crate::rigid::motion::kinematic::rotation_vector;
use crate::rigid::tolerances::{LEG_BALL_TURN, LEG_ERROR, OWN_FORCE_TURN, SMALL_DECAY};
use crate::rigid::{BodyDef, RigidWorld};
use glam::{DMat3, DQuat, DVec3};
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
    /// Acceleration in m/s² and torque in N m that turn with the body, along its axes.
    pub(crate) own: Option<[DVec3; 2]>,
}

/// Points and weights of Gauss's rule on [0, 1].
const GAUSS: [[f64; 2]; 3] =
    [[0.112_701_665_379_258_31, 5.0 / 18.0], [0.5, 8.0 / 18.0], [0.887_298_334_620_741_7, 5.0 / 18.0]];

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

impl Damping {
    /// What is gained within `dt` from what turns with a body: velocity and angular momentum, or, if `are_summed`, the
    /// integrals of these. The body turns freely from `turn` with `spin`.
    fn gained(&self, spec: &BodyDef, (turn, spin): (DQuat, DVec3), dt: f64, are_summed: bool) -> [DVec3; 2] {
        let Some([force, torque]) = self.own else { return [DVec3::ZERO; 2] };
        let mut sums = [DVec3::ZERO; 2];
        for [at, weight] in GAUSS {
            let (there, left) = (drift(&spec.inertia, turn, spin, at * dt).0, (1.0 - at) * dt);
            for ((sum, own), rate) in sums.iter_mut().zip([force, torque]).zip([self.linear, self.angular]) {
                let z = rate * left;
                let share = if are_summed { mean_decay(z) * left } else { math::exp(-z) };
                *sum += there * own * (weight * dt * share);
            }
        }
        sums
    }
}

impl BodyDef {
    /// Velocity and angular momentum `dt` later than `from`, of a body with this orientation all the time.
    pub(crate) fn damped(&self, damping: &Damping, from: &Momentum, turn: DQuat, dt: f64) -> Momentum {
        let [a, torque] = match damping.own {
            None => [self.gravity, damping.torque],
            Some([a, torque]) => [self.gravity + turn * a, damping.torque + turn * torque],
        };
        Momentum { v: after(from.v, a, damping.linear, dt), l: after(from.l, torque, damping.angular, dt) }
    }

    /// Velocities `dt` later of a body with orientation `r` that stays where it is. A step of lasting contact begins
    /// and ends with them.
    #[inline]
    pub(crate) fn kicked(&self, r: &DMat3, [v, w]: [DVec3; 2], dt: f64) -> (DVec3, DVec3) {
        match &self.damping {
            None => (v + self.gravity * dt, w),
            Some(damping) => {
                let [a, torque] = self.acting(damping, r);
                let gain = self.inertia.inverse(r) * torque;
                (after(v, a, damping.linear, dt), after(w, gain, damping.angular, dt))
            }
        }
    }

    /// Acceleration and torque of all that acts on it in an orientation, but for what slows it down.
    pub(crate) fn acting(&self, damping: &Damping, r: &DMat3) -> [DVec3; 2] {
        match damping.own {
            None => [self.gravity, damping.torque],
            Some([a, torque]) => [self.gravity + *r * a, damping.torque + *r * torque],
        }
    }

    /// Whether more acts on it than a constant force at its centre of gravity and what slows it down.
    pub(crate) fn is_turned(&self) -> bool {
        self.damping.is_some_and(|d| d.torque != DVec3::ZERO || d.own.is_some())
    }

    /// The strongest acceleration that its weight and what else acts on it may have together.
    pub(crate) fn strongest_pull(&self) -> f64 {
        self.gravity_magnitude + self.damping.and_then(|d| d.own).map_or(0.0, |[a, _]| a.length())
    }

    /// The work in J of all that acts on it besides its weight and what slows it down, on a way between two
    /// orientations.
    pub(crate) fn work(&self, [from, to]: [DQuat; 2], way: DVec3) -> f64 {
        let Some(damping) = &self.damping else { return 0.0 };
        let turn = rotation_vector(from, to);
        let steady = damping.torque.dot(turn);
        damping.own.map_or(steady, |[a, torque]| {
            let mean = |own: DVec3| (from * own + to * own) * 0.5;
            steady + mean(a).dot(way) * self.mass + mean(torque).dot(turn)
        })
    }

    /// How long a leg may be.
    fn leg(&self, damping: &Damping, from: &Momentum) -> f64 {
        let stray = LEG_ERROR * self.gap;
        // The third derivative of the path is at most this. A parabola through both ends strays by 2/81 of it times h³.
        let jerk = damping.linear * (self.gravity - from.v * damping.linear).length();
        let straight = math::cbrt(stray * 40.5 / jerk);
        let least = self.inertia.moments.min_element();
        let turning = (damping.torque - from.l * damping.angular).length() / least;
        let most = if self.is_ball { LEG_BALL_TURN } else { stray / self.bounding_radius };
        let short = |turning: f64| (8.0 * most / turning).sqrt();
        let Some([a, torque]) = damping.own else { return straight.min(short(turning)) };
        let turning = turning + torque.length() / least;
        let leg = straight.min(short(turning));
        // No faster than this does it turn, with a leg so short that what turns it adds no more than that.
        let fastest = from.l.length() / least;
        let leg = if turning > 0.0 { leg.min((OWN_FORCE_TURN / turning).sqrt()) } else { leg };
        let fastest = fastest + if turning > 0.0 { turning * leg } else { 0.0 };
        let jerk = jerk + fastest * a.length() + damping.linear * a.length();
        leg.min(math::cbrt(stray * 40.5 / jerk)).min(OWN_FORCE_TURN / fastest)
    }
}

impl RigidBodyState {
    /// Velocity and angular momentum `dt` after the start of a leg.
    pub(crate) fn within_leg(&self, spec: &BodyDef, dt: f64) -> Momentum {
        let Some(damping) = spec.damping.as_ref().filter(|_| dt > 0.0) else { return self.ends[0] };
        let from = &self.ends[0];
        let mut now = Momentum {
            v: after(from.v, spec.gravity, damping.linear, dt),
            l: after(from.l, damping.torque, damping.angular, dt),
        };
        if damping.own.is_some() {
            let [v, l] = damping.gained(spec, (self.turn, self.spin), dt, false);
            (now.v, now.l) = (now.v + v, now.l + l);
        }
        now
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
        let mut way = summed(from.v, spec.gravity, damping.linear, h);
        let mut turns = summed(from.l, damping.torque, damping.angular, h);
        if damping.own.is_some() {
            turns += damping.gained(spec, (body.turn, body.spin), h, true)[1];
            let spin = spec.inertia.spin(body.turn, turns / h);
            way += damping.gained(spec, (body.turn, spin), h, true)[0];
        }
        body.begin(Phase::Leg, (way / h - from.v) * (2.0 / h));
        body.ends[0] = from;
        body.spin = spec.inertia.spin(body.turn, turns / h);
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

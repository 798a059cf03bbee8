//! Resistance to rolling and to spinning: torques up to a bound.
//!
//! A contact with normal force N at distance R from the centre of gravity resists rolling, which is the part of the
//! relative angular velocity across its normal, with a torque of at most ρ N R. It resists spinning, the part along its
//! normal, with at most σ N R. The law gives ρ and σ. Without this resistance, a nudged pin would circle on the rim of
//! its foot for ever, and a lying pin would roll for ever: nothing else takes their energy.
//!
//! Between two bodies, R is the distance in the ball if one of them is a ball, otherwise the shorter of both distances;
//! the torques on both are opposite.
//!
//! On a body that turns, the torque has its bound. Where that is more than enough to stop the body, the torque is as
//! large as is needed, as friction is: it is found in rounds with the contacts' impulses. Each acts against the angular
//! velocity that the last one left. How much of it contacts brought back says how much more is needed: they make a body
//! turn with its mass at some distance.

use super::coulomb::Member;
use glam::DVec3;

/// Largest factor by which more is done than would stop the body if nothing touched it. Default 100: a cylinder that
/// rolls needs 3, a pin that turns about the line through two points of contact some tens.
const MOST_GAIN: f64 = 100.0;

/// Fraction of what is needed that may be missing. Default 1e-9: rounding.
const ROUNDING: f64 = 1e-9;

/// The resistance to a group's members.
#[derive(Debug, Default)]
pub(super) struct Brakes {
    points: Vec<Point>,
    pub(super) turns: Vec<Turn>,
}

/// The resistance at a point of contact.
#[derive(Debug)]
struct Point {
    bearing: Bearing,
    /// The angular impulse that acts on the member.
    taken: DVec3,
}

/// A point of contact that bears.
#[derive(Debug, Clone, Copy)]
pub(super) struct Bearing {
    pub(super) member: usize,
    /// The member that it touches; none if that is a fixed part.
    pub(super) other: Option<usize>,
    pub(super) normal: DVec3,
    /// The largest angular impulses in kg m²/s across the normal and along it.
    pub(super) most: [f64; 2],
}

impl Bearing {
    /// The sign with which its impulses act on a member; 0 if it does not touch that.
    fn sign(&self, member: usize) -> f64 {
        if self.member == member {
            1.0
        } else if self.other == Some(member) {
            -1.0
        } else {
            0.0
        }
    }

    fn spin(&self, members: &[Member]) -> DVec3 {
        members[self.member].w - self.other.map_or(DVec3::ZERO, |k| members[k].w)
    }

    /// The change of the relative angular velocity per angular impulse.
    fn response(&self, members: &[Member], axis: DVec3) -> DVec3 {
        let one = |k: usize| members[k].inverse_inertia * axis;
        one(self.member) + self.other.map_or(DVec3::ZERO, one)
    }

    fn push(&self, members: &mut [Member], impulse: DVec3) {
        for (k, sign) in [(Some(self.member), 1.0), (self.other, -1.0)] {
            if let Some(m) = k.map(|k| &mut members[k]) {
                m.w += m.inverse_inertia * (impulse * sign);
            }
        }
    }
}

/// How a member turns.
#[derive(Debug, Clone, Copy)]
pub(super) struct Turn {
    /// How much more is done than would stop it if nothing touched it.
    gain: f64,
    /// Its angular velocity one round ago.
    before: DVec3,
    /// Whether it may be held at rest.
    pub(super) is_held: bool,
    /// Whether the bounds allow it to be stopped.
    pub(super) may_stop: bool,
}

impl Brakes {
    /// Takes the points that bear. Returns whether there are any.
    pub(super) fn gather(&mut self, members: usize, points: impl Iterator<Item = Bearing>) -> bool {
        self.points.clear();
        self.turns.clear();
        self.points.extend(points.map(|bearing| Point { bearing, taken: DVec3::ZERO }));
        if !self.points.is_empty() {
            self.turns.resize(members, Turn { gain: 1.0, before: DVec3::ZERO, is_held: false, may_stop: false });
        }
        !self.points.is_empty()
    }

    /// Slows the members down before contacts act: by the whole bounds, or by what stops each part of a rotation. So
    /// energy only falls, and no rotation is reversed. The contacts' friction, which is found afterwards, makes the
    /// velocities of rolling bodies fit again.
    pub(super) fn slow_down(&mut self, members: &mut [Member]) {
        for Point { bearing, taken } in &mut self.points {
            for (is_along, most) in [false, true].into_iter().zip(bearing.most) {
                let spin = bearing.spin(members);
                let about = bearing.normal * spin.dot(bearing.normal);
                let part = if is_along { about } else { spin - about };
                let speed = part.length();
                if most <= 0.0 || speed <= 0.0 {
                    continue;
                }
                let axis = part / speed;
                let whole = speed / axis.dot(bearing.response(members, axis));
                let impulse = axis * -most.min(whole);
                bearing.push(members, impulse);
                *taken += impulse;
                for k in [Some(bearing.member), bearing.other].into_iter().flatten() {
                    self.turns[k].may_stop |= whole < most;
                }
            }
        }
    }

    /// Acts against the angular velocities that are left. Returns whether the bounds allow that for any member.
    pub(super) fn act(&mut self, members: &mut [Member]) -> bool {
        let mut allow = false;
        for (k, turn) in self.turns.iter_mut().enumerate() {
            let m = members[k];
            if m.w == DVec3::ZERO || !turn.is_held {
                continue;
            }
            if turn.before != DVec3::ZERO {
                let brought_back = m.w.dot(turn.before) / turn.before.length_squared();
                turn.gain = (turn.gain / (1.0 - brought_back.min(0.99))).min(MOST_GAIN);
            }
            turn.before = m.w;
            let axis = m.w.normalize();
            let whole = m.w * (-turn.gain / axis.dot(m.inverse_inertia * axis));
            let mut missing = whole;
            for Point { bearing, taken } in &mut self.points {
                let sign = bearing.sign(k);
                if sign == 0.0 {
                    continue;
                }
                let wanted = *taken + missing * sign;
                let along = wanted.dot(bearing.normal);
                let across = wanted - bearing.normal * along;
                let [most_across, most_along] = bearing.most;
                let next = bearing.normal * along.clamp(-most_along, most_along) + across.clamp_length_max(most_across);
                bearing.push(members, next - *taken);
                missing -= (next - *taken) * sign;
                *taken = next;
            }
            turn.may_stop = missing.length() <= ROUNDING * whole.length();
            allow |= turn.may_stop;
        }
        allow
    }
}

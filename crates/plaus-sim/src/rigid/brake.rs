//! Resistance to rolling and to spinning: torques up to a bound.
//!
//! A contact on a fixed part, with normal force N at distance R from the centre of gravity, resists rolling, which is
//! the part of the angular velocity across its normal, with a torque of at most ρ N R. It resists spinning, the part
//! along its normal, with at most σ N R. The law gives ρ and σ. Without this resistance, a nudged pin would circle on
//! the rim of its foot for ever, and a lying pin would roll for ever: nothing else takes their energy.
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

/// The resistance at a point on a fixed part.
#[derive(Debug)]
struct Point {
    member: usize,
    normal: DVec3,
    /// The largest angular impulses in kg m²/s across the normal and along it, and the one that acts.
    most: [f64; 2],
    taken: DVec3,
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
    /// Takes those of points: each with its member, its normal, and the largest angular impulses across the normal and
    /// along it. Returns whether there are any.
    pub(super) fn gather(&mut self, members: usize, points: impl Iterator<Item = (usize, DVec3, [f64; 2])>) -> bool {
        self.points.clear();
        self.turns.clear();
        self.points.extend(points.map(|(member, normal, most)| Point { member, normal, most, taken: DVec3::ZERO }));
        if !self.points.is_empty() {
            self.turns.resize(members, Turn { gain: 1.0, before: DVec3::ZERO, is_held: false, may_stop: false });
        }
        !self.points.is_empty()
    }

    /// Slows the members down before contacts act: by the whole bounds, or by what stops each part of a rotation. So
    /// energy only falls, and no rotation is reversed. The contacts' friction, which is found afterwards, makes the
    /// velocities of rolling bodies fit again.
    pub(super) fn slow_down(&mut self, members: &mut [Member]) {
        for p in &mut self.points {
            let m = &mut members[p.member];
            for (is_along, most) in [false, true].into_iter().zip(p.most) {
                let about = p.normal * m.w.dot(p.normal);
                let part = if is_along { about } else { m.w - about };
                let speed = part.length();
                if most <= 0.0 || speed <= 0.0 {
                    continue;
                }
                let axis = part / speed;
                let response = m.inverse_inertia * axis;
                let whole = speed / axis.dot(response);
                m.w -= response * most.min(whole);
                p.taken -= axis * most.min(whole);
                self.turns[p.member].may_stop |= whole < most;
            }
        }
    }

    /// Acts against the angular velocities that are left. Returns whether the bounds allow that for any member.
    pub(super) fn act(&mut self, members: &mut [Member]) -> bool {
        let mut allow = false;
        for (k, (m, turn)) in members.iter_mut().zip(&mut self.turns).enumerate() {
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
            for p in self.points.iter_mut().filter(|p| p.member == k) {
                let wanted = p.taken + missing;
                let along = wanted.dot(p.normal);
                let across = wanted - p.normal * along;
                let next = p.normal * along.clamp(-p.most[1], p.most[1]) + across.clamp_length_max(p.most[0]);
                m.w += m.inverse_inertia * (next - p.taken);
                missing -= next - p.taken;
                p.taken = next;
            }
            turn.may_stop = missing.length() <= ROUNDING * whole.length();
            allow |= turn.may_stop;
        }
        allow
    }
}

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

use super::Rigid;
use super::coulomb::{Contact, Member};
use super::scratch::{Place, RigidScratch};
use super::solve::{Enough, solve};
use super::touch::Touch;
use glam::DVec3;

/// Largest factor by which more is done than would stop the body if nothing touched it. Default 100: a cylinder that
/// rolls needs 3, a pin that turns about the line through two points of contact some tens.
const MOST_GAIN: f64 = 100.0;

/// Fraction of what is needed that may be missing. Default 1e-9: rounding.
const ROUNDING: f64 = 1e-9;

/// Rounds in which resistance and contacts find what stops bodies. Default 12: each leaves a tenth or so.
const ROUNDS: usize = 12;

/// Fraction of the velocity that one round may leave for the next to go on.
const LASTING: f64 = 0.9;

/// The resistance to a group's members.
#[derive(Debug, Default)]
pub(super) struct Brakes {
    points: Vec<Point>,
    turns: Vec<Turn>,
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
struct Turn {
    /// How much more is done than would stop it if nothing touched it.
    gain: f64,
    /// Its angular velocity one round ago.
    before: DVec3,
    /// Whether the bounds allow it to be stopped.
    may_stop: bool,
}

impl Brakes {
    /// Takes those of all points that bear, with `times` the present impulses. Returns whether there are any.
    pub(super) fn gather(
        &mut self,
        world: &Rigid,
        places: &[Place],
        touches: &[(usize, Touch)],
        contacts: &[Contact],
        times: f64,
    ) -> bool {
        self.points.clear();
        self.turns.clear();
        for ((k, t), c) in touches.iter().zip(contacts) {
            let torque = times * c.impulse.dot(t.normal) * t.arm.length();
            if torque <= 0.0 {
                continue;
            }
            let place = &places[*k];
            let law = world.law_at(place.body, t, place.start.x + t.arm);
            if law.rolling > 0.0 || law.spinning > 0.0 {
                let most = [law.rolling * torque, law.spinning * torque];
                self.points.push(Point { member: *k, normal: t.normal, most, taken: DVec3::ZERO });
            }
        }
        if !self.points.is_empty() {
            self.turns.resize(places.len(), Turn { gain: 1.0, before: DVec3::ZERO, may_stop: false });
        }
        !self.points.is_empty()
    }

    /// Slows the members down before contacts act: by the whole bounds, or by what stops each part of a rotation. Energy
    /// only falls, and no rotation is reversed. The contacts' friction, which is found afterwards, makes the velocities
    /// of rolling bodies fit again.
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
    fn act(&mut self, members: &mut [Member]) -> bool {
        let mut allow = false;
        for (k, (m, turn)) in members.iter_mut().zip(&mut self.turns).enumerate() {
            if m.w == DVec3::ZERO {
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

impl RigidScratch {
    /// Whether resistance to rolling and to spinning stops bodies that the contacts' impulses leave moving faster than
    /// `most`, in a kick of its own. It does not if it is too weak for the first try.
    pub(super) fn resistance_stops(&mut self, world: &Rigid, most: f64, enough: Enough, sweeps: u32) -> bool {
        if !self.rows.is_empty() || self.newton.in_rounds {
            return false;
        }
        let mut brakes = std::mem::take(&mut self.brakes);
        let are_stopped = brakes.gather(world, &self.places, &self.touches, &self.contacts, 1.0)
            && self.brake(&mut brakes, enough, sweeps, |m, _| m.fastest() <= most);
        self.brakes = brakes;
        are_stopped
    }

    /// Goes on braking members that resistance could have stopped but that contacts have set turning again, up to the
    /// bounds. If they do not come to a stop, all is left as it is.
    pub(super) fn brake_on(&mut self, most: f64, enough: Enough, sweeps: u32) {
        let mut brakes = std::mem::take(&mut self.brakes);
        let turns = |(m, t): (&Member, &Turn)| t.may_stop && m.w.length() * m.reach > most;
        if self.rows.is_empty() && !self.newton.in_rounds && self.members.iter().zip(&brakes.turns).any(turns) {
            let (members, contacts) = (self.members.clone(), self.contacts.clone());
            if !self.brake(&mut brakes, enough, sweeps, |m, t| !turns((m, t))) {
                self.members.copy_from_slice(&members);
                self.contacts.copy_from_slice(&contacts);
            }
        }
        self.brakes = brakes;
    }

    /// Brakes in rounds until all members are quiet; false if that does not come.
    fn brake(
        &mut self,
        brakes: &mut Brakes,
        enough: Enough,
        sweeps: u32,
        is_quiet: impl Fn(&Member, &Turn) -> bool,
    ) -> bool {
        let mut before = f64::INFINITY;
        for _ in 0..ROUNDS {
            if !brakes.act(&mut self.members) {
                return false;
            }
            solve(&mut self.contacts, &mut self.members, &mut self.newton, enough, sweeps);
            let both = || self.members.iter().zip(&brakes.turns);
            let left = both().filter(|(m, t)| !is_quiet(m, t)).map(|(m, _)| m.fastest()).fold(0.0, f64::max);
            if left == 0.0 {
                return true;
            }
            if left > LASTING * before {
                return false;
            }
            before = left;
        }
        false
    }
}

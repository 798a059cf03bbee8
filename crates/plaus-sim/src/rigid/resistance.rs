//! Where resistance to rolling and to spinning acts in a group's step, and whether it holds bodies at rest.

use super::Rigid;
use super::brake::{Bearing, Brakes, Turn};
use super::coulomb::{Contact, Member};
use super::rest::only_rolls;
use super::scratch::RigidScratch;
use super::solve::{Enough, solve};
use crate::Law;
use glam::DVec3;

/// Rounds in which resistance and contacts find what stops bodies. Default 12: each leaves a tenth or so.
const ROUNDS: usize = 12;

/// Fraction of the velocity that one round may leave for the next to go on.
const LASTING: f64 = 0.9;

impl RigidScratch {
    /// Slows members down by what `times` the contacts' present impulses take, before contacts act again.
    pub(super) fn slow_down(&mut self, world: &Rigid, times: f64) {
        let mut brakes = std::mem::take(&mut self.brakes);
        if self.gather_brakes(&mut brakes, world, times) {
            brakes.slow_down(&mut self.members);
        }
        self.brakes = brakes;
    }

    /// The resistance at all points that bear, with `times` their present impulses. Returns whether there is any.
    fn gather_brakes(&self, brakes: &mut Brakes, world: &Rigid, times: f64) -> bool {
        let bearing = |c: &Contact, law: &Law, arm: f64| {
            let torque = times * c.impulse.dot(c.normal) * arm;
            let most = [law.rolling * torque, law.spinning * torque];
            most.iter().any(|&most| most > 0.0).then_some(Bearing { member: c.a, other: c.b, normal: c.normal, most })
        };
        let (on_parts, rest) = self.contacts.split_at(self.touches.len());
        let presses = |c: &Contact| c.impulse.dot(c.normal) > 0.0;
        let on_parts = on_parts.iter().zip(&self.touches).filter(|(c, _)| presses(c)).filter_map(|(c, (k, t))| {
            let place = &self.places[*k];
            bearing(c, &world.law_at(place.body, t, place.start.x + t.arm), t.arm.length())
        });
        let between = rest.iter().zip(&self.pairs).filter(|(c, _)| presses(c)).filter_map(|(c, (ab, t))| {
            let both = ab.map(|k| self.places[k].body);
            let [p, q] = t.arms.map(DVec3::length);
            let arm = match both.map(|k| world.specs[k].is_ball) {
                [true, false] => p,
                [false, true] => q,
                _ => p.min(q),
            };
            bearing(c, world.pair_law(both), arm)
        });
        brakes.gather(self.places.len(), on_parts.chain(between))
    }

    /// Whether resistance to rolling and to spinning stops bodies that the contacts' impulses leave moving faster than
    /// `most`, in a kick of its own. It does not if it is too weak for the first try.
    pub(super) fn resistance_stops(&mut self, world: &Rigid, most: f64, enough: Enough, sweeps: u32) -> bool {
        if !self.rows.is_empty() || self.newton.in_rounds {
            return false;
        }
        let mut brakes = std::mem::take(&mut self.brakes);
        let any = self.gather_brakes(&mut brakes, world, 1.0);
        brakes.turns.iter_mut().for_each(|turn| turn.is_held = true);
        let are_stopped = any && self.brake(&mut brakes, enough, sweeps, |m, _| m.fastest() <= most);
        self.brakes = brakes;
        are_stopped
    }

    /// Goes on braking members that can only roll, and that resistance could have stopped but contacts have set turning
    /// again, up to the bounds. Where these are too small to stop them, they turn on, slower; if any should turn faster
    /// or the other way, all is left as it is.
    pub(super) fn brake_on(&mut self, world: &Rigid, most: f64, enough: Enough, sweeps: u32) {
        let mut brakes = std::mem::take(&mut self.brakes);
        for (k, turn) in brakes.turns.iter_mut().enumerate().filter(|(_, turn)| turn.may_stop) {
            turn.is_held = !world.specs[self.places[k].body].is_driven() && only_rolls(world, self, k);
        }
        let turns = |(m, t): (&Member, &Turn)| t.is_held && t.may_stop && t.resisted(m.w).length() * m.reach > most;
        if self.rows.is_empty() && !self.newton.in_rounds && self.members.iter().zip(&brakes.turns).any(turns) {
            let (members, contacts) = (self.members.clone(), self.contacts.clone());
            let is_stopped = self.brake(&mut brakes, enough, sweeps, |m, t| !turns((m, t)));
            let slows = |((now, before), t): ((&Member, &Member), &Turn)| {
                let [now, before] = [now, before].map(|m| t.resisted(m.w));
                !t.is_held || (now.dot(before) >= 0.0 && now.length() <= before.length())
            };
            if !is_stopped && !self.members.iter().zip(&members).zip(&brakes.turns).all(slows) {
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
            let is_enough = brakes.act(&mut self.members);
            solve(&mut self.contacts, &mut self.members, &mut self.newton, enough, sweeps);
            if !is_enough {
                return false;
            }
            let both = || self.members.iter().zip(&brakes.turns);
            let fastest = |(m, t): (&Member, &Turn)| m.v.length().max(t.resisted(m.w).length() * m.reach);
            let left = both().filter(|(m, t)| !is_quiet(m, t)).map(fastest).fold(0.0, f64::max);
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

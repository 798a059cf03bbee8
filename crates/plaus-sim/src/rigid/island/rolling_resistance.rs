//! Where resistance to rolling and to spinning acts in an island's step, and whether it holds bodies at rest.

use super::sleep::only_rolls;
use crate::Law;
use crate::rigid::RigidWorld;
use crate::rigid::scratch::RigidScratch;
use crate::rigid::solver::contact_constraint::{ContactConstraint, SolverBody};
use crate::rigid::solver::rolling_resistance::{ResistedBody, RollingContact, RollingResistance};
use crate::rigid::solver::{SolverTolerance, solve};
use crate::rigid::tolerances::{RESISTANCE_PROGRESS, RESISTANCE_ROUNDS};
use glam::DVec3;

impl RigidWorld {
    /// The arm of resistance to rolling where two bodies touch: that of a ball, if only one of them is.
    pub(super) fn resisted_arm(&self, both: [usize; 2], arms: &[DVec3; 2]) -> f64 {
        let [p, q] = arms.map(DVec3::length);
        match both.map(|k| self.specs[k].is_ball) {
            [true, false] => p,
            [false, true] => q,
            _ => p.min(q),
        }
    }
}

impl RigidScratch {
    /// Slows members down by what `times` the contacts' present impulses take, before contacts act again.
    pub(crate) fn slow_down(&mut self, world: &RigidWorld, times: f64) {
        let mut resistance = std::mem::take(&mut self.resistance);
        if self.gather_resistance(&mut resistance, world, times) {
            resistance.slow_down(&mut self.members);
        }
        self.resistance = resistance;
    }

    /// The resistance at all points that bear, with `times` their present impulses. Returns whether there is any.
    fn gather_resistance(&self, resistance: &mut RollingResistance, world: &RigidWorld, times: f64) -> bool {
        let contact = |c: &ContactConstraint, law: &Law, arm: f64| {
            let torque = times * c.impulse.dot(c.normal) * arm;
            let most = [law.rolling * torque, law.spinning * torque];
            most.iter().any(|&most| most > 0.0).then_some(RollingContact {
                member: c.a,
                other: c.b,
                normal: c.normal,
                most,
            })
        };
        let (on_parts, rest) = self.contacts.split_at(self.touches.len());
        let presses = |c: &ContactConstraint| c.impulse.dot(c.normal) > 0.0;
        let on_parts = on_parts.iter().zip(&self.touches).filter(|(c, _)| presses(c)).filter_map(|(c, (k, t))| {
            let place = &self.places[*k];
            contact(c, &world.law_at(place.body, t, place.start.x + t.arm), t.arm.length())
        });
        let between = rest.iter().zip(&self.pairs).filter(|(c, _)| presses(c)).filter_map(|(c, (ab, t))| {
            let both = ab.map(|k| self.places[k].body);
            contact(c, world.pair_law(both), world.resisted_arm(both, &t.arms))
        });
        resistance.gather(self.places.len(), on_parts.chain(between))
    }

    /// Whether resistance to rolling and to spinning stops bodies that the contacts' impulses leave moving faster than
    /// `most`, in a kick of its own. It does not if it is too weak for the first try.
    pub(super) fn resistance_stops(
        &mut self,
        world: &RigidWorld,
        most: f64,
        enough: SolverTolerance,
        sweeps: u32,
    ) -> bool {
        if !self.rows.is_empty() || self.newton.in_rounds {
            return false;
        }
        let mut resistance = std::mem::take(&mut self.resistance);
        let any = self.gather_resistance(&mut resistance, world, 1.0);
        resistance.turns.iter_mut().for_each(|turn| turn.is_held = true);
        let are_stopped = any && self.resist_in_rounds(&mut resistance, enough, sweeps, |m, _| m.fastest() <= most);
        self.resistance = resistance;
        are_stopped
    }

    /// Goes on braking members that can only roll, and that resistance could have stopped but contacts have set turning
    /// again, up to the bounds. Where these are too small to stop them, they turn on, slower; if any should turn faster
    /// or the other way, all is left as it is.
    pub(super) fn resist(&mut self, world: &RigidWorld, most: f64, enough: SolverTolerance, sweeps: u32) {
        let mut resistance = std::mem::take(&mut self.resistance);
        for (k, turn) in resistance.turns.iter_mut().enumerate().filter(|(_, turn)| turn.may_stop) {
            turn.is_held = !world.specs[self.places[k].body].is_driven() && only_rolls(world, self, k);
        }
        let turns = |(m, t): (&SolverBody, &ResistedBody)| {
            t.is_held && t.may_stop && t.resisted(m.w).length() * m.bounding_radius > most
        };
        if self.rows.is_empty() && !self.newton.in_rounds && self.members.iter().zip(&resistance.turns).any(turns) {
            let (members, contacts) = (self.members.clone(), self.contacts.clone());
            let is_stopped = self.resist_in_rounds(&mut resistance, enough, sweeps, |m, t| !turns((m, t)));
            let slows = |((now, before), t): ((&SolverBody, &SolverBody), &ResistedBody)| {
                let [now, before] = [now, before].map(|m| t.resisted(m.w));
                !t.is_held || (now.dot(before) >= 0.0 && now.length() <= before.length())
            };
            if !is_stopped && !self.members.iter().zip(&members).zip(&resistance.turns).all(slows) {
                self.members.copy_from_slice(&members);
                self.contacts.copy_from_slice(&contacts);
            }
        }
        self.resistance = resistance;
    }

    /// Brakes in rounds until all members are quiet; false if that does not come.
    fn resist_in_rounds(
        &mut self,
        resistance: &mut RollingResistance,
        enough: SolverTolerance,
        sweeps: u32,
        is_quiet: impl Fn(&SolverBody, &ResistedBody) -> bool,
    ) -> bool {
        let mut before = f64::INFINITY;
        for _ in 0..RESISTANCE_ROUNDS {
            let is_enough = resistance.act(&mut self.members);
            solve(&mut self.contacts, &mut self.members, &mut self.newton, enough, sweeps);
            if !is_enough {
                return false;
            }
            let both = || self.members.iter().zip(&resistance.turns);
            let fastest =
                |(m, t): (&SolverBody, &ResistedBody)| m.v.length().max(t.resisted(m.w).length() * m.bounding_radius);
            let left = both().filter(|(m, t)| !is_quiet(m, t)).map(fastest).fold(0.0, f64::max);
            if left == 0.0 {
                return true;
            }
            if left > RESISTANCE_PROGRESS * before {
                return false;
            }
            before = left;
        }
        false
    }
}

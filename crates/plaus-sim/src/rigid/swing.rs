//! Bodies on joints that nothing else touches: several steps in one, of fourth order.
//!
//! A step of lasting contact is symmetric in time and of second order. Five of them, four forward and one back, are of
//! fourth order (Suzuki, Phys. Lett. A 146 (1990)): the errors of third order in the five lengths cancel. The way back
//! is calculated but never taken: bodies drift along one straight line, with one free rotation, from where the five
//! begin to where they end.

use super::body::{Pose, Turning};
use super::drive::between;
use super::joint::{FIXED, Part};
use super::scratch::{Place, RigidScratch};
use super::tumble::drift;
use super::{Rigid, Spec};
use glam::{DQuat, DVec3};

/// Lengths of the five steps over the whole: `1/(4 − ∛4)` four times, and the rest.
const PARTS: [f64; 5] = [LONG, LONG, 1.0 - 4.0 * LONG, LONG, LONG];
const LONG: f64 = 0.414_490_771_794_375_74;

/// Rounds of finding the spin of a free rotation: each leaves about the angle of the rotation of the error.
const ROUNDS: usize = 12;

/// Error of a rotation, in radians, that counts as none.
const TURNED: f64 = 1e-15;

impl RigidScratch {
    /// Whether joints alone act on a group, without friction: fourth order then pays.
    fn only_swings(&self, world: &Rigid) -> bool {
        let is_free = |p: &Place| !world.specs[p.body].is_driven() && world.specs[p.body].drag.is_none();
        !self.rows.is_empty()
            && self.touches.is_empty()
            && self.leaving.is_empty()
            && self.pairs.is_empty()
            && self.parting.is_empty()
            && self.rows.iter().all(|row| matches!(row.part, Part::Point(_)))
            && self.places.iter().all(is_free)
    }

    /// Takes a step of `h` seconds in five, if joints alone act and no limit is passed; returns whether it did.
    pub(super) fn swing(&mut self, world: &Rigid, bodies: &mut [Turning], h: f64) -> bool {
        if !self.only_swings(world) {
            return false;
        }
        self.push = 1.0;
        let begins: Vec<(Pose, DQuat)> = self.places.iter().map(|p| (p.start, p.turn)).collect();
        let mut passed = vec![DVec3::ZERO; self.rows.len()];
        for part in PARTS {
            let step = self.drift(world, h * part);
            self.second_kick(world, &step);
            for (passed, (first, second)) in passed.iter_mut().zip(self.firsts.iter().zip(&self.contacts)) {
                *passed += first.impulse + second.impulse;
            }
            for (p, m) in self.places.iter_mut().zip(&self.members) {
                (p.start, p.turn) = (Pose { v: m.v, w: m.w, ..p.end }, p.end_turn);
            }
        }
        let is_within = self.stops.iter().all(|row| {
            let Part::Stop { is_high } = row.part else { return true };
            let at = |k: usize| &self.places[k].end;
            world.joints.bonds[row.joint].room(is_high, [at(row.a), row.b.map_or(&FIXED, at)]) >= 0.0
        });
        for (p, (start, turn)) in self.places.iter_mut().zip(begins) {
            (p.start, p.turn) = (start, turn);
            p.end.v = (p.end.x - start.x) / h;
            p.spin = spin_between(&world.specs[p.body], [turn, p.end_turn], h);
        }
        if !is_within {
            return false;
        }
        for ((first, second), passed) in self.firsts.iter_mut().zip(&mut self.contacts).zip(passed) {
            (first.impulse, second.impulse) = (DVec3::ZERO, passed);
        }
        self.write(world, bodies, h);
        true
    }
}

/// Angular velocity at the start of the free rotation that leads from one orientation to another within `h` seconds.
fn spin_between(spec: &Spec, [from, to]: [DQuat; 2], h: f64) -> DVec3 {
    let mut spin = between(from, to) / h;
    for _ in 0..ROUNDS {
        let missing = between(drift(&spec.inertia, from, spin, h).0, to);
        spin += missing / h;
        if missing.length_squared() <= TURNED * TURNED {
            break;
        }
    }
    spin
}

//! Bodies on joints that nothing else touches: several steps in one, of fourth order.
//!
//! A step of lasting contact is symmetric in time and of second order. Five of them, four forward and one back, are of
//! fourth order (Suzuki, Phys. Lett. A 146 (1990)): the errors of third order in the five lengths cancel. The way back
//! is calculated but never taken: bodies drift along one straight line, with one free rotation, from where the five
//! begin to where they end.

use super::joint::JointRowKind;
use crate::rigid::body_state::{Pose, RigidBodyState};
use crate::rigid::motion::free_rotation::drift;
use crate::rigid::motion::kinematic::rotation_vector;
use crate::rigid::scratch::{RigidScratch, StepPoses};
use crate::rigid::tolerances::{JOINT_GAP, SUZUKI_JOINT_GAP, SUZUKI_SPIN_ROUNDS, SUZUKI_TURN_ERROR};
use crate::rigid::{BodyDef, RigidWorld};
use glam::{DQuat, DVec3};

/// Lengths of the five steps over the whole: `1/(4 − ∛4)` four times, and the rest.
const PARTS: [f64; 5] = [LONG, LONG, 1.0 - 4.0 * LONG, LONG, LONG];
const LONG: f64 = 0.414_490_771_794_375_74;

impl RigidScratch {
    /// Whether joints alone act on an island, without friction or limits: fourth order then pays.
    fn only_joints_act(&self, world: &RigidWorld) -> bool {
        let is_free = |p: &StepPoses| !world.specs[p.body].is_driven() && world.specs[p.body].damping.is_none();
        !self.rows.is_empty()
            && self.touches.is_empty()
            && self.leaving.is_empty()
            && self.pairs.is_empty()
            && self.parting.is_empty()
            && self.stops.is_empty()
            && self.rows.iter().all(|row| matches!(row.part, JointRowKind::Point(_)))
            && self.places.iter().all(is_free)
    }

    /// Takes a step of `h` seconds in five, if joints alone act; returns whether it did.
    pub(crate) fn suzuki_step(&mut self, world: &RigidWorld, bodies: &mut [RigidBodyState], h: f64) -> bool {
        if !self.only_joints_act(world) {
            return false;
        }
        (self.push, self.closed) = (1.0, SUZUKI_JOINT_GAP * JOINT_GAP);
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
        for (p, (start, turn)) in self.places.iter_mut().zip(begins) {
            (p.start, p.turn) = (start, turn);
            p.end.v = (p.end.x - start.x) / h;
            p.spin = spin_between(&world.specs[p.body], [turn, p.end_turn], h);
        }
        for ((first, second), passed) in self.firsts.iter_mut().zip(&mut self.contacts).zip(passed) {
            (first.impulse, second.impulse) = (DVec3::ZERO, passed);
        }
        self.write(world, bodies, h);
        true
    }
}

/// Angular velocity at the start of the free rotation that leads from one orientation to another within `h` seconds.
pub(crate) fn spin_between(spec: &BodyDef, [from, to]: [DQuat; 2], h: f64) -> DVec3 {
    let mut spin = rotation_vector(from, to) / h;
    for _ in 0..SUZUKI_SPIN_ROUNDS {
        let missing = rotation_vector(drift(&spec.inertia, from, spin, h).0, to);
        spin += missing / h;
        if missing.length_squared() <= SUZUKI_TURN_ERROR * SUZUKI_TURN_ERROR {
            break;
        }
    }
    spin
}

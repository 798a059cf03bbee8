//! How much energy the steps of lasting contact may keep.
//!
//! Contact must not gain energy. What a step's error adds is taken back.

use crate::rigid::joints::joint::{JointRow, JointRowKind, Side};
use crate::rigid::scratch::{RigidScratch, StepPoses};
use crate::rigid::solver::contact_constraint::ContactConstraint;
use crate::rigid::solver::{SolverTolerance, solve};
use crate::rigid::tolerances::{
    ENERGY_ERROR, ENERGY_OVERSHOOT, ENERGY_ROUNDS, FIRST_ENERGY_PART, KEPT_GAP, MAX_ENERGY_PART, STRING_GAIN,
};
use crate::rigid::{BodyDef, RigidWorld};
use glam::{DQuat, DVec3};

impl RigidScratch {
    /// Whether a step was so long that keeping its points out of the ground lifted bodies higher than their energy
    /// allows: for example a pin that rocks over the rim of its foot. A shorter step must then see where it touches.
    pub(super) fn climbs(&self, world: &RigidWorld) -> Option<f64> {
        (!self.is_open(world) && self.energy_to_keep(world) < 0.0).then_some(0.5)
    }

    /// Takes back the energy that a step's error has added. It acts along the first kick's impulses: a part `α` of them
    /// is moved to the second kick, where the contacts return what they need. No other momentum is touched, and
    /// impulses stay in their cones. `firsts` are the contacts with the impulses of the first kick; they keep the
    /// remaining part. Energy that cannot be taken back in this way is left. Returns whether all was taken back.
    pub(super) fn project_energy(
        &mut self,
        world: &RigidWorld,
        firsts: &mut [ContactConstraint],
        enough: SolverTolerance,
    ) -> bool {
        if self.is_open(world) {
            return !self.strings_give(world);
        }
        let allowed = self.energy_to_keep(world) + ENERGY_ERROR * self.weight_times_gap(world);
        let mut over = self.kinetic(world) - allowed;
        if over <= 0.0 || firsts.iter().all(|c| c.impulse == DVec3::ZERO) {
            return true;
        }
        let (members, contacts) = (self.members.clone(), self.contacts.clone());
        let (mut last, mut part) = (0.0, FIRST_ENERGY_PART);
        for _ in 0..ENERGY_ROUNDS {
            self.members.copy_from_slice(&members);
            self.contacts.copy_from_slice(&contacts);
            for (c, first) in self.contacts.iter_mut().zip(&*firsts) {
                first.push(&mut self.members, first.impulse * -part);
                if c.target > -f64::MAX {
                    c.impulse += first.impulse * part;
                    c.push(&mut self.members, first.impulse * part);
                }
            }
            solve(&mut self.contacts, &mut self.members, &mut self.newton, enough, world.accuracy.sweeps);
            let now = self.kinetic(world) - allowed;
            if now <= 0.0 {
                for first in firsts {
                    first.impulse *= 1.0 - part;
                }
                return true;
            }
            // A little farther than the chord says, because the result should lie below.
            let next = part - now * (part - last) / (now - over) * ENERGY_OVERSHOOT;
            (last, over) = (part, now);
            if !next.is_finite() || next.abs() > MAX_ENERGY_PART {
                break;
            }
            part = next;
        }
        self.members.copy_from_slice(&members);
        self.contacts.copy_from_slice(&contacts);
        false
    }

    /// Whether a step of bodies on strings adds so much energy that it must have been too long: beyond the end of a
    /// drum, the direction of a string may turn faster than a step sees.
    fn strings_give(&self, world: &RigidWorld) -> bool {
        let is_string = |row: &JointRow| matches!(row.part, JointRowKind::Stop(Side::Length { .. }));
        let has_energy = |row: &JointRow| matches!(row.part, JointRowKind::Motor | JointRowKind::Spring);
        let specs = || self.places.iter().map(|p| &world.specs[p.body]);
        if !self.rows.iter().any(is_string) || self.rows.iter().any(has_energy) || specs().any(BodyDef::is_driven) {
            return false;
        }
        let kept = self.energy_to_keep(world);
        let usual: f64 = specs().map(|spec| spec.mass * spec.speed * spec.speed).sum();
        self.kinetic(world) - kept > STRING_GAIN * kept.max(usual)
    }

    /// Whether the energy that a step adds is no more than lifting its bodies out of each other and out of the ground
    /// needs.
    pub(super) fn only_lifts(&self, world: &RigidWorld) -> bool {
        let fixed = self.touches.iter().map(|(k, t)| KEPT_GAP * world.specs[self.places[*k].body].gap - t.gap);
        let pairs = self.pairs.iter().map(|(ab, t)| KEPT_GAP * world.pair_gap(ab.map(|k| self.places[k].body)) - t.gap);
        let way = fixed.chain(pairs).fold(0.0, f64::max);
        let weight: f64 = self.places.iter().map(|p| world.specs[p.body].mass * world.gravity_magnitude).sum();
        self.kinetic(world) - self.energy_to_keep(world) <= way * weight
    }

    /// Whether a step makes bodies no faster; it may have lifted them.
    pub(super) fn only_rises(&self, world: &RigidWorld) -> bool {
        let start = |p: &StepPoses| kinetic(&world.specs[p.body], p.turn, p.start.v, p.start.w);
        let before: f64 = self.places.iter().map(start).sum();
        self.kinetic(world) <= before + ENERGY_ERROR * self.weight_times_gap(world)
    }

    fn kinetic(&self, world: &RigidWorld) -> f64 {
        let both = self.places.iter().zip(&self.members);
        both.map(|(p, m)| kinetic(&world.specs[p.body], p.end_turn, m.v, m.w)).sum()
    }

    fn weight_times_gap(&self, world: &RigidWorld) -> f64 {
        let spec = |p: &StepPoses| &world.specs[p.body];
        self.places.iter().map(|p| spec(p).mass * world.gravity_magnitude * spec(p).gap).sum()
    }

    /// Kinetic energy that remains after the drift of a step; negative if the drift lifted bodies higher than their
    /// energy allows.
    fn energy_to_keep(&self, world: &RigidWorld) -> f64 {
        let left = |p: &StepPoses| {
            let spec = &world.specs[p.body];
            let lifts = spec.mass * spec.gravity.dot(p.end.x - p.start.x);
            let work = spec.work([p.turn, p.end_turn], p.end.x - p.start.x);
            kinetic(spec, p.turn, p.start.v, p.start.w) + lifts + work
        };
        self.places.iter().map(left).sum()
    }
}

fn kinetic(spec: &BodyDef, turn: DQuat, v: DVec3, w: DVec3) -> f64 {
    0.5 * (spec.mass * v.length_squared() + w.dot(spec.inertia.momentum(turn, w)))
}

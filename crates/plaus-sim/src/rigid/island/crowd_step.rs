//! A step of a crowd: points are looked for once, then bodies move in substeps.
//!
//! Points are measured once, at the start, and within the step carried along: a point moves with the body that has it,
//! a normal with the body whose face it is (`crowd_points.rs`). A substep kicks the bodies, finds the impulses with
//! which no point ends the drift nearer than the gap that it keeps (speculative contacts), and lets them drift. Kicks
//! are half as long before the first drift and after the last, so the steps are of second order in smooth motion. The
//! impulses are those of Moreau's time stepping: a point that is struck parts in the next solve at its restitution
//! times its approach (Newton's rule), and impulses lie in Coulomb's cones. They are found in rounds over rows in a
//! flat array, in the order of height, warm-started by the last ones, within the preset's tolerance of the kick or a
//! part of its number of rounds, which carries loads through all levels; all of it where bodies are slow enough to be
//! tested for rest. Overlaps are undone by shifts of the bodies, which change no momentum. Source: Macklin et al.,
//! "Small steps in physics simulation" (2019).
//!
//! What rounds leave, the next substep measures. Two things keep this from doing harm. Warm-started impulses that are
//! not exact act as springs: they would lift a stack that they first let sink. So only as much of them is given as
//! makes no energy (`Nncg::give_passively`). And where these rounds are too few (`Newton::is_demanding`), or a step has
//! more energy after it than before but for the lift out of overlaps, the step is left to the caller.
//!
//! A step ends early where bodies have strayed from the paths on which their points were looked for.

use super::crowd::{Crowd, CrowdPoint};
use super::sleep::is_slow;
use crate::rigid::body_state::Pose;
use crate::rigid::motion::free_rotation::{drift_little, drift_within, rotation};
use crate::rigid::motion::kinematic::rotation_vector;
use crate::rigid::scratch::{RigidScratch, StepPoses};
use crate::rigid::solver::contact_constraint::{ContactConstraint, SolverBody, response};
use crate::rigid::solver::nncg::NncgContact;
use crate::rigid::tolerances::{
    CROWD_PROJECTIONS, CROWD_REACH, CROWD_ROUNDS, CROWD_SUBSTEP, ENERGY_ERROR, GAP_ERROR, INACTIVE_BIAS,
    PIVOT_SPIN_ROUNDS, PROJECTED, SLEEP_PATIENCE, WARM_START_OF_NNCG,
};
use crate::rigid::{BodyDef, RigidWorld};
use glam::{DMat3, DVec3};

impl RigidScratch {
    /// Finds the next step of a crowd, of at most `h` seconds. Returns its length, unless it has to be found exactly.
    pub(super) fn find_crowd_step(&mut self, world: &RigidWorld, h: f64) -> Option<f64> {
        let mut crowd = std::mem::take(&mut self.crowd);
        let found = crowd.find(self, world, h);
        self.crowd = crowd;
        found
    }

    /// What rounding may add to the energy in a step, in J.
    fn energy_error(&self, world: &RigidWorld) -> f64 {
        let weight = |p: &StepPoses| {
            let spec = &world.specs[p.body];
            spec.mass * spec.gravity_magnitude * spec.gap
        };
        ENERGY_ERROR * self.places.iter().map(weight).sum::<f64>()
    }

    /// Leaves the step of `h` seconds that was found where it is written from.
    pub(super) fn take_crowd_step(&mut self, h: f64) {
        let crowd = std::mem::take(&mut self.crowd);
        self.members.clone_from(&crowd.members);
        let nothing = ContactConstraint::told(0, None, [DVec3::ZERO; 2], DVec3::Z, DVec3::ZERO);
        for list in [&mut self.contacts, &mut self.firsts] {
            list.clear();
            list.resize(crowd.points.len(), nothing);
        }
        self.strikes.clear();
        self.strikes.resize(crowd.points.len(), None);
        for (p, &row) in crowd.points.iter().zip(&crowd.rows) {
            let c = &crowd.rounds.rows[row];
            // The force at the end is the first guess of the next step.
            let last = p.force * (0.5 * h);
            self.firsts[p.number] = ContactConstraint::told(p.a, p.b, p.arms, p.normal, p.total - last);
            self.contacts[p.number] = ContactConstraint::told(p.a, p.b, c.arms, c.normal, last);
            self.strikes[p.number] = p.strike;
        }
        self.crowd = crowd;
    }

    /// The force at a point in the last step, if it is known.
    fn load(&self, number: usize) -> Option<DVec3> {
        let loads = [&self.loads, &self.pair_loads];
        let (of, at) = number.checked_sub(self.touches.len()).map_or((0, number), |at| (1, at));
        loads[of].get(at).copied().flatten()
    }
}

impl Crowd {
    fn find(&mut self, scratch: &mut RigidScratch, world: &RigidWorld, h: f64) -> Option<f64> {
        self.list(scratch, world);
        if scratch.newton.is_demanding {
            return None;
        }
        let sweeps = world.accuracy.sweeps;
        // Bodies that are about to rest come out of all overlaps, and stop.
        self.most = if is_slow(world, scratch) {
            [sweeps, SLEEP_PATIENCE * CROWD_PROJECTIONS]
        } else {
            let carrying = scratch.rounds_for_height(&world.accuracy);
            [sweeps.div_ceil(CROWD_ROUNDS).max(carrying).min(sweeps), CROWD_PROJECTIONS]
        };
        let unit = scratch.places.iter().map(|p| {
            let spec = &world.specs[p.body];
            (spec.size / world.gravity_magnitude).sqrt().min(1.0 / p.start.w.length())
        });
        let unit = world.accuracy.step * unit.fold(f64::INFINITY, f64::min);
        self.enough = world.accuracy.sweep_tolerance * world.gravity_magnitude;
        let count = (h / (CROWD_SUBSTEP * unit)).ceil().max(1.0);
        let part = h / count;
        let before: f64 = scratch.places.iter().map(|p| energy(world, p, &p.start, p.turn)).sum();
        self.start(scratch, world, part);
        let (mut done, mut last) = (0.0, part);
        while done < count {
            let kick = if done == 0.0 { 0.5 * part } else { part };
            self.kick(scratch, world, [kick, last], Some(part), done * part);
            last = kick;
            self.drift(scratch, world, part);
            done += 1.0;
            if self.strays(scratch, world, part, done * part) {
                break;
            }
        }
        let h = part * done;
        self.kick(scratch, world, [0.5 * part, last], None, h);
        self.finish(scratch, world, h);
        self.fastest = self.members.iter().map(SolverBody::fastest).fold(0.0, f64::max);
        let both = scratch.places.iter().zip(&self.members);
        let after: f64 = both.map(|(p, m)| energy(world, p, &Pose { v: m.v, w: m.w, ..p.end }, p.end_turn)).sum();
        let allowed = before + self.lifted + scratch.energy_error(world);
        (after <= allowed).then_some(h)
    }

    /// Takes the bodies at their starts, and rows for all points, whose impulses are those of the last step within
    /// `h` seconds.
    fn start(&mut self, scratch: &mut RigidScratch, world: &RigidWorld, h: f64) {
        self.members.clear();
        let at_start = |p: &StepPoses| SolverBody::of(&world.specs[p.body], &p.start.r, p.start.v, p.start.w);
        self.members.extend(scratch.places.iter().map(at_start));
        self.rounds.movers.take(&self.members);
        self.lifted = 0.0;
        self.strayed.clear();
        self.strayed.resize(self.members.len(), 0.0);
        self.turned.clear();
        self.turned.resize(self.members.len(), DMat3::IDENTITY);
        for p in &mut scratch.places {
            (p.end, p.end_turn) = (p.start, p.turn);
        }
        self.rounds.rows.clear();
        self.rows.clear();
        for k in 0..self.points.len() {
            let p = self.points[k];
            let mut row = self.row(&p);
            row.impulse = scratch.load(p.number).map_or(DVec3::ZERO, |force| force * h);
            self.points[k].bore = row.impulse != DVec3::ZERO;
            self.rows.push(self.rounds.rows.len());
            self.rounds.rows.push(row);
            if let Some(most) = p.resists {
                let k = |k: usize| self.members[k].inverse_inertia;
                let response = k(p.a) + p.b.map_or(DMat3::ZERO, k);
                self.rounds.rows.push(row.resistance(most, 0.0, &response));
            }
        }
    }

    /// A kick of `kick` seconds of what acts freely, and impulses with which no point ends a drift of `drift` seconds
    /// too near; with no drift, no point that touches then approaches. `last` is the length of the last kick, and
    /// `time` that since the start.
    fn kick(
        &mut self,
        scratch: &RigidScratch,
        world: &RigidWorld,
        [kick, last]: [f64; 2],
        drift: Option<f64>,
        time: f64,
    ) {
        self.rounds.movers.take(&self.members);
        for (p, &row) in self.points.iter_mut().zip(&self.rows) {
            let row = &mut self.rounds.rows[row];
            let u = row.velocity(&self.rounds.movers);
            p.approach = -u.dot(row.normal);
            if p.frictions[1] > p.frictions[0] {
                let slip = u + row.normal * p.approach;
                let sticks = slip.length() <= p.still || slip.dot(p.slip) < 0.0;
                (row.friction, p.slip) = (p.frictions[usize::from(sticks)], slip);
            }
        }
        for (m, p) in self.members.iter_mut().zip(&scratch.places) {
            (m.v, m.w) = world.specs[p.body].kicked(&p.end.r, [m.v, m.w], kick);
        }
        self.rounds.movers.take(&self.members);
        for (p, &number) in self.points.iter().zip(&self.rows) {
            let row = &mut self.rounds.rows[number];
            row.bias = match drift {
                _ if p.rebound > 0.0 => row.normal * -p.rebound,
                Some(h) => row.normal * ((p.now - p.kept).max(0.0) / h),
                None if p.now <= p.near || p.bore => DVec3::ZERO,
                None => row.normal * INACTIVE_BIAS,
            };
            row.impulse = if p.rebound > 0.0 { DVec3::ZERO } else { row.impulse * (WARM_START_OF_NNCG * kick / last) };
            row.push(&mut self.rounds.movers, row.impulse);
            if p.resists.is_some() {
                self.rounds.rows[number + 1].impulse = DVec3::ZERO;
            }
        }
        self.rounds.run(self.enough * kick, self.most[0]);
        self.rounds.give_passively(&mut self.members);
        for (p, &row) in self.points.iter_mut().zip(&self.rows) {
            p.take(self.rounds.rows[row].impulse, kick, time);
        }
    }

    /// The drift of a substep of `h` seconds; what overlaps then is moved apart.
    fn drift(&mut self, scratch: &mut RigidScratch, world: &RigidWorld, h: f64) {
        for (p, m) in scratch.places.iter_mut().zip(&mut self.members) {
            let spec = &world.specs[p.body];
            let l = spec.inertia.momentum(p.end_turn, m.w);
            p.end_turn = drift_little(&spec.inertia, p.end_turn, m.w, h, spec.turn_error);
            p.end.x += m.v * h;
            turn_to(spec, p, m, l);
        }
        self.place(scratch, world);
        if !self.points.iter().any(|p| p.now < p.kept - GAP_ERROR * p.near) {
            return;
        }
        self.project(h);
        for ((p, m), [shift, turn, passed]) in scratch.places.iter_mut().zip(&mut self.members).zip(&self.shifts) {
            let spec = &world.specs[p.body];
            let l = spec.inertia.momentum(p.end_turn, m.w) + *passed;
            p.end.x += *shift;
            self.lifted -= spec.mass * spec.gravity.dot(*shift);
            p.end_turn = (rotation(*turn) * p.end_turn).normalize();
            turn_to(spec, p, m, l);
        }
        self.place(scratch, world);
    }

    /// Finds shifts with which points come nearer to the gaps that they keep, no faster than they may be pushed.
    fn project(&mut self, h: f64) {
        self.pushes.clear();
        self.pushes.resize(self.points.len(), 0.0);
        self.shifts.clear();
        self.shifts.resize(self.members.len(), [DVec3::ZERO; 3]);
        for _ in 0..self.most[1] {
            let mut is_close = true;
            for ((p, &row), sum) in self.points.iter().zip(&self.rows).zip(&mut self.pushes) {
                let row = &self.rounds.rows[row];
                let at = |[shift, turn, _]: &[DVec3; 3], arm: DVec3| (*shift + turn.cross(arm)).dot(row.normal);
                let apart = at(&self.shifts[p.a], row.arms[0]) - p.b.map_or(0.0, |b| at(&self.shifts[b], row.arms[1]));
                let wanted = (p.kept - p.now).min(p.push * h) - apart;
                let next = (*sum + wanted * row.gain_along()).max(0.0);
                let change = next - std::mem::replace(sum, next);
                is_close &= change.abs() <= PROJECTED * p.near * row.gain_along();
                let push = row.normal * change;
                if push == DVec3::ZERO {
                    continue;
                }
                for (k, arm, push) in [(Some(p.a), row.arms[0], push), (p.b, row.arms[1], -push)] {
                    if let Some(k) = k {
                        let m = &self.members[k];
                        self.shifts[k][0] += push * m.inverse_mass;
                        self.shifts[k][1] += m.inverse_inertia * arm.cross(push);
                    }
                }
            }
            if is_close {
                break;
            }
        }
        // Shifts of two bodies that pass each other change their angular momentum, which their spins make up for.
        for ((p, &row), sum) in self.points.iter().zip(&self.rows).zip(&self.pushes) {
            if let Some(b) = p.b.filter(|_| *sum > 0.0) {
                let rate = self.members[p.a].v - self.members[b].v;
                let half = rate.cross(self.rounds.rows[row].normal) * (0.5 * sum);
                [p.a, b].into_iter().for_each(|k| self.shifts[k][2] += half);
            }
        }
    }

    /// Where the points are now.
    fn place(&mut self, scratch: &RigidScratch, world: &RigidWorld) {
        for (turned, p) in self.turned.iter_mut().zip(&scratch.places) {
            *turned = p.end.r * p.start.r.transpose();
        }
        for k in 0..self.points.len() {
            let (p, number) = (self.points[k], self.rows[k]);
            let now = self.carry(scratch, world, &p);
            let row = &mut self.rounds.rows[number];
            row.impulse = turned(row.impulse, row.normal, now.normal);
            if let Some(strike) = &mut self.points[k].strike {
                strike.impulse = turned(strike.impulse, row.normal, now.normal);
            }
            row.lean -= now.normal * row.lean.dot(now.normal);
            (row.arms, row.normal) = (now.arms, now.normal);
            self.points[k].now = now.gap;
        }
    }

    /// Whether bodies have strayed so far that points may be missing from the list.
    fn strays(&mut self, scratch: &RigidScratch, world: &RigidWorld, h: f64, time: f64) -> bool {
        // A pair is looked for within a part of its smaller size.
        let smallest = scratch.places.iter().map(|p| world.specs[p.body].size).fold(f64::INFINITY, f64::min);
        let mut is_far = false;
        for ((far, p), m) in self.strayed.iter_mut().zip(&scratch.places).zip(&self.members) {
            let spec = &world.specs[p.body];
            // Whether it falls or is held, it was seen.
            let gained = m.v - p.start.v;
            let fell = (gained.dot(spec.gravity) / spec.gravity.length_squared()).clamp(0.0, time);
            *far += ((gained - spec.gravity * fell).length() + (m.w - p.start.w).length() * spec.bounding_radius) * h;
            is_far |= *far > 0.5 * CROWD_REACH * smallest;
        }
        is_far
    }

    /// What the whole step of `h` seconds comes to: a drift that ends where the last substep did.
    fn finish(&mut self, scratch: &mut RigidScratch, world: &RigidWorld, h: f64) {
        for p in &mut scratch.places {
            let spec = &world.specs[p.body];
            p.end.v = (p.end.x - p.start.x) / h;
            p.spin = rotation_vector(p.turn, p.end_turn) / h;
            for _ in 0..if spec.anisotropy == 0.0 { 0 } else { PIVOT_SPIN_ROUNDS } {
                let (turn, _) = drift_within(&spec.inertia, p.turn, p.spin, h, spec.turn_error);
                let left = rotation_vector(turn, p.end_turn);
                if left.length() <= spec.turn_error {
                    break;
                }
                p.spin += left / h;
            }
        }
    }

    /// The row of a point at the start of the step.
    fn row(&self, p: &CrowdPoint) -> NncgContact {
        let k = |k: usize, arm: DVec3| {
            let m = &self.members[k];
            response(m.inverse_mass, &m.inverse_inertia, arm)
        };
        let response = p.b.map_or(k(p.a, p.arms[0]), |b| k(p.a, p.arms[0]) + k(b, p.arms[1]));
        NncgContact::new([Some(p.a), p.b], p.arms, p.normal, p.frictions[0], &response)
    }
}

/// Takes a body's new orientation, with this angular momentum.
fn turn_to(spec: &BodyDef, p: &mut StepPoses, m: &mut SolverBody, l: DVec3) {
    p.end.r = DMat3::from_quat(p.end_turn);
    m.w = spec.inertia.spin(p.end_turn, l);
    m.inverse_inertia = spec.inertia.inverse(&p.end.r);
}

/// An impulse that turns with its normal, and stays in its cone.
pub(super) fn turned(impulse: DVec3, before: DVec3, now: DVec3) -> DVec3 {
    let load = impulse.dot(before);
    let across = impulse - before * load;
    now * load + (across - now * across.dot(now))
}

/// Kinetic energy, and that of height, less the work from the start of what else acts.
fn energy(world: &RigidWorld, p: &StepPoses, pose: &Pose, turn: glam::DQuat) -> f64 {
    let spec = &world.specs[p.body];
    let kinetic = 0.5 * (spec.mass * pose.v.length_squared() + pose.w.dot(spec.inertia.momentum(turn, pose.w)));
    let way = pose.x - p.start.x;
    kinetic - spec.mass * spec.gravity.dot(way) - spec.work([p.turn, turn], way)
}

//! A step of a crowd: one detection, one solve for where bodies go, one for the velocities at the end.
//!
//! Points are measured once, at the start, and between there and the end of the step only carried along: a point moves
//! with the body that has it, a normal with the body whose face it is. The first solve finds the impulses of the first
//! kick, with which no point ends the drift nearer than the gap that lasting contacts keep; overlaps are undone at a
//! limited speed. The second finds those of the second kick, with which no point approaches, and a struck one parts at
//! its restitution times its approach. What pushed bodies out of an overlap is taken back then. Both are rounds over
//! rows in a flat array, in the order of height, which does not depend on how bodies are listed; both start from the
//! last impulses and end by the residual or by the preset's number. What they leave, the next step measures.
//!
//! Energy does not grow. If the second kick left too much, the same kick is found without restitution and with all the
//! first kick's impulses taken back as far as contacts do not need them: a plastic impact, after which there is less.
//! Between the two lies a mixture that has the energy allowed, as kinetic energy is convex, and that lies in Coulomb's
//! cones, as these are. Where the drift has lifted bodies higher than their energy allows, all impulses act at the
//! start, plastic ([`plastic`](Crowd::plastic)): `E' − E = −Σ m |v' − v|²/2 + Σ p · u' ≤ 0`.

use super::contacts;
use crate::rigid::body_state::Pose;
use crate::rigid::narrow_phase::contact_id::ContactId;
use crate::rigid::narrow_phase::contact_point::{ContactPoint, PairContactPoint, to_middle};
use crate::rigid::scratch::{RigidScratch, StepPoses};
use crate::rigid::solver::contact_constraint::{ContactConstraint, SolverBody, response};
use crate::rigid::solver::nncg::{Nncg, NncgContact};
use crate::rigid::static_shape::StaticShape;
use crate::rigid::tolerances::{
    CROWD_DEPTH, CROWD_REST_ROUNDS, ENERGY_ERROR, INACTIVE_BIAS, KEPT_GAP, NNCG_ACCURACY, PUSH_OUT_SPEED,
    WARM_START_OF_NNCG,
};
use crate::rigid::{BodyDef, RigidWorld};
use crate::scenery::Surface;
use crate::shape::On;
use crate::shape::convex_pair::Mark;
use crate::shape::hull_pair::Feature;
use crate::shape::piece::Core;
use glam::{DMat3, DVec3};

/// With what a normal turns.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Carrier {
    /// A fixed part.
    Fixed,
    First,
    Second,
    /// The mean of both bodies.
    Both,
    /// It is measured anew: a round skin touches with another point.
    Skin,
}

/// A point of contact in a step.
#[derive(Debug, Clone, Copy)]
struct CrowdPoint {
    /// Its number among the touches, then among the pairs.
    number: usize,
    height: f64,
    a: usize,
    b: Option<usize>,
    carrier: Carrier,
    /// To the point half way between the skins, and how far the first body's skin is from the point that it carries.
    arms: [DVec3; 2],
    rounding: f64,
    normal: DVec3,
    gap: f64,
    /// The gap that it keeps, and the one up to which it touches, in m.
    kept: f64,
    near: f64,
    /// Speed in m/s at which it is pushed out of an overlap at most.
    push: f64,
    friction: f64,
    /// Torques along the normal and across it, over the load.
    resists: Option<[f64; 2]>,
    rebound: f64,
    /// The impulse of the first kick, and its normal.
    first: DVec3,
    /// Whether it is pushed out of an overlap.
    is_pushed: bool,
}

/// A point at the end of a drift.
struct Carried {
    arms: [DVec3; 2],
    normal: DVec3,
    gap: f64,
    /// The mean velocity over the drift: along the normal that of the gap, across it that of the slip.
    mean: DVec3,
}

/// Work space of a crowd's step.
#[derive(Debug, Default)]
pub(crate) struct Crowd {
    points: Vec<CrowdPoint>,
    rounds: Nncg,
    /// Rows of the points, in their order: each may be followed by one of resistance.
    rows: Vec<usize>,
    members: Vec<SolverBody>,
    saved: Vec<[DVec3; 2]>,
    impulses: Vec<DVec3>,
    turned: Vec<DMat3>,
    /// Change of velocity per second of the step at which rounds end.
    enough: f64,
    /// The largest speed of any body's point at the end of the step, in m/s.
    pub(super) fastest: f64,
}

/// How deep points may be half way through a step, over the size: a hundredth of what the preset's gap allows, in a
/// geometric mean with the size.
fn depth(world: &RigidWorld) -> f64 {
    CROWD_DEPTH * world.accuracy.gap.sqrt()
}

impl RigidScratch {
    /// Finds the next step of a crowd, of at most `h` seconds; returns its length.
    pub(super) fn find_crowd_step(&mut self, world: &RigidWorld, h: f64, is_slow: bool) -> f64 {
        let mut crowd = std::mem::take(&mut self.crowd);
        crowd.list(self, world);
        // Bodies that are about to rest must first come out of their overlaps.
        let part = if is_slow { NNCG_ACCURACY } else { 1.0 };
        crowd.enough = part * world.accuracy.sweep_tolerance * world.gravity_magnitude;
        let h = h.min(crowd.straight(self, world));
        crowd.drift(self, world, h);
        let before: f64 = self.places.iter().map(|p| energy(world, p, &p.start, p.turn)).sum();
        let mut allowed = before + self.energy_error(world, h);
        if is_slow && self.has_faces_in_touch() {
            // Bodies may be lifted out of each other if none of them gets faster by it.
            let high = |p: &StepPoses| energy(world, p, &Pose { v: DVec3::ZERO, w: DVec3::ZERO, ..p.end }, p.end_turn);
            allowed += self.places.iter().map(high).sum::<f64>().max(0.0);
        }
        if !crowd.kick(self, world, h, allowed) {
            crowd.plastic(self, world, h);
        }
        crowd.fastest = crowd.members.iter().map(SolverBody::fastest).fold(0.0, f64::max);
        self.crowd = crowd;
        h
    }

    /// Energy that a step may add: rounding, and what the rounds leave of velocities.
    fn energy_error(&self, world: &RigidWorld, h: f64) -> f64 {
        let left = world.accuracy.sweep_tolerance * world.gravity_magnitude * h;
        let error = |p: &StepPoses| {
            let spec = &world.specs[p.body];
            spec.mass * (ENERGY_ERROR * spec.gravity_magnitude * spec.gap + left * left)
        };
        self.places.iter().map(error).sum()
    }

    /// Whether contacts can hold a crowd at rest: impulses that obey the law leave no body faster than `most` after a
    /// kick of `h` seconds from its present velocities.
    pub(super) fn crowd_rests(&mut self, world: &RigidWorld, h: f64, most: f64) -> bool {
        if self.has_faces_in_touch() && self.least_gap(world) < 0.0 || super::sleep::is_deep(world, self) {
            return false;
        }
        let mut crowd = std::mem::take(&mut self.crowd);
        let rests = crowd.rests(self, world, h, most);
        if rests {
            self.firsts.clear();
            let nothing = ContactConstraint::told(0, None, [DVec3::ZERO; 2], DVec3::Z, DVec3::ZERO);
            self.firsts.resize(crowd.points.len(), nothing);
            for (p, &row) in crowd.points.iter().zip(&crowd.rows) {
                let impulse = crowd.rounds.rows[row].impulse;
                self.firsts[p.number] = ContactConstraint::told(p.a, p.b, p.arms, p.normal, impulse);
            }
            self.contacts.clone_from(&self.firsts);
        }
        self.crowd = crowd;
        rests
    }

    /// Leaves the step that was found where it is written from.
    pub(super) fn take_crowd_step(&mut self) {
        let crowd = std::mem::take(&mut self.crowd);
        self.members.clone_from(&crowd.members);
        let nothing = ContactConstraint::told(0, None, [DVec3::ZERO; 2], DVec3::Z, DVec3::ZERO);
        for list in [&mut self.contacts, &mut self.firsts] {
            list.clear();
            list.resize(crowd.points.len(), nothing);
        }
        for ((p, &row), &second) in crowd.points.iter().zip(&crowd.rows).zip(&crowd.impulses) {
            let c = &crowd.rounds.rows[row];
            self.firsts[p.number] = ContactConstraint::told(p.a, p.b, p.arms, p.normal, p.first);
            self.contacts[p.number] = ContactConstraint::told(p.a, p.b, c.arms, c.normal, second);
        }
        self.crowd = crowd;
    }
}

impl Crowd {
    /// Lists the points by height.
    fn list(&mut self, scratch: &RigidScratch, world: &RigidWorld) {
        self.points.clear();
        let up = -world.gravity;
        let push = PUSH_OUT_SPEED * world.accuracy.settle;
        for (number, (k, t)) in scratch.touches.iter().enumerate() {
            let (p, spec) = (&scratch.places[*k], &world.specs[scratch.places[*k].body]);
            let law = world.law_at(p.body, t, p.start.x + t.arm);
            let parts = -p.start.velocity(t.arm).dot(t.normal) * law.restitution;
            let arm = t.arm.length();
            let (carrier, rounding) = world.carrier_of_touch(p.body, t);
            self.points.push(CrowdPoint {
                number,
                height: up.dot(p.start.x + t.arm),
                a: *k,
                b: None,
                carrier,
                arms: [t.arm, DVec3::ZERO],
                rounding,
                normal: t.normal,
                gap: t.gap,
                kept: KEPT_GAP * spec.gap,
                near: contacts::crowd_margin(spec.gap, spec.size),
                push: push * spec.speed,
                friction: law.friction,
                resists: resists([law.spinning, law.rolling], arm),
                rebound: if parts > world.settle_speed(spec, &law) { parts } else { 0.0 },
                first: DVec3::ZERO,
                is_pushed: false,
            });
        }
        for (number, (ab, t)) in (scratch.touches.len()..).zip(&scratch.pairs) {
            let [p, q] = ab.map(|k| &scratch.places[k]);
            let both = [p.body, q.body];
            let (law, gap) = (world.pair_law(both), world.pair_gap(both));
            let parts = -t.rate(&p.start, &q.start) * law.restitution;
            let [arm, other] = t.arms.map(DVec3::length);
            let arm = match both.map(|k| world.specs[k].is_ball) {
                [true, false] => arm,
                [false, true] => other,
                _ => arm.min(other),
            };
            self.points.push(CrowdPoint {
                number,
                height: up.dot(p.start.x + t.arms[0]),
                a: ab[0],
                b: Some(ab[1]),
                carrier: world.carrier_of_pair(both, t),
                arms: to_middle(t.arms, [p.start.x, q.start.x]),
                rounding: 0.0,
                normal: t.normal,
                gap: t.gap,
                kept: KEPT_GAP * gap,
                near: contacts::crowd_margin(
                    gap,
                    both.map(|k| world.specs[k].size).iter().copied().fold(f64::INFINITY, f64::min),
                ),
                push: push * world.specs[p.body].speed.min(world.specs[q.body].speed),
                friction: law.friction,
                resists: resists([law.spinning, law.rolling], arm),
                rebound: if parts > world.pair_settle_speed(both) { parts } else { 0.0 },
                first: DVec3::ZERO,
                is_pushed: false,
            });
        }
        self.points.sort_unstable_by(|p, q| p.height.total_cmp(&q.height).then(p.number.cmp(&q.number)));
    }

    /// The longest step in s in which the gaps of points that touch stray from straight lines by no more than they may.
    fn straight(&self, scratch: &RigidScratch, world: &RigidWorld) -> f64 {
        let mut most = f64::INFINITY;
        for p in
            self.points.iter().filter(|p| p.gap <= depth(world) * scratch.size(world, p) && p.carrier != Carrier::Skin)
        {
            let bend = |k: usize, arm: DVec3| {
                let w = scratch.places[k].start.w;
                w.cross(w.cross(arm))
            };
            let bend = bend(p.a, p.arms[0]) - p.b.map_or(DVec3::ZERO, |b| bend(b, p.arms[1]));
            // A parabola through both ends strays by an eighth half way.
            most = most.min(8.0 * depth(world) * scratch.size(world, p) / bend.dot(p.normal).abs());
        }
        most.sqrt()
    }

    /// The first kick and the drift.
    fn drift(&mut self, scratch: &mut RigidScratch, world: &RigidWorld, h: f64) {
        self.begin(scratch, world, |spec, p| p.kicked(spec, h, 0.5));
        self.rounds.rows.clear();
        self.rows.clear();
        let part = WARM_START_OF_NNCG * 0.5 * h;
        for k in 0..self.points.len() {
            let p = self.points[k];
            let mut row = self.row(&p);
            if let Some(force) = scratch.load(p.number) {
                row.impulse = force * part;
                row.begin(&mut self.rounds.movers);
            }
            self.rows.push(self.rounds.rows.len());
            self.rounds.rows.push(row);
        }
        self.go(scratch, world, h);
        for k in 0..self.points.len() {
            let (p, row) = (self.points[k], self.rows[k]);
            let now = self.rounds.rows[row].velocity(&self.rounds.movers);
            let mean = self.carry(scratch, world, &p, h).mean;
            let target = ((p.kept - p.gap) / h).min(p.push);
            // The weight of the second kick takes a slower push away again.
            self.points[k].is_pushed = target > 0.5 * world.gravity_magnitude * h;
            self.rounds.rows[row].bias = mean - now - p.normal * target;
        }
        self.rounds.run(self.enough * h, world.accuracy.sweeps);
        for (p, &row) in self.points.iter_mut().zip(&self.rows) {
            p.first = self.rounds.rows[row].impulse;
        }
        self.go(scratch, world, h);
    }

    /// Moves bodies on with the velocities that they have in the rounds.
    fn go(&mut self, scratch: &mut RigidScratch, world: &RigidWorld, h: f64) {
        self.rounds.movers.give(&mut self.members);
        self.turned.clear();
        for (p, m) in scratch.places.iter_mut().zip(&self.members) {
            let spec = &world.specs[p.body];
            p.spin = m.w;
            (p.end, p.end_turn) = p.drifted_within(spec, [m.v, m.w], h, spec.turn_error);
            self.turned.push(p.end.r * p.start.r.transpose());
        }
    }

    /// Where a point is at the end of the drift.
    fn carry(&self, scratch: &RigidScratch, world: &RigidWorld, p: &CrowdPoint, h: f64) -> Carried {
        let a = &scratch.places[p.a];
        let b = p.b.map(|b| &scratch.places[b]);
        if p.carrier == Carrier::Skin {
            let (begin, end) = (a.begin(), a.end);
            return match (b, scratch.touches.get(p.number)) {
                (Some(b), _) => {
                    let (both, t) = ([a.body, b.body], &scratch.pairs[p.number - scratch.touches.len()].1);
                    let after = world.pair_again(both, [&end, &b.end], t);
                    let mean = t.mean_velocity(&after, &[begin, b.begin()], &[end, b.end], h);
                    let arms = to_middle(after.arms, [end.x, b.end.x]);
                    Carried { arms, normal: after.normal, gap: after.gap, mean }
                }
                (None, Some((_, t))) => {
                    let after = world.touch(a.body, &end, t.surface);
                    let mean = t.mean_velocity(&after, world.fixed_sphere(a.body, t), [&begin, &end], h);
                    Carried { arms: [after.arm, DVec3::ZERO], normal: after.normal, gap: after.gap, mean }
                }
                (None, None) => Carried { arms: p.arms, normal: p.normal, gap: p.gap, mean: begin.velocity(p.arms[0]) },
            };
        }
        let (turn, other) = (&self.turned[p.a], p.b.map(|b| &self.turned[b]));
        let n = match (p.carrier, other) {
            (Carrier::First, _) => *turn * p.normal,
            (Carrier::Second, Some(other)) => *other * p.normal,
            (Carrier::Both, other) => {
                (*turn * p.normal + other.map_or(p.normal, |other| *other * p.normal)).normalize()
            }
            _ => p.normal,
        };
        let centre = p.arms[0] + p.normal * p.rounding;
        let mut arms = [*turn * centre - n * p.rounding, other.map_or(DVec3::ZERO, |other| *other * p.arms[1])];
        let mut moved = a.end.x - a.start.x + arms[0] - p.arms[0];
        let at_start = |p: &StepPoses, arm: DVec3| p.end.v + p.spin.cross(arm);
        let mut slip = at_start(a, p.arms[0]) + a.end.velocity(arms[0]);
        if let Some(b) = b {
            moved -= b.end.x - b.start.x + arms[1] - p.arms[1];
            slip -= at_start(b, p.arms[1]) + b.end.velocity(arms[1]);
            // Both bodies are pushed at one point: that of the body whose corner it is.
            let apart = (a.end.x + arms[0]) - (b.end.x + arms[1]);
            match p.carrier {
                Carrier::Second => arms[1] += apart,
                Carrier::First => arms[0] -= apart,
                _ => (arms[0], arms[1]) = (arms[0] - apart * 0.5, arms[1] + apart * 0.5),
            }
        }
        let gap = p.gap + moved.dot(n);
        let slip = slip * 0.5;
        let mean = slip + p.normal * ((gap - p.gap) / h - slip.dot(p.normal));
        Carried { arms, normal: n, gap, mean }
    }

    /// The second kick. Returns whether the energy is at most `allowed`.
    fn kick(&mut self, scratch: &RigidScratch, world: &RigidWorld, h: f64, allowed: f64) -> bool {
        for (m, p) in self.members.iter_mut().zip(&scratch.places) {
            let spec = &world.specs[p.body];
            let (v, w) = p.kicked_again(spec, h);
            *m = SolverBody::of(spec, &p.end.r, v, w);
        }
        self.rounds.movers.take(&self.members);
        let firsts = std::mem::take(&mut self.rounds.rows);
        for k in 0..self.points.len() {
            let p = self.points[k];
            let end = self.carry(scratch, world, &p, h);
            let mut row = firsts[self.rows[k]];
            let friction = row.friction_at_edge();
            (row.arms, row.normal) = (end.arms, end.normal);
            row.lean -= end.normal * row.lean.dot(end.normal);
            self.rows[k] = self.rounds.rows.len();
            if p.first == DVec3::ZERO && end.gap > p.near {
                row.bias = end.normal * INACTIVE_BIAS;
                self.rounds.rows.push(row);
                continue;
            }
            let slip = friction.map(|across| end.normal * across.dot(end.normal) - across);
            row.held_slip = slip.and_then(DVec3::try_normalize);
            row.bias = end.normal * if p.first == DVec3::ZERO { 0.0 } else { -p.rebound };
            row.begin(&mut self.rounds.movers);
            let mut load = p.first.dot(p.normal);
            if p.is_pushed {
                // All of its impulse counts here: what has only pushed is taken back.
                row.impulse += p.first;
                (self.points[k].first, load) = (DVec3::ZERO, 0.0);
            }
            self.rounds.rows.push(row);
            if let Some(most) = p.resists {
                let k = |k: usize| self.members[k].inverse_inertia;
                let response = k(p.a) + p.b.map_or(DMat3::ZERO, k);
                self.rounds.rows.push(row.resistance(most, load, &response));
            }
        }
        self.rounds.run(self.enough * h, world.accuracy.sweeps);
        self.rounds.movers.give(&mut self.members);
        self.impulses.clear();
        self.impulses.extend(self.rows.iter().map(|&row| self.rounds.rows[row].impulse));
        let now = self.energy_at_end(scratch, world);
        now <= allowed || self.lose(scratch, world, h, [now, allowed])
    }

    /// Finds the plastic second kick, and mixes it into the one found so far until the energy is what is allowed.
    /// Returns whether that is enough.
    fn lose(&mut self, scratch: &RigidScratch, world: &RigidWorld, h: f64, [now, allowed]: [f64; 2]) -> bool {
        for (p, &row) in self.points.iter().zip(&self.rows) {
            let row = &mut self.rounds.rows[row];
            if p.first != DVec3::ZERO || p.is_pushed {
                row.impulse += p.first;
                row.bias = DVec3::ZERO;
            }
            row.held_slip = None;
        }
        self.saved.clear();
        self.saved.extend(self.members.iter().map(|m| [m.v, m.w]));
        self.rounds.run(self.enough * h, world.accuracy.sweeps);
        self.rounds.movers.give(&mut self.members);
        let least = self.energy_at_end(scratch, world);
        if least > allowed {
            return false;
        }
        let part = (now - allowed) / (now - least);
        for (m, [v, w]) in self.members.iter_mut().zip(&self.saved) {
            (m.v, m.w) = (v.lerp(m.v, part), w.lerp(m.w, part));
        }
        let plastic = self.points.iter().zip(&self.rows).map(|(p, &row)| self.rounds.rows[row].impulse - p.first);
        for (second, plastic) in self.impulses.iter_mut().zip(plastic) {
            *second = second.lerp(plastic, part);
        }
        true
    }

    /// Whether contacts that touch can hold the bodies ([`RigidScratch::crowd_rests`]).
    fn rests(&mut self, scratch: &RigidScratch, world: &RigidWorld, h: f64, most: f64) -> bool {
        self.begin(scratch, world, |spec, p| spec.kicked(&p.start.r, [p.start.v, p.start.w], h));
        self.rounds.rows.clear();
        for k in 0..self.points.len() {
            let p = self.points[k];
            let mut row = self.row(&p);
            self.rows[k] = self.rounds.rows.len();
            if p.gap > p.near {
                row.bias = p.normal * INACTIVE_BIAS;
                self.rounds.rows.push(row);
                continue;
            }
            row.impulse = scratch.load(p.number).unwrap_or(DVec3::ZERO) * h;
            row.begin(&mut self.rounds.movers);
            self.rounds.rows.push(row);
            if let Some(most) = p.resists {
                let k = |k: usize| self.members[k].inverse_inertia;
                let response = k(p.a) + p.b.map_or(DMat3::ZERO, k);
                self.rounds.rows.push(row.resistance(most, 0.0, &response));
            }
        }
        self.rounds.run(NNCG_ACCURACY * most, CROWD_REST_ROUNDS * world.accuracy.sweeps);
        self.rounds.movers.give(&mut self.members);
        self.members.iter().all(|m| m.fastest() <= most)
    }

    /// Takes the bodies at their starts, with these velocities.
    fn begin(
        &mut self,
        scratch: &RigidScratch,
        world: &RigidWorld,
        kicked: impl Fn(&BodyDef, &StepPoses) -> (DVec3, DVec3),
    ) {
        self.members.clear();
        self.members.extend(scratch.places.iter().map(|p| {
            let spec = &world.specs[p.body];
            let (v, w) = kicked(spec, p);
            SolverBody::of(spec, &p.start.r, v, w)
        }));
        self.rounds.movers.take(&self.members);
    }

    /// The row of a point at the start of the step.
    fn row(&self, p: &CrowdPoint) -> NncgContact {
        let k = |k: usize, arm: DVec3| {
            let m = &self.members[k];
            response(m.inverse_mass, &m.inverse_inertia, arm)
        };
        let response = p.b.map_or(k(p.a, p.arms[0]), |b| k(p.a, p.arms[0]) + k(b, p.arms[1]));
        NncgContact::new([Some(p.a), p.b], p.arms, p.normal, p.friction, &response)
    }

    /// A step whose impulses all act at its start, plastic and without any push, wherever the drift then leads.
    fn plastic(&mut self, scratch: &mut RigidScratch, world: &RigidWorld, h: f64) {
        self.begin(scratch, world, |spec, p| p.kicked(spec, h, 1.0));
        self.rounds.rows.clear();
        for k in 0..self.points.len() {
            let p = self.points[k];
            let mut row = self.row(&p);
            row.bias = p.normal * (p.gap.max(0.0) / h);
            self.rows[k] = k;
            self.rounds.rows.push(row);
        }
        self.rounds.run(self.enough * h, world.accuracy.sweeps);
        self.go(scratch, world, h);
        for (m, p) in self.members.iter_mut().zip(&scratch.places) {
            m.w = p.end.w;
        }
        // To whoever interrupts the step it is two equal kicks.
        self.impulses.clear();
        for (p, &row) in self.points.iter_mut().zip(&self.rows) {
            p.first = self.rounds.rows[row].impulse * 0.5;
            self.impulses.push(p.first);
        }
    }

    fn energy_at_end(&self, scratch: &RigidScratch, world: &RigidWorld) -> f64 {
        let both = scratch.places.iter().zip(&self.members);
        both.map(|(p, m)| energy(world, p, &Pose { v: m.v, w: m.w, ..p.end }, p.end_turn)).sum()
    }
}

impl RigidScratch {
    /// The force at a point in the last step, if it is known.
    fn load(&self, number: usize) -> Option<DVec3> {
        let loads = [&self.loads, &self.pair_loads];
        let (of, at) = number.checked_sub(self.touches.len()).map_or((0, number), |at| (1, at));
        loads[of].get(at).copied().flatten()
    }

    fn size(&self, world: &RigidWorld, p: &CrowdPoint) -> f64 {
        let size = |k: usize| world.specs[self.places[k].body].size;
        p.b.map_or(size(p.a), |b| size(p.a).min(size(b)))
    }
}

impl RigidWorld {
    /// With what the normal of a touch turns, and how far the skin is from the point that the body carries.
    fn carrier_of_touch(&self, body: usize, t: &ContactPoint) -> (Carrier, f64) {
        match t.surface {
            Surface::Spot { piece, point, .. } if !self.specs[body].is_ball => {
                let id = ContactId::of_surface(piece, point);
                let own = &self.specs[body].pieces[usize::from(id.own)];
                let carrier = match id.mark {
                    Mark::Polyhedra(feature) => carrier(feature, Carrier::Fixed),
                    Mark::Over { .. } if matches!(own.core, Core::Polyhedron(_)) => Carrier::Fixed,
                    _ => Carrier::Skin,
                };
                (carrier, if carrier == Carrier::Fixed { own.rounding } else { 0.0 })
            }
            _ => match (&self.parts[usize::from(t.part)], self.fixed_sphere(body, t)) {
                (StaticShape::Plane(_), Some(sphere)) => (Carrier::Fixed, sphere.radius),
                _ => (Carrier::Skin, 0.0),
            },
        }
    }

    fn carrier_of_pair(&self, both: [usize; 2], t: &PairContactPoint) -> Carrier {
        match t.id {
            Some(ContactId { mark: Mark::Polyhedra(feature), .. }) if !both.iter().any(|&k| self.specs[k].is_ball) => {
                carrier(feature, Carrier::Second)
            }
            _ => Carrier::Skin,
        }
    }
}

/// With what the normal of two polyhedra turns, of which the second is, or is carried by, `second`.
fn carrier(feature: Feature, second: Carrier) -> Carrier {
    match feature {
        Feature::Corner { of: 0, on: On::Face(_), .. } => second,
        Feature::Corner { of: 1, on: On::Face(_), .. } => Carrier::First,
        _ => Carrier::Both,
    }
}

fn resists([spinning, rolling]: [f64; 2], arm: f64) -> Option<[f64; 2]> {
    (spinning > 0.0 || rolling > 0.0).then_some([spinning * arm, rolling * arm])
}

/// Kinetic energy, and that of height, and of a torque over the turn from the start.
fn energy(world: &RigidWorld, p: &StepPoses, pose: &Pose, turn: glam::DQuat) -> f64 {
    let spec = &world.specs[p.body];
    let kinetic = 0.5 * (spec.mass * pose.v.length_squared() + pose.w.dot(spec.inertia.momentum(turn, pose.w)));
    let torque = match spec.damping {
        Some(_) => spec.torque().dot(crate::rigid::motion::kinematic::rotation_vector(p.turn, turn)),
        None => 0.0,
    };
    kinetic - spec.mass * spec.gravity.dot(pose.x - p.start.x) - torque
}

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

use crate::rigid::body_state::Pose;
use crate::rigid::motion::free_rotation::{drift_within, rotation};
use crate::rigid::motion::kinematic::rotation_vector;
use crate::rigid::narrow_phase::contact_id::ContactId;
use crate::rigid::narrow_phase::contact_point::{ContactPoint, PairContactPoint, to_middle};
use crate::rigid::scratch::{RigidScratch, StepPoses};
use crate::rigid::solver::contact_constraint::{ContactConstraint, SolverBody, response};
use crate::rigid::solver::nncg::{Nncg, NncgContact};
use crate::rigid::static_shape::StaticShape;
use crate::rigid::tolerances::{
    CONTACT_MARGIN, CROWD_REST_ROUNDS, INACTIVE_BIAS, KEPT_GAP, NNCG_ACCURACY, PUSH_OUT_SPEED, WARM_START_OF_NNCG,
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
    restitution: f64,
    /// Speed in m/s up to which a rebound lasts.
    settles: f64,
    /// The gap now.
    now: f64,
    /// The speed in m/s at which it came near at the start of this substep, and whether it bore load before.
    approach: f64,
    bore: bool,
    /// Speed at which it parts in the next solve, in m/s.
    rebound: f64,
    /// When it was first struck, in s from the start, and at which speed in m/s.
    strike: Option<(f64, f64)>,
    /// Its impulse in N s, and the force in the last substep in N.
    total: DVec3,
    force: DVec3,
}

const NEW_POINT: CrowdPoint = CrowdPoint {
    number: 0,
    height: 0.0,
    a: 0,
    b: None,
    carrier: Carrier::Fixed,
    arms: [DVec3::ZERO; 2],
    rounding: 0.0,
    normal: DVec3::Z,
    gap: 0.0,
    kept: 0.0,
    near: 0.0,
    push: 0.0,
    friction: 0.0,
    resists: None,
    restitution: 0.0,
    settles: 0.0,
    now: 0.0,
    approach: 0.0,
    bore: false,
    rebound: 0.0,
    strike: None,
    total: DVec3::ZERO,
    force: DVec3::ZERO,
};

/// Where a point is now.
struct Carried {
    arms: [DVec3; 2],
    normal: DVec3,
    gap: f64,
}

/// Work space of a crowd's step.
#[derive(Debug, Default)]
pub(crate) struct Crowd {
    points: Vec<CrowdPoint>,
    rounds: Nncg,
    /// Rows of the points, in their order: each may be followed by one of resistance.
    rows: Vec<usize>,
    members: Vec<SolverBody>,
    turned: Vec<DMat3>,
    /// How overlaps move bodies: the shift and the turn of each, and the impulse of each point, in kg m.
    shifts: Vec<[DVec3; 2]>,
    pushes: Vec<f64>,
    /// How far each body has strayed from the path that it was seen on when points were listed, in m.
    strayed: Vec<f64>,
    /// Change of velocity per second of the step at which rounds end.
    enough: f64,
    /// Whether all solves of the step have converged.
    is_solved: bool,
    /// The largest speed of any body's point at the end of the step, in m/s.
    pub(super) fastest: f64,
}

pub(crate) fn knob(name: &str, default: f64) -> f64 {
    std::env::var(name).ok().and_then(|s| s.parse().ok()).unwrap_or(default)
}

impl RigidScratch {
    /// Finds the next step of a crowd, of at most `h` seconds; returns its length.
    pub(super) fn find_crowd_step(&mut self, world: &RigidWorld, h: f64, is_slow: bool) -> Option<f64> {
        let mut crowd = std::mem::take(&mut self.crowd);
        crowd.list(self, world);
        crowd.is_solved = true;
        let unit = self.places.iter().map(|p| {
            let spec = &world.specs[p.body];
            (spec.size / world.gravity_magnitude).sqrt().min(1.0 / p.start.w.length())
        });
        let shortest = knob("SUB", 0.0625) * world.accuracy.step * unit.fold(f64::INFINITY, f64::min);
        let count = (h / shortest).ceil().max(1.0);
        let part = h / count;
        crowd.enough = world.accuracy.sweep_tolerance * world.gravity_magnitude * shortest;
        let before: f64 = self.places.iter().map(|p| energy(world, p, &p.start, p.turn)).sum();
        crowd.start(self, world, part);
        let mut done = 0.0;
        let mut last = part;
        while done < count {
            let kick = if done == 0.0 { 0.5 * part } else { part };
            crowd.kick(self, world, [kick, last], Some(part), done * part);
            last = kick;
            crowd.drift(self, world, part);
            done += 1.0;
            if knob("MUST", 1.0) > 0.0 && !crowd.is_solved {
                break;
            }
            if crowd.strays(self, world, part, done * part) {
                break;
            }
        }
        let h = part * done;
        crowd.kick(self, world, [0.5 * part, last], None, h);
        crowd.finish(self, world, h);
        let after: f64 = (self.places.iter().zip(&crowd.members))
            .map(|(p, m)| energy(world, p, &Pose { v: m.v, w: m.w, ..p.end }, p.end_turn)).sum();
        let weight: f64 = self.places.iter().map(|p| { let spec = &world.specs[p.body]; spec.mass * spec.gravity_magnitude * spec.size }).sum();
        crowd.fastest = crowd.members.iter().map(SolverBody::fastest).fold(0.0, f64::max);
        self.crowd = crowd;
        let _ = is_slow;
        let allowed = knob("ALLOWED", 1e-3) * weight;
        if knob("TELL", 0.0) > 0.0 {
            eprintln!("slow {is_slow} h {h:.2e} {done}/{count} solved {} energy {:.2e} fastest {:.2e}", self.crowd.is_solved, (after - before) / weight, self.crowd.fastest);
        }
        (knob("MUST", 1.0) == 0.0 || self.crowd.is_solved && after <= before + allowed).then_some(h)
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
                near: CONTACT_MARGIN * spec.gap,
                push: push * spec.speed,
                friction: law.friction,
                resists: resists([law.spinning, law.rolling], arm),
                now: t.gap,
                restitution: law.restitution,
                settles: world.settle_speed(spec, &law),
                ..NEW_POINT
            });
        }
        for (number, (ab, t)) in (scratch.touches.len()..).zip(&scratch.pairs) {
            let [p, q] = ab.map(|k| &scratch.places[k]);
            let both = [p.body, q.body];
            let (law, gap) = (world.pair_law(both), world.pair_gap(both));
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
                near: CONTACT_MARGIN * gap,
                push: push * world.specs[p.body].speed.min(world.specs[q.body].speed),
                friction: law.friction,
                resists: resists([law.spinning, law.rolling], arm),
                now: t.gap,
                restitution: law.restitution,
                settles: world.pair_settle_speed(both),
                ..NEW_POINT
            });
        }
        self.points.sort_unstable_by(|p, q| p.height.total_cmp(&q.height).then(p.number.cmp(&q.number)));
    }

    /// Takes the bodies at their starts, and rows for all points, whose impulses are those of the last step within
    /// `h` seconds.
    fn start(&mut self, scratch: &mut RigidScratch, world: &RigidWorld, h: f64) {
        self.begin(scratch, world, |_, p| (p.start.v, p.start.w));
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

    /// A kick of `kick` seconds of what acts freely, and impulses with which no point ends a drift of `h` seconds too
    /// near; with no drift, no point that touches then approaches. `time` is that since the start, `last` that of the
    /// last kick.
    fn kick(&mut self, scratch: &RigidScratch, world: &RigidWorld, [kick, last]: [f64; 2], drift: Option<f64>, time: f64) {
        self.rounds.movers.take(&self.members);
        for k in 0..self.points.len() {
            let row = &self.rounds.rows[self.rows[k]];
            self.points[k].approach = -row.velocity(&self.rounds.movers).dot(row.normal);
        }
        for (m, p) in self.members.iter_mut().zip(&scratch.places) {
            (m.v, m.w) = world.specs[p.body].kicked(&p.end.r, [m.v, m.w], kick);
        }
        self.rounds.movers.take(&self.members);
        let mut is_struck = false;
        for k in 0..self.points.len() {
            let (p, number) = (&mut self.points[k], self.rows[k]);
            let row = &mut self.rounds.rows[number];
            let room = p.now - p.kept;
            row.bias = match drift {
                _ if p.rebound > 0.0 => row.normal * -p.rebound,
                Some(h) => row.normal * (room.max(0.0) / h),
                None if p.now <= p.near || p.bore => DVec3::ZERO,
                None => row.normal * INACTIVE_BIAS,
            };
            let h = drift.unwrap_or(0.0);
            is_struck |= p.rebound > 0.0 || !p.bore && p.approach * h > room;
            row.impulse = if p.rebound > 0.0 { DVec3::ZERO } else { row.impulse * (WARM_START_OF_NNCG * kick / last) };
            row.begin(&mut self.rounds.movers);
            if p.resists.is_some() {
                self.rounds.rows[number + 1].impulse = DVec3::ZERO;
            }
        }
        let rounds = if is_struck { world.accuracy.sweeps * knob("SWEEPS", 1.0) as u32 } else { knob("ROUNDS", 20.0) as u32 };
        let enough = self.enough * knob("ENOUGH", 1.0);
        self.is_solved &= self.rounds.run(enough, rounds);
        self.rounds.movers.give(&mut self.members);
        for (p, &row) in self.points.iter_mut().zip(&self.rows) {
            let impulse = self.rounds.rows[row].impulse;
            let bears = impulse != DVec3::ZERO;
            p.rebound = 0.0;
            if bears && !p.bore {
                let parts = p.approach * p.restitution * knob("E", 1.0);
                p.rebound = if parts > p.settles { parts } else { 0.0 };
                p.strike = p.strike.or(Some((time, p.approach)));
            }
            p.bore = bears;
            p.total += impulse;
            p.force = impulse * (1.0 / kick);
        }
    }

    /// The drift of a substep of `h` seconds; what overlaps then is moved apart.
    fn drift(&mut self, scratch: &mut RigidScratch, world: &RigidWorld, h: f64) {
        self.shifts.clear();
        for (p, m) in scratch.places.iter_mut().zip(&mut self.members) {
            let spec = &world.specs[p.body];
            (p.end_turn, m.w) = drift_within(&spec.inertia, p.end_turn, m.w, h, spec.turn_error);
            p.end.x += m.v * h;
            p.end.r = DMat3::from_quat(p.end_turn);
            m.inverse_inertia = spec.inertia.inverse(&p.end.r);
            self.shifts.push([DVec3::ZERO; 2]);
        }
        self.place(scratch, world);
        if self.project(world, h) {
            for ((p, m), [shift, turn]) in scratch.places.iter_mut().zip(&mut self.members).zip(&self.shifts) {
                let spec = &world.specs[p.body];
                let l = spec.inertia.momentum(p.end_turn, m.w);
                p.end.x += *shift;
                p.end_turn = (rotation(*turn) * p.end_turn).normalize();
                p.end.r = DMat3::from_quat(p.end_turn);
                m.w = spec.inertia.spin(p.end_turn, l);
                m.inverse_inertia = spec.inertia.inverse(&p.end.r);
            }
            self.place(scratch, world);
        }
    }

    /// Shifts with which no point is nearer than the gap that it keeps, in rounds. Returns whether there are any.
    fn project(&mut self, world: &RigidWorld, h: f64) -> bool {
        let beta = knob("BETA", 1.0);
        let is_near = |p: &CrowdPoint| p.now < p.kept - 0.2 * p.near;
        if !self.points.iter().any(is_near) {
            return false;
        }
        self.pushes.clear();
        self.pushes.resize(self.points.len(), 0.0);
        for round in 0..knob("PROJECT", 2.0) as usize {
            let _ = (world, round);
            for k in 0..self.points.len() {
                let (p, row) = (&self.points[k], &self.rounds.rows[self.rows[k]]);
                let at = |[shift, turn]: &[DVec3; 2], arm: DVec3| *shift + turn.cross(arm);
                let mut gap = p.now + at(&self.shifts[p.a], row.arms[0]).dot(row.normal);
                gap -= p.b.map_or(0.0, |b| at(&self.shifts[b], row.arms[1]).dot(row.normal));
                let off = (p.kept - gap).min(p.push * h);
                let old = self.pushes[k];
                let next = (old + beta * off * row.gain_along()).max(0.0);
                self.pushes[k] = next;
                let push = row.normal * (next - old);
                if next != old {
                    let mut apply = |k: usize, arm: DVec3, push: DVec3| {
                        let m = &self.members[k];
                        self.shifts[k][0] += push * m.inverse_mass;
                        self.shifts[k][1] += m.inverse_inertia * arm.cross(push);
                    };
                    apply(p.a, row.arms[0], push);
                    if let Some(b) = p.b {
                        apply(b, row.arms[1], -push);
                    }
                }
            }
        }
        true
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
            let load = row.impulse.dot(row.normal);
            let across = row.impulse - row.normal * load;
            row.impulse = now.normal * load + (across - now.normal * across.dot(now.normal));
            row.lean -= now.normal * row.lean.dot(now.normal);
            (row.arms, row.normal) = (now.arms, now.normal);
            self.points[k].now = now.gap;
        }
    }

    /// Whether bodies have strayed so far that points may be missing from the list.
    fn strays(&mut self, scratch: &RigidScratch, world: &RigidWorld, h: f64, time: f64) -> bool {
        let mut is_far = false;
        for ((far, p), m) in self.strayed.iter_mut().zip(&scratch.places).zip(&self.members) {
            let spec = &world.specs[p.body];
            // Whether it falls or is held, it was seen.
            let gained = m.v - p.start.v;
            let fell = (gained.dot(spec.gravity) / spec.gravity.length_squared()).clamp(0.0, time);
            *far += ((gained - spec.gravity * fell).length() + (m.w - p.start.w).length() * spec.bounding_radius) * h;
            is_far |= *far > 0.5 * knob("REACH", 0.02) * spec.size;
        }
        is_far
    }

    /// What the whole step of `h` seconds comes to: a drift that ends where the last substep did.
    fn finish(&mut self, scratch: &mut RigidScratch, world: &RigidWorld, h: f64) {
        for p in &mut scratch.places {
            let spec = &world.specs[p.body];
            p.end.v = (p.end.x - p.start.x) / h;
            p.spin = rotation_vector(p.turn, p.end_turn) / h;
            for _ in 0..if spec.anisotropy == 0.0 { 0 } else { 2 } {
                let (turn, _) = drift_within(&spec.inertia, p.turn, p.spin, h, spec.turn_error);
                p.spin += rotation_vector(turn, p.end_turn) / h;
            }
        }
    }

    /// Where a point is now.
    fn carry(&self, scratch: &RigidScratch, world: &RigidWorld, p: &CrowdPoint) -> Carried {
        let a = &scratch.places[p.a];
        let b = p.b.map(|b| &scratch.places[b]);
        if p.carrier == Carrier::Skin {
            return match (b, scratch.touches.get(p.number)) {
                (Some(b), _) => {
                    let (both, t) = ([a.body, b.body], &scratch.pairs[p.number - scratch.touches.len()].1);
                    let after = world.pair_again(both, [&a.end, &b.end], t);
                    let arms = to_middle(after.arms, [a.end.x, b.end.x]);
                    Carried { arms, normal: after.normal, gap: after.gap }
                }
                (None, Some((_, t))) => {
                    let after = world.touch(a.body, &a.end, t.surface);
                    Carried { arms: [after.arm, DVec3::ZERO], normal: after.normal, gap: after.gap }
                }
                (None, None) => Carried { arms: p.arms, normal: p.normal, gap: p.gap },
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
        if let Some(b) = b {
            moved -= b.end.x - b.start.x + arms[1] - p.arms[1];
            // Both bodies are pushed at one point: that of the body whose corner it is.
            let apart = (a.end.x + arms[0]) - (b.end.x + arms[1]);
            match p.carrier {
                Carrier::Second => arms[1] += apart,
                Carrier::First => arms[0] -= apart,
                _ => (arms[0], arms[1]) = (arms[0] - apart * 0.5, arms[1] + apart * 0.5),
            }
        }
        Carried { arms, normal: n, gap: p.gap + moved.dot(n) }
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
}

impl RigidScratch {
    /// The force at a point in the last step, if it is known.
    fn load(&self, number: usize) -> Option<DVec3> {
        let loads = [&self.loads, &self.pair_loads];
        let (of, at) = number.checked_sub(self.touches.len()).map_or((0, number), |at| (1, at));
        loads[of].get(at).copied().flatten()
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

//! Lasting contact: what a body that touches something does next, in steps on its own adaptive clock.
//!
//! A step is a half kick of gravity and contact impulses, a straight drift at constant angular velocity, and another half kick (RATTLE's order). The first impulses
//! are such that every loaded point ends the drift at the gap that it is to keep, found in [`PASSES`] passes over the true geometry; the second such that no point
//! approaches. Impacts of other points during the drift are found exactly on the path that is really taken. Energy is never let grow.

use super::body::{Motion, Phase, Pose, Turning};
use super::contact::{Touch, response};
use super::part::Part;
use super::solve::{Contact, Member, sweep};
use super::tumble::{drift, rotation};
use super::{Rigid, Spec};
use crate::mechanics::Link;
use glam::{DMat3, DVec3};

/// Work space of a group's step.
#[derive(Debug, Default)]
pub struct RigidScratch {
    touches: Vec<Touch>,
    /// Points that touch but separate.
    leaving: Vec<Touch>,
    contacts: Vec<Contact>,
}

/// Passes over the end of a step: the first predicts where points get to, the others correct.
const PASSES: usize = 2;

/// Gap that lasting contacts keep, over the gap at which bodies touch. Default 0.75; below 1, so that they go on touching.
const KEEP: f64 = 0.75;

/// Gap up to which a point counts as touching, over the gap at which bodies touch: what a step leaves is not looked at as a new impact. This is the preset's gap.
pub(super) const TOUCHING: f64 = 2.0;

/// Decides how a group goes on.
pub(super) fn settle(world: &Rigid, members: &[u32], bodies: &mut [Turning], _links: &mut Vec<Link>, scratch: &mut RigidScratch) {
    for &k in members {
        let (index, body) = (k as usize, &mut bodies[k as usize]);
        if body.phase == Phase::Rest {
            body.begin(Phase::Rest, DVec3::ZERO);
            continue;
        }
        single(world, index, body, scratch);
    }
}

fn single(world: &Rigid, index: usize, body: &mut Turning, scratch: &mut RigidScratch) {
    let spec = &world.specs[index];
    let pose = body.pose();
    let touches = &mut scratch.touches;
    touches.clear();
    world.for_touches(index, &pose, TOUCHING * spec.gap, |t| touches.push(t));
    // Points that separate faster than a bounce that counts are on their own.
    let leaving = &mut scratch.leaving;
    leaving.clear();
    touches.retain(|t| {
        let law = world.law_at(index, t.part, pose.x + t.arm);
        let lasts = pose.velocity(t.arm).dot(t.normal) <= world.settle_speed(spec, &law);
        if !lasts {
            leaving.push(*t);
        }
        lasts
    });
    body.listed = f64::NEG_INFINITY;
    if touches.is_empty() {
        body.list(std::iter::empty());
        return body.begin(Phase::Flight, world.gravity);
    }
    let mut h = world.step_length(spec, &pose, touches);
    if !h.is_finite() || !(h > 0.0) {
        return body.begin(Phase::Flight, world.gravity);
    }
    if world.is_slow(spec, &pose) && world.is_supported(index, spec, &pose, scratch, h) {
        (body.path.v, body.spin) = (DVec3::ZERO, DVec3::ZERO);
        return body.begin(Phase::Rest, DVec3::ZERO);
    }
    for _ in 0..SHORTENINGS {
        world.step(index, body, &pose, scratch, h);
        match world.returns(body, scratch, &pose) {
            Some(part) => h *= part,
            None => return body.list(scratch.touches.iter().map(Touch::surface)),
        }
    }
    // Bounces too fast for any step: they count as lasting.
    scratch.touches.append(&mut scratch.leaving);
    world.step(index, body, &pose, scratch, h);
    body.list(scratch.touches.iter().map(Touch::surface));
}

/// How often a step is shortened so that points which just left are not back within it. Each aims at half their speed.
const SHORTENINGS: usize = 4;

impl Rigid {
    /// Whether the drift of a step brings a point back that is just leaving, and by what part the step is too long then.
    fn returns(&self, body: &Turning, scratch: &RigidScratch, start: &Pose) -> Option<f64> {
        let mut worst = 1.0_f64;
        for t in &scratch.leaving {
            let before = start.velocity(t.arm).dot(t.normal);
            let drifting = (body.path.v + body.spin.cross(t.arm)).dot(t.normal);
            if drifting < 0.25 * before {
                worst = worst.min(0.5 * before / (before - drifting));
            }
        }
        (worst < 1.0).then_some(worst)
    }

    fn step_length(&self, spec: &Spec, pose: &Pose, touches: &[Touch]) -> f64 {
        let mut time = (spec.size / self.strength).sqrt().min(1.0 / pose.w.length());
        for t in touches {
            if let Part::Table(table) = &self.parts[usize::from(t.part)] {
                let at = pose.x + t.arm;
                let bend = table.height.at(at.x, at.y).bend;
                let bend = bend[0].abs().max(bend[2].abs()) + bend[1].abs();
                let speed = pose.velocity(t.arm).length();
                time = time.min(1.0 / (self.strength * bend).sqrt()).min(1.0 / (bend * speed));
            }
        }
        self.accuracy.step * time
    }

    fn is_slow(&self, spec: &Spec, pose: &Pose) -> bool {
        let limit = self.accuracy.rest_speed * spec.speed;
        pose.v.length() <= limit && pose.w.length() * spec.reach <= limit
    }

    /// Whether the contacts can hold a body that does not move.
    fn is_supported(&self, index: usize, spec: &Spec, pose: &Pose, scratch: &mut RigidScratch, h: f64) -> bool {
        if !scratch.leaving.is_empty() {
            return false;
        }
        let touches = &scratch.touches;
        if spec.is_ball {
            let [only] = &touches[..] else { return false };
            return only.normal.cross(self.gravity).length() <= 1e-9 * self.strength && pose.v == DVec3::ZERO && pose.w == DVec3::ZERO;
        }
        if touches.len() < 3 {
            return false;
        }
        let normal = touches[0].normal;
        if touches.iter().all(|t| t.normal == normal) {
            // Flat ground: the centre of gravity above the points, and not steeper than friction allows.
            let law = self.law_at(index, touches[0].part, pose.x + touches[0].arm);
            let press = -self.gravity.dot(normal);
            let slide = (self.gravity + normal * press).length();
            return slide <= law.friction * press && is_above(touches, self.gravity / self.strength);
        }
        let mut members = [self.member(spec, 0, &pose.r, self.gravity * h, DVec3::ZERO)];
        self.make_contacts(index, pose, &members[0], scratch);
        sweep(&mut scratch.contacts, &mut members, 0.03 * self.accuracy.rest_residual * self.strength * h, self.accuracy.sweeps);
        let [m] = members;
        let left = m.v.length().max(m.w.length() * spec.reach);
        left <= self.accuracy.rest_residual * self.strength * h
    }

    fn member(&self, spec: &Spec, index: u32, r: &DMat3, v: DVec3, w: DVec3) -> Member {
        let inverse_inertia = spec.inertia.inverse(r);
        Member { index, inverse_mass: 1.0 / spec.mass, inverse_inertia, v, w, reach: spec.reach, last: [DVec3::ZERO; 2] }
    }

    fn make_contacts(&self, index: usize, pose: &Pose, member: &Member, scratch: &mut RigidScratch) {
        let RigidScratch { touches, contacts, .. } = scratch;
        contacts.clear();
        contacts.extend(touches.iter().map(|t| {
            let law = self.law_at(index, t.part, pose.x + t.arm);
            let k = response(member.inverse_mass, &member.inverse_inertia, t.arm);
            Contact::new(0, None, [t.arm, DVec3::ZERO], t.normal, law.friction, k)
        }));
    }

    fn step(&self, index: usize, body: &mut Turning, start: &Pose, scratch: &mut RigidScratch, h: f64) {
        let spec = &self.specs[index];
        let enough = self.accuracy.sweep_tolerance * self.strength * h;
        let keep = KEEP * spec.gap;
        let half_kick = self.gravity * (0.5 * h);
        let half_spin = |turn, w| if spec.wobble == 0.0 { w } else { drift(&spec.inertia, turn, w, 0.5 * h).1 };
        let free_w = half_spin(body.turn, start.w);
        let mut members = [self.member(spec, index as u32, &start.r, start.v + half_kick, free_w)];
        self.make_contacts(index, start, &members[0], scratch);
        // What a point may still fall, and how far turning alone lifts it towards its own circle.
        for (c, t) in scratch.contacts.iter_mut().zip(&scratch.touches) {
            let rise = start.w.cross(start.w.cross(t.arm)).dot(t.normal);
            c.target = (keep - t.gap) / h - 0.5 * h * rise;
        }
        let mut end = *start;
        let mut end_turn = body.turn;
        for pass in 0..PASSES {
            sweep(&mut scratch.contacts, &mut members, enough, self.accuracy.sweeps);
            end_turn = (rotation(members[0].w * h) * body.turn).normalize();
            end = Pose { x: start.x + members[0].v * h, r: DMat3::from_quat(end_turn), v: members[0].v, w: members[0].w };
            if pass + 1 < PASSES {
                for (c, t) in scratch.contacts.iter_mut().zip(&scratch.touches) {
                    c.target += (keep - self.touch(index, &end, t.part, t.point).gap) / h;
                }
            }
        }
        let [drifting] = members;
        // The second kick, over the points that still touch.
        let mut members = [self.member(spec, index as u32, &end.r, drifting.v + half_kick, half_spin(end_turn, drifting.w))];
        for c in 0..scratch.touches.len() {
            let loaded = scratch.contacts[c].impulse != DVec3::ZERO;
            let t = &scratch.touches[c];
            let after = self.touch(index, &end, t.part, t.point);
            let old = scratch.contacts[c];
            let k = response(members[0].inverse_mass, &members[0].inverse_inertia, after.arm);
            let mut next = Contact::new(0, None, [after.arm, DVec3::ZERO], after.normal, old.friction, k);
            if loaded || after.gap <= TOUCHING * spec.gap {
                next.impulse = old.impulse;
                next.push(&mut members, next.impulse);
            } else {
                // It has left the ground: no impulse, whatever its velocity.
                next.target = -f64::MAX;
            }
            scratch.contacts[c] = next;
        }
        sweep(&mut scratch.contacts, &mut members, enough, self.accuracy.sweeps);
        let [m] = members;
        let mut finish = Motion { v: m.v, w: m.w };
        // A group's energy never grows, whatever the step's error.
        let kinetic = |turn, m: &Motion| 0.5 * (spec.mass * m.v.length_squared() + m.w.dot(spec.inertia.momentum(turn, m.w)));
        let first = Motion { v: start.v, w: start.w };
        let before = kinetic(body.turn, &first) + spec.mass * self.gravity.dot(end.x - start.x);
        let after = kinetic(end_turn, &finish);
        if after > before {
            let part = (before.max(0.0) / after).sqrt();
            finish = Motion { v: finish.v * part, w: finish.w * part };
        }
        body.ends = [first, finish];
        (body.path.v, body.spin) = (drifting.v, drifting.w);
        body.begin(Phase::Step, DVec3::ZERO);
        body.expiry = body.path.t + h;
    }
}

/// Whether the line of gravity through the centre of gravity meets the hull of the points: no half plane holds them all.
fn is_above(touches: &[Touch], down: DVec3) -> bool {
    let flat = |t: &Touch| t.arm - down * t.arm.dot(down);
    touches.iter().all(|a| {
        let p = flat(a);
        let margin = MARGIN * p.length_squared();
        let (mut left, mut right) = (false, false);
        for b in touches {
            let side = p.cross(flat(b)).dot(down);
            left |= side > margin;
            right |= side < -margin;
        }
        let opposite = || touches.iter().any(|b| p.dot(flat(b)) < 0.0);
        (left && right) || ((left || right) && opposite() && on_line(p, touches, down))
    })
}

/// Whether some point lies exactly opposite to `p`: then a third one on one side is enough to look at from here.
fn on_line(p: DVec3, touches: &[Touch], down: DVec3) -> bool {
    touches.iter().any(|b| {
        let q = b.arm - down * b.arm.dot(down);
        p.dot(q) < 0.0 && p.cross(q).length() <= MARGIN * p.length_squared()
    })
}

/// Sine of the angle below which points count as opposite. Default 1e-6.
const MARGIN: f64 = 1e-6;

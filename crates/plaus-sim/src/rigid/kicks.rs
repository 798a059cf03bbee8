//! The two halves of a step of lasting contact: a kick with the drift after it, and the second kick.

use super::Rigid;
use super::Spec;
use super::contact::response;
use super::energy::resist;
use super::solve::{Contact, Enough, sweep};
use super::step::{CLOSE, KEEP, PASSES, PASSES_OF_CUBOIDS, PUSH, RigidScratch, TOUCHING};
use super::tumble::drift;
use glam::{DQuat, DVec3};

/// A step that is under way.
#[derive(Debug, Clone, Copy)]
pub(super) struct Step {
    h: f64,
    enough: Enough,
    half_kick: DVec3,
}

impl Step {
    /// Angular velocity after half of the step without any contact.
    fn half_spin(&self, spec: &Spec, turn: DQuat, w: DVec3) -> DVec3 {
        if spec.wobble == 0.0 { w } else { drift(&spec.inertia, turn, w, 0.5 * self.h).1 }
    }
}

impl RigidScratch {
    /// The first half of a step of `h` seconds from the starts: a kick and the drift, whose ends are left in `places`. It is to be done with where the second half, whose velocities
    /// are left in `members`, is worth doing.
    pub(super) fn drift(&mut self, world: &Rigid, h: f64) -> Step {
        let (push, fine) = (world.strength * h, self.fine(world) / h);
        let enough = Enough::new((world.accuracy.sweep_tolerance * push).min(fine), push);
        let step = Step { h, enough, half_kick: world.gravity * (0.5 * h) };
        self.prepare(world, |spec, p| (p.start.v + step.half_kick, step.half_spin(spec, p.turn, p.start.w)));
        // What a point may still fall, and how far turning alone lifts it towards its own circle.
        for (c, (k, t)) in self.contacts.iter_mut().zip(&self.touches) {
            let (p, spec) = (&self.places[*k], &world.specs[self.places[*k].body]);
            let rise = if spec.is_round || world.is_at_ledge(p.body, t.part, t.point) {
                0.0
            } else {
                p.start.w.cross(p.start.w.cross(t.arm)).dot(t.normal)
            };
            c.target = ((KEEP * spec.gap - t.gap) / h).min(PUSH * world.accuracy.settle * spec.speed) - 0.5 * h * rise;
        }
        let first_pair = self.touches.len();
        for (c, (ab, t)) in self.contacts[first_pair..].iter_mut().zip(&self.pairs) {
            let [p, q] = ab.map(|k| self.places[k].drifted(&self.members[k], h).0);
            let both = ab.map(|k| self.places[k].body);
            // How much farther apart than a straight way says turning brings them.
            let bend = world.pair_again(both, [&p, &q], t).gap - t.gap - h * c.velocity(&self.members).dot(t.normal);
            c.target = (world.pair_goal(both, t.gap, h) - t.gap - bend) / h;
        }
        // The last step's forces are a good guess.
        for (c, &load) in self.contacts.iter_mut().zip(&self.loads) {
            if load != DVec3::ZERO {
                c.impulse = load * (0.5 * h);
                c.push(&mut self.members, c.impulse);
            }
        }
        let passes = if self.has_cuboids_in_touch() || self.is_at_ledges(world) { PASSES_OF_CUBOIDS } else { PASSES };
        for pass in 0..passes {
            sweep(&mut self.contacts, &mut self.members, enough, world.accuracy.sweeps);
            for (p, m) in self.places.iter_mut().zip(&self.members) {
                (p.end, p.end_turn) = p.drifted(m, h);
            }
            if pass + 1 < passes {
                let mut off = false;
                for (c, (k, t)) in self.contacts.iter_mut().zip(&self.touches) {
                    let p = &self.places[*k];
                    let spec = &world.specs[p.body];
                    let missing = (KEEP * spec.gap - world.touch(p.body, &p.end, t.part, t.point).gap) / h;
                    off |= (missing > 0.0 || c.impulse != DVec3::ZERO) && missing.abs() * h > CLOSE * spec.gap;
                    c.target += missing.min(PUSH * world.accuracy.settle * spec.speed);
                }
                for (c, (ab, t)) in self.contacts[first_pair..].iter_mut().zip(&self.pairs) {
                    let [p, q] = ab.map(|k| &self.places[k]);
                    let after = world.pair_again([p.body, q.body], [&p.end, &q.end], t);
                    let both = [p.body, q.body];
                    let missing = world.pair_goal(both, t.gap, h) - after.gap;
                    off |= (missing > 0.0 || c.impulse != DVec3::ZERO) && missing.abs() > CLOSE * world.pair_gap(both);
                    c.target += missing / h;
                }
                if !off {
                    break;
                }
            }
        }
        step
    }

    /// The second kick, over the points that still touch at the ends.
    pub(super) fn second_kick(&mut self, world: &Rigid, step: &Step) {
        for (m, p) in self.members.iter_mut().zip(&self.places) {
            let spec = &world.specs[p.body];
            *m = Self::member(spec, &p.end.r, p.end.v + step.half_kick, step.half_spin(spec, p.end_turn, p.end.w));
        }
        resist(world, &self.places, &self.touches, &self.contacts, &mut self.members);
        for c in 0..self.contacts.len() {
            let old = self.contacts[c];
            let (mut next, gap, touching) = if let Some((a, t)) = self.touches.get(c) {
                let (p, m) = (&self.places[*a], &self.members[*a]);
                let after = world.touch(p.body, &p.end, t.part, t.point);
                let k = response(m.inverse_mass, &m.inverse_inertia, after.arm);
                (
                    Contact::new(*a, None, [after.arm, DVec3::ZERO], after.normal, old.friction, k),
                    after.gap,
                    world.specs[p.body].gap,
                )
            } else {
                let (ab, t) = &self.pairs[c - self.touches.len()];
                let ab = *ab;
                let [p, q] = ab.map(|k| &self.places[k]);
                let after = world.pair_again([p.body, q.body], [&p.end, &q.end], t);
                (self.pair_contact(world, ab, &after), after.gap, world.pair_gap([p.body, q.body]))
            };
            if old.impulse != DVec3::ZERO || gap <= TOUCHING * touching {
                next.impulse = old.impulse;
                next.push(&mut self.members, next.impulse);
            } else {
                // It has left: no impulse, whatever its velocity.
                next.target = -f64::MAX;
            }
            self.contacts[c] = next;
        }
        sweep(&mut self.contacts, &mut self.members, step.enough, world.accuracy.sweeps);
        self.guard_energy(world);
    }
}

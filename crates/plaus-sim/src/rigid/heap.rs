//! What a group touches, and what is different in a heap, which is many bodies in lasting contact.
//!
//! Half way through a step, corners leave what they touch by [`SAG`] of their size. In a heap, each event interrupts a
//! step of all its bodies. If such contacts counted as over, all would be struck again one by one, and each would
//! interrupt a step again. So in a heap, points up to that distance are part of the lasting contact.

use super::Rigid;
use super::body::{NEVER, Phase, Turning};
use super::pile::SAG;
use super::scratch::{Place, RigidScratch, TOUCHING};
use super::touch::Touch;
use crate::links::Links;

/// Number of members from which a group counts as a heap. Default 13: more than ten pins and a ball.
pub(super) const HEAP: usize = 13;

/// Least number of members of a crowd, whatever the preset says. Default 4.
pub(super) const CROWD: usize = 4;

/// Fraction of [`SAG`] up to which points of a heap that separate half way through a step belong to its contacts.
/// Default 0.5: a straight drift leaves a curve by half of the bound to which steps are shortened, an eighth of 4 times
/// `SAG`.
const FARTHEST: f64 = 0.5;

/// The same in smaller groups, over the gap at which bodies touch. Default 50.
pub(super) const NEARBY: f64 = 50.0;

/// Whether bodies in lasting contact with each other are a heap.
pub(super) fn is_heap(group: &[u32]) -> bool {
    group.len() >= HEAP
}

/// How far beyond touching a point may be and still belong to the contacts of a group, over the size.
pub(super) fn sag(members: usize, gap: f64) -> f64 {
    match members {
        HEAP.. => FARTHEST * SAG,
        3.. => (NEARBY * gap).min(FARTHEST * SAG),
        _ => 0.0,
    }
}

impl RigidScratch {
    /// Finds the lasting contacts of a group. Bodies without any contact fly.
    pub(super) fn gather(&mut self, world: &Rigid, group: &[u32], bodies: &mut [Turning], links: &mut Links) {
        self.clear();
        let sag = sag(group.len(), world.accuracy.gap);
        for &k in group {
            bodies[k as usize].sag = sag;
            for j in links.of(k).filter(|&j| j > k) {
                self.gather_pair(world, [k as usize, j as usize], bodies, sag);
            }
        }
        links.retain(|link| {
            let pair = link.map(|k| k as usize);
            !group.contains(&link[0])
                || self.pairs.iter().any(|p| p.0 == pair)
                || world.is_joined(pair, pair.map(|k| &bodies[k]))
        });
        for &k in group {
            self.gather_touches(world, k as usize, bodies, sag);
        }
        self.parting.retain(|p| p.0.iter().all(|&k| self.places.iter().any(|q| q.body == k)));
        for p in self.pairs.iter_mut().chain(&mut self.parting) {
            p.0 = p.0.map(|k| self.places.iter().position(|q| q.body == k).unwrap_or(0));
        }
        if !world.joints.bonds.is_empty() {
            self.gather_joints(world, group, bodies);
        }
    }

    fn gather_pair(&mut self, world: &Rigid, [i, j]: [usize; 2], bodies: &[Turning], sag: f64) {
        if world.is_joined([i, j], [&bodies[i], &bodies[j]]) {
            return;
        }
        let (a, b) = (bodies[i].pose(), bodies[j].pose());
        let restitution = world.pair_law([i, j]).restitution;
        let hurried = (bodies[i].is_hurried() || bodies[j].is_hurried()) && restitution < 1.0;
        let stuck = bodies[i].sticks_to(j);
        let limit = world.pair_settle_speed([i, j]);
        let near = TOUCHING * world.pair_gap([i, j]);
        let within = near + sag * world.specs[i].size.min(world.specs[j].size);
        world.for_pair_touches([i, j], [&a, &b], within, |touch| {
            let rate = touch.rate(&a, &b);
            // A point that is farther would bounce, or is leaving.
            if touch.gap > near && (rate > limit || -rate * restitution > limit) {
                return;
            }
            let slow = hurried || stuck || rate <= limit;
            if slow {
                self.pairs.push(([i, j], touch));
                self.pair_loads.push(bodies[i].pair_load(j, touch.name()));
            } else {
                self.parting.push(([i, j], touch));
            }
        });
    }

    fn gather_touches(&mut self, world: &Rigid, index: usize, bodies: &mut [Turning], sag: f64) {
        if bodies[index].phase == Phase::Gone {
            return;
        }
        let (spec, pose, hurried) = (&world.specs[index], bodies[index].pose(), bodies[index].is_hurried());
        let is_held = world.bonds_of(index, bodies).next().is_some();
        if spec.is_driven() {
            if is_held || self.pairs.iter().any(|p| p.0.contains(&index)) {
                self.places.push(Place::of(&bodies[index], index));
            }
            return;
        }
        if std::mem::take(&mut bodies[index].sleeps) {
            return bodies[index].lie_still();
        }
        let (at, before) = (self.places.len(), self.touches.len());
        let near = TOUCHING * spec.gap;
        let take = |t: Touch| {
            let law = world.law_at(index, &t, pose.x + t.arm);
            let (rate, limit) = (pose.velocity(t.arm).dot(t.normal), world.settle_speed(spec, &law));
            if t.gap > near && sag > 0.0 && (rate > limit || -rate * law.restitution > limit) {
                return;
            }
            if hurried && law.restitution < 1.0 || rate <= limit {
                self.touches.push((at, t));
                self.loads.push(bodies[index].load(t.surface));
            } else {
                self.leaving.push((at, t));
            }
        };
        if sag > 0.0 {
            world.for_touches(index, &pose, near + sag * spec.size, take);
        } else {
            world.for_known_touches(index, &bodies[index], &pose, take);
        }
        let body = &mut bodies[index];
        body.listed = -NEVER;
        let linked = is_held || self.pairs.iter().any(|p| p.0.contains(&index));
        if self.touches.len() == before && !linked {
            self.leaving.retain(|l| l.0 != at);
            body.list(std::iter::empty());
            return world.fly(index, body);
        }
        self.places.push(Place::of(body, index));
    }

    /// When contacts are tested for whether they can hold a heap: leaves out those that do not touch yet.
    pub(super) fn leave_out_distant(&mut self, world: &Rigid) {
        if self.places.len() < HEAP && !self.in_crowd {
            return;
        }
        // Rounds end before all gaps are right.
        let farthest = if self.newton.in_rounds || self.in_crowd { NEARBY } else { TOUCHING };
        let size = |k: usize| world.specs[self.places[k].body].gap;
        let touches = self.touches.iter().map(|(k, t)| t.gap / size(*k));
        let pairs = self.pairs.iter().map(|(ab, t)| t.gap / size(ab[0]).min(size(ab[1])));
        for (c, gap) in self.contacts.iter_mut().zip(touches.chain(pairs)) {
            if gap > farthest {
                c.target = -f64::MAX;
            }
        }
    }
}

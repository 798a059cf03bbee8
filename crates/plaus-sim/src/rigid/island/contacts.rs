//! What an island touches, and what is different in a large one.
//!
//! Half way through a step, corners leave what they touch by [`MID_STEP_DRIFT`] of their size. In a large island, each
//! event interrupts a step of all its bodies. If such contacts counted as over, all would be struck again one by one,
//! and each would interrupt a step again. So in a large island, points up to that distance are part of the lasting
//! contact.

use crate::links::Links;
use crate::rigid::RigidWorld;
use crate::rigid::body_state::{NEVER, Phase, RigidBodyState};
use crate::rigid::narrow_phase::contact_point::ContactPoint;
use crate::rigid::scratch::{RigidScratch, StepPoses};
use crate::rigid::tolerances::{
    CONTACT_MARGIN, GRAZE, LARGE_ISLAND, LARGE_ISLAND_DRIFT, MID_STEP_DRIFT, SMALL_ISLAND_DRIFT,
};

/// Whether bodies in lasting contact with each other are a large island.
pub(crate) fn is_large(island: &[u32]) -> bool {
    island.len() >= LARGE_ISLAND
}

/// How far beyond touching a point may be and still belong to the contacts of an island, over the size.
pub(super) fn mid_step_drift(members: usize, gap: f64) -> f64 {
    match members {
        LARGE_ISLAND.. => LARGE_ISLAND_DRIFT * MID_STEP_DRIFT,
        3.. => (SMALL_ISLAND_DRIFT * gap).min(LARGE_ISLAND_DRIFT * MID_STEP_DRIFT),
        _ => 0.0,
    }
}

impl RigidScratch {
    /// Finds the lasting contacts of an island. Bodies without any contact fly.
    pub(crate) fn gather(
        &mut self,
        world: &RigidWorld,
        island: &[u32],
        bodies: &mut [RigidBodyState],
        links: &mut Links,
    ) {
        self.clear();
        let mid_step_drift = mid_step_drift(island.len(), world.accuracy.gap);
        for &k in island {
            bodies[k as usize].mid_step_drift = mid_step_drift;
            for j in links.of(k).filter(|&j| j > k) {
                self.gather_pair(world, [k as usize, j as usize], bodies, mid_step_drift);
            }
        }
        links.retain(|link| {
            let pair = link.map(|k| k as usize);
            !island.contains(&link[0])
                || self.pairs.iter().any(|p| p.0 == pair)
                || world.never_touch(pair, pair.map(|k| &bodies[k]))
                || world.is_tied(pair, pair.map(|k| &bodies[k]))
        });
        for &k in island {
            self.gather_touches(world, k as usize, bodies, mid_step_drift);
        }
        self.parting.retain(|p| p.0.iter().all(|&k| self.places.iter().any(|q| q.body == k)));
        for p in self.pairs.iter_mut().chain(&mut self.parting) {
            p.0 = p.0.map(|k| self.places.iter().position(|q| q.body == k).unwrap_or(0));
        }
        if !world.joints.bonds.is_empty() {
            world.wind(island, bodies);
            self.gather_joints(world, island, bodies);
        }
    }

    fn gather_pair(&mut self, world: &RigidWorld, [i, j]: [usize; 2], bodies: &[RigidBodyState], mid_step_drift: f64) {
        if world.never_touch([i, j], [&bodies[i], &bodies[j]]) {
            return;
        }
        let (a, b) = (bodies[i].pose(), bodies[j].pose());
        let restitution = world.pair_law([i, j]).restitution;
        let chattering = (bodies[i].is_chattering() || bodies[j].is_chattering()) && restitution < 1.0;
        let deferred = bodies[i].is_pair_deferred(j);
        // Without gravity, rounding would decide.
        let graze = GRAZE * (a.fastest(&world.specs[i]) + b.fastest(&world.specs[j]));
        let limit = world.pair_settle_speed([i, j]).max(graze);
        let near = CONTACT_MARGIN * world.pair_gap([i, j]);
        let within = near + mid_step_drift * world.specs[i].size.min(world.specs[j].size);
        world.for_pair_touches([i, j], [&a, &b], within, |touch| {
            let rate = touch.rate(&a, &b);
            // A point that is farther would bounce, or is leaving.
            if touch.gap > near && (rate > limit || -rate * restitution > limit) {
                return;
            }
            let slow = chattering || deferred || rate <= limit;
            if slow {
                self.pairs.push(([i, j], touch));
                self.pair_loads.push(bodies[i].pair_load(j, touch.name()));
            } else {
                self.parting.push(([i, j], touch));
            }
        });
    }

    fn gather_touches(&mut self, world: &RigidWorld, index: usize, bodies: &mut [RigidBodyState], mid_step_drift: f64) {
        if bodies[index].phase == Phase::Gone {
            return;
        }
        let (spec, pose, chattering) = (&world.specs[index], bodies[index].pose(), bodies[index].is_chattering());
        let is_held = world.bonds_of(index, bodies).next().is_some();
        if spec.is_driven() {
            if is_held || self.pairs.iter().any(|p| p.0.contains(&index)) {
                self.places.push(StepPoses::of(&bodies[index], index));
            }
            return;
        }
        if std::mem::take(&mut bodies[index].sleeps) {
            return bodies[index].lie_still();
        }
        let (at, before, graze) = (self.places.len(), self.touches.len(), GRAZE * pose.fastest(spec));
        let near = CONTACT_MARGIN * spec.gap;
        let take = |t: ContactPoint| {
            let law = world.law_at(index, &t, pose.x + t.arm);
            let (rate, limit) = (pose.velocity(t.arm).dot(t.normal), world.settle_speed(spec, &law).max(graze));
            if t.gap > near && mid_step_drift > 0.0 && (rate > limit || -rate * law.restitution > limit) {
                return;
            }
            if chattering && law.restitution < 1.0 || rate <= limit {
                self.touches.push((at, t));
                self.loads.push(bodies[index].load(t.surface));
            } else {
                self.leaving.push((at, t));
            }
        };
        if mid_step_drift > 0.0 {
            world.for_touches(index, &pose, near + mid_step_drift * spec.size, take);
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
        self.places.push(StepPoses::of(body, index));
    }

    /// When contacts are tested for whether they can hold a large island: leaves out those that do not touch yet.
    pub(super) fn leave_out_distant(&mut self, world: &RigidWorld) {
        if self.places.len() < LARGE_ISLAND && !self.is_time_stepped {
            return;
        }
        // Rounds end before all gaps are right.
        let farthest = if self.newton.in_rounds || self.is_time_stepped { SMALL_ISLAND_DRIFT } else { CONTACT_MARGIN };
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

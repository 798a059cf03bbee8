//! The points at which a time-stepped island may touch within its next step.

use super::{contacts, sleep};
use crate::accuracy::Accuracy;
use crate::links::Link;
use crate::mechanics::{Lookahead, TimeSteppedIsland};
use crate::rigid::RigidWorld;
use crate::rigid::body_state::{NEVER, Phase, RigidBodyState};
use crate::rigid::narrow_phase::contact_point::PairContactPoint;
use crate::rigid::scratch::{RigidScratch, StepPoses};
use crate::rigid::tolerances::{
    CONTACT_MARGIN, MAX_DIRECT_BODIES, NNCG_ROUNDS_WITH_FACES, ROUNDS_FOR_HEIGHT, SLEEP_PATIENCE,
};
use crate::shape::Within;
use glam::DVec3;
use plaus_dist::math;
use std::f64::consts::PI;

impl RigidScratch {
    /// Finds all points at which a time-stepped island may touch within its next step; of bodies with faces, also
    /// points that are farther by `reach` over their size. Bodies without any fly.
    pub(super) fn gather_time_stepped(
        &mut self,
        world: &RigidWorld,
        island: &TimeSteppedIsland,
        bodies: &mut [RigidBodyState],
        reach: f64,
    ) {
        self.clear();
        let Lookahead { span, slack, fall } = island.ahead;
        let falls = |k: usize, n: DVec3| 0.5 * world.specs[k].gravity.dot(n).abs() * span * span;
        let mid_step_drift = contacts::mid_step_drift(island.members.len(), world.accuracy.gap);
        let mut is_near = vec![false; island.members.len()];
        let at = |k: usize| island.members.partition_point(|&m| (m as usize) < k);
        for (n, &k) in island.members.iter().enumerate() {
            let (k, body) = (k as usize, &mut bodies[k as usize]);
            body.mid_step_drift = mid_step_drift;
            let spec = &world.specs[k];
            if std::mem::take(&mut body.sleeps) {
                body.lie_still();
            }
            if body.phase == Phase::Gone {
                continue;
            }
            let pose = body.pose();
            let close = CONTACT_MARGIN * spec.gap + mid_step_drift * spec.size;
            let slack = if spec.is_ball { slack } else { 0.0 };
            let speed = pose.v.length() + if spec.is_ball { 0.0 } else { pose.w.length() * spec.bounding_radius };
            let reach = if spec.is_ball { 0.0 } else { reach * spec.size };
            let still = close + slack + fall + reach;
            let within = Within { gap: still + speed * span, still, span, beside: close };
            world.for_touches(k, &pose, within, |t| {
                let coming = (-pose.velocity(t.arm).dot(t.normal) * span).max(0.0) + reach;
                if t.gap <= close + slack + falls(k, t.normal) + coming {
                    self.is_far[0].push(t.gap > close + slack + falls(k, t.normal) + coming - reach);
                    self.touches.push((n, t));
                    self.loads.push(body.load(t.surface));
                    is_near[n] = true;
                }
            });
        }
        for link in island.near {
            let [i, j] = link.map(|k| k as usize);
            if bodies[i].phase == Phase::Gone || bodies[j].phase == Phase::Gone {
                continue;
            }
            let (a, b) = (bodies[i].pose(), bodies[j].pose());
            let close =
                CONTACT_MARGIN * world.pair_gap([i, j]) + mid_step_drift * world.specs[i].size.min(world.specs[j].size);
            let turns = |k: usize, w: DVec3| {
                if world.specs[k].is_ball { 0.0 } else { w.length() * world.specs[k].bounding_radius }
            };
            let slack = if world.specs[i].is_ball && world.specs[j].is_ball { slack } else { 0.0 };
            let speed = (a.v - b.v).length() + turns(i, a.w) + turns(j, b.w);
            let are_balls = world.specs[i].is_ball && world.specs[j].is_ball;
            let size = world.specs[i].size.min(world.specs[j].size);
            let reach = if are_balls { 0.0 } else { reach * size };
            let still = close + slack + fall + reach;
            let within = Within { gap: still + speed * span, still, span, beside: close };
            world.for_pair_touches([i, j], [&a, &b], within, |t: PairContactPoint| {
                let coming = (-t.rate(&a, &b) * span).max(0.0) + reach;
                let most = close + slack + falls(i, t.normal).max(falls(j, t.normal)) + coming;
                if t.gap <= most {
                    self.is_far[1].push(t.gap > most - reach);
                    let ab = [at(i), at(j)];
                    self.pairs.push((ab, t));
                    self.pair_loads.push(bodies[i].pair_load(j, t.name()));
                    ab.iter().for_each(|&n| is_near[n] = true);
                }
            });
        }
        self.place_near(world, island, bodies, &is_near);
        self.is_time_stepped = true;
        self.stays = self.places.iter().all(|p| bodies[p.body].stays && bodies[p.body].path.t >= bodies[p.body].expiry);
        self.note_rebounds(world);
        let has_faces = world.has_faces(self.places.iter().map(|p| p.body as u32));
        let is_large = self.places.len() > MAX_DIRECT_BODIES;
        let is_slow = sleep::is_slow(world, self);
        // A few bodies that are about to rest first come out of their overlaps, exactly.
        self.newton.is_time_stepped = has_faces && (is_large || !is_slow);
        self.newton.in_rounds = is_large && !has_faces;
        let rounds = if has_faces || reach > 0.0 { self.rounds_for_height(&world.accuracy) } else { 0 };
        self.newton.is_demanding = rounds > world.accuracy.sweeps || is_large && is_slow;
        let patience = if is_slow { SLEEP_PATIENCE } else { 1 };
        self.newton.rounds_with_faces = patience * NNCG_ROUNDS_WITH_FACES.max(ROUNDS_FOR_HEIGHT * rounds);
    }

    /// How many rounds carry loads through all levels in which bodies bear on each other above the fixed parts: in a
    /// chain of `n` levels, conjugate gradients leave the part `ε` of the load after `(2n/π) ln(2/ε)` rounds.
    pub(super) fn rounds_for_height(&self, accuracy: &Accuracy) -> u32 {
        let mut is_borne = vec![false; self.places.len()];
        self.touches.iter().for_each(|(k, _)| is_borne[*k] = true);
        let mut levels = 1.0;
        loop {
            let below = is_borne.clone();
            for ([a, b], _) in &self.pairs {
                is_borne[*a] |= below[*b];
                is_borne[*b] |= below[*a];
            }
            if is_borne == below {
                return (2.0 / PI * levels * math::ln(2.0 / accuracy.sweep_tolerance)) as u32;
            }
            levels += 1.0;
        }
    }

    /// Places the members that are near others, to which the points found then belong; the others fly.
    fn place_near(
        &mut self,
        world: &RigidWorld,
        island: &TimeSteppedIsland,
        bodies: &mut [RigidBodyState],
        is_near: &[bool],
    ) {
        let at = |k: usize| island.members.partition_point(|&m| (m as usize) < k);
        let both = |link: &Link| link.map(|k| at(k as usize));
        let are_near = |ab: &[usize; 2]| ab.iter().all(|&n| is_near[n]);
        self.near.extend(island.near.iter().map(both).filter(are_near));
        // From numbers among the members to numbers among those that stay.
        let mut place = Vec::with_capacity(is_near.len());
        for (n, &k) in island.members.iter().enumerate() {
            place.push(self.places.len());
            let (k, body) = (k as usize, &mut bodies[k as usize]);
            body.listed = -NEVER;
            if is_near[n] {
                self.places.push(StepPoses::of(body, k));
            } else if body.phase != Phase::Gone {
                body.list(std::iter::empty());
                world.fly(k, body);
            }
        }
        self.touches.iter_mut().for_each(|(n, _)| *n = place[*n]);
        self.pairs.iter_mut().for_each(|(ab, _)| *ab = ab.map(|n| place[n]));
        self.near.iter_mut().for_each(|ab| *ab = ab.map(|n| place[n]));
    }

    /// Leaves out the points of a crowd that its bodies reach only in curved steps.
    pub(super) fn leave_out_far(&mut self, world: &RigidWorld) {
        fn keep<T>(list: &mut Vec<T>, is_far: &[bool]) {
            let mut far = is_far.iter();
            list.retain(|_| far.next() != Some(&true));
        }
        keep(&mut self.touches, &self.is_far[0]);
        keep(&mut self.loads, &self.is_far[0]);
        keep(&mut self.pairs, &self.is_far[1]);
        keep(&mut self.pair_loads, &self.is_far[1]);
        self.note_rebounds(world);
    }
}

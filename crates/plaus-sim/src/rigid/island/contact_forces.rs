//! What each contact of an island carries: the impulses of a step over its length, the force that a closed form needs,
//! and at rest the solution of static equilibrium.
//!
//! Nobody needs these forces to go on, so they are found only for a listener that asks, in work space of its own.

use super::sleep::are_stopped_exactly;
use crate::links::Links;
use crate::mechanics::{ContactForce, Island, Other};
use crate::rigid::RigidWorld;
use crate::rigid::body_state::{Phase, RigidBodyState};
use crate::rigid::scratch::{RigidScratch, StepPoses};
use crate::rigid::solver::SolverTolerance;
use crate::rigid::tolerances::{CONTACT_MARGIN, LARGE_ISLAND, NO_MOTION, SMALL_ISLAND_DRIFT};
use glam::DVec3;

/// Number of bodies above which static equilibrium is sought by conjugate gradients. Default 40, as in time-stepped
/// islands.
const DIRECT: usize = 40;

/// Gap of the points of an island at rest, over the gap at which bodies touch, which is half of the preset's: as far as
/// points of an island's lasting contacts may be (`heap::mid_step_drift`).
const FARTHEST: f64 = CONTACT_MARGIN + 2.0 * SMALL_ISLAND_DRIFT;

/// Rounds for finding static equilibrium. Default 2000; it is asked for once each time that an island comes to rest.
const SWEEPS: u32 = 2000;

impl RigidWorld {
    /// Calls `each` for the points at which an island that has just settled carries load.
    pub(crate) fn tell_forces(
        &self,
        island: &Island<'_, Self>,
        work: &mut RigidScratch,
        each: &mut dyn FnMut(&ContactForce),
    ) {
        let Island { members, bodies, links, scratch } = *island;
        let phase = |k: &u32| bodies[*k as usize].phase;
        let is_still = |k: &u32| matches!(phase(k), Phase::Rest | Phase::Gone | Phase::Driven);
        if members.iter().all(is_still) {
            if members.iter().any(|k| phase(k) == Phase::Rest) {
                work.balance(self, members, bodies, links);
                work.tell(self, work.kick, each);
            }
            return;
        }
        let step = members.iter().map(|&k| &bodies[k as usize]).find(|body| body.phase == Phase::Step);
        if !scratch.contacts.is_empty() {
            if let Some(step) = step {
                scratch.tell(self, step.expiry - step.path.t, each);
            }
        } else if let [only] = *members {
            self.tell_of_closed_form(only as usize, &bodies[only as usize], each);
        }
    }

    /// The force that a closed form of one ball needs: all of it acts at the point along which it goes.
    fn tell_of_closed_form(&self, index: usize, body: &RigidBodyState, each: &mut dyn FnMut(&ContactForce)) {
        let (spec, pose) = (&self.specs[index], body.pose());
        let acceleration = match body.phase {
            Phase::Glide => body.path.a,
            Phase::Step => (body.ends[1].v - body.ends[0].v) / (body.expiry - body.path.t),
            _ => return,
        };
        let Some(&surface) = body.touching().first() else { return };
        let touch = self.touch(index, &pose, surface);
        let point = pose.x + touch.arm;
        let other = Other::Surface(self.user_surface(surface, point));
        let force = (acceleration - spec.gravity) * spec.mass;
        if force.dot(touch.normal) > self.least_load(&[index]) {
            each(&ContactForce { body: index, other, point, normal: touch.normal, force, gap: touch.gap });
        }
    }

    /// The normal force between bodies that counts as none, in N: what the solver's error may be of the lighter one's
    /// weight.
    fn least_load(&self, bodies: &[usize]) -> f64 {
        let movable = bodies.iter().filter(|&&k| !self.specs[k].is_driven());
        let mass = movable.map(|&k| self.specs[k].mass).fold(f64::INFINITY, f64::min);
        if self.gravity_magnitude == 0.0 { 0.0 } else { NO_MOTION * mass * self.gravity_magnitude }
    }

    /// The bodies of an island at rest, and those at rest that they touch, directly or through others: sleepers have no
    /// links.
    fn at_rest_with(&self, members: &[u32], bodies: &[RigidBodyState]) -> Vec<usize> {
        let lies = |k: usize| bodies[k].phase == Phase::Rest;
        let mut all: Vec<usize> =
            members.iter().map(|&k| k as usize).filter(|&k| bodies[k].phase != Phase::Gone).collect();
        let mut next = 0;
        while let Some(&k) = all.get(next) {
            next += 1;
            if !lies(k) {
                continue;
            }
            for j in (0..bodies.len()).filter(|&j| lies(j) && j != k) {
                let bounding_radius = self.specs[k].bounding_radius
                    + self.specs[j].bounding_radius
                    + CONTACT_MARGIN * self.pair_gap([k, j]);
                if (bodies[k].path.x - bodies[j].path.x).length_squared() > bounding_radius * bounding_radius
                    || all.contains(&j)
                {
                    continue;
                }
                let pair = [k.min(j), k.max(j)];
                if self.gap(pair, pair.map(|k| &bodies[k])) <= CONTACT_MARGIN * self.pair_gap(pair) {
                    all.push(j);
                }
            }
        }
        all.sort_unstable();
        all
    }
}

impl RigidScratch {
    /// Finds impulses that hold an island at rest, and leaves them in `contacts`. Points farther than those that touch
    /// are taken only if these cannot hold it: in islands, rest does not close every gap.
    fn balance(&mut self, world: &RigidWorld, members: &[u32], bodies: &[RigidBodyState], links: &Links) {
        let all = world.at_rest_with(members, bodies);
        for within in [CONTACT_MARGIN, FARTHEST] {
            self.gather_at_rest(world, &all, bodies, links, within);
            let h = self.step_length(world);
            self.kick = h;
            if !h.is_finite() || h <= 0.0 || (self.touches.is_empty() && self.pairs.is_empty()) {
                return self.contacts.clear();
            }
            let push = world.gravity_magnitude * h;
            let most = NO_MOTION * push;
            if are_stopped_exactly(world, self, [h, 0.0, most], SolverTolerance::new(0.1 * most, push), SWEEPS) {
                break;
            }
        }
        self.firsts.clone_from(&self.contacts);
        self.firsts.iter_mut().for_each(|c| c.impulse = DVec3::ZERO);
    }

    /// Lists the points at which these bodies, which are at rest, are within so many gaps of what they touch.
    fn gather_at_rest(
        &mut self,
        world: &RigidWorld,
        all: &[usize],
        bodies: &[RigidBodyState],
        links: &Links,
        within: f64,
    ) {
        self.clear();
        self.places.extend(all.iter().map(|&k| StepPoses::of(&bodies[k], k)));
        for (a, &k) in all.iter().enumerate() {
            let (spec, pose) = (&world.specs[k], bodies[k].pose());
            if !spec.is_driven() {
                world.for_touches(k, &pose, within * spec.gap, |t| self.touches.push((a, t)));
            }
            for (b, &j) in all.iter().enumerate().skip(a + 1) {
                let both = [&bodies[k], &bodies[j]];
                let bounding_radius =
                    spec.bounding_radius + world.specs[j].bounding_radius + within * world.pair_gap([k, j]);
                let is_far = (both[0].path.x - both[1].path.x).length_squared() > bounding_radius * bounding_radius;
                let may_bear = links.contains(k as u32, j as u32) || both.iter().all(|b| b.phase == Phase::Rest);
                if is_far || !may_bear || world.never_touch([k, j], both) {
                    continue;
                }
                let poses = [pose, bodies[j].pose()];
                world.for_pair_touches([k, j], [&poses[0], &poses[1]], within * world.pair_gap([k, j]), |t| {
                    self.pairs.push(([a, b], t));
                });
            }
        }
        self.loads.resize(self.touches.len(), None);
        self.pair_loads.resize(self.pairs.len(), None);
        if !world.joints.bonds.is_empty() {
            let members: Vec<u32> = all.iter().map(|&k| k as u32).collect();
            self.gather_joints(world, &members, bodies);
        }
        self.is_time_stepped = within > CONTACT_MARGIN && all.len() >= LARGE_ISLAND;
        self.newton.in_rounds = self.places.len() > DIRECT;
    }

    /// Calls `each` for the contacts whose impulses, of both kicks of `h` seconds together, bear a load.
    fn tell(&self, world: &RigidWorld, h: f64, each: &mut dyn FnMut(&ContactForce)) {
        for (n, (first, second)) in self.firsts.iter().zip(&self.contacts).enumerate() {
            let force = (first.impulse + second.impulse) / h;
            let (a, b, normal, gap) = if let Some((k, t)) = self.touches.get(n) {
                let place = &self.places[*k];
                (place, Other::Surface(world.user_surface(t.surface, place.start.x + t.arm)), t.normal, t.gap)
            } else if let Some((ab, t)) = self.pairs.get(n - self.touches.len()) {
                let [p, q] = ab.map(|k| &self.places[k]);
                (p, Other::Body(q.body), t.normal, t.gap)
            } else {
                return;
            };
            let least = match b {
                Other::Body(other) => world.least_load(&[a.body, other]),
                Other::Surface(_) => world.least_load(&[a.body]),
            };
            if force.dot(normal) > least {
                let arm = self.touches.get(n).map_or_else(|| self.pairs[n - self.touches.len()].1.arms[0], |t| t.1.arm);
                each(&ContactForce { body: a.body, other: b, point: a.start.x + arm, normal, force, gap });
            }
        }
    }
}

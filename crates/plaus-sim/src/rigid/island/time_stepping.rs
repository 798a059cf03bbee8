//! How time-stepped islands move: in steps of all bodies that may touch each other, in which impacts are part of the
//! step.
//!
//! If each impact in a large island were an event, it would interrupt a step of all bodies, and a thousand balls that
//! are poured into a box make a hundred thousand impacts a second. So a large island takes up all bodies that it may
//! touch within its next step, and finds the impulses of all their contacts at once. With the first kick, no point ends
//! the drift nearer than the gap that lasting contacts keep, whether it touched before or not. With the second, a point
//! that was struck parts at its restitution times its approach before the step (Newton's rule), and impulses lie in
//! Coulomb's cones: this is Moreau's law (Moreau, "Unilateral contact and dry friction in finite freedom dynamics"
//! (1988)) in the steps of `rattle_step.rs`. Of two faces that do not touch yet, it is not known which points will be
//! the first: those that the drift brings into each other are taken up, and the step is made again. An impact is felt
//! at the end of its step, so the error falls with the length of steps, as do the depth and the number of impacts that
//! one step takes together.
//!
//! Bodies with faces are islands of this kind from the number on that the preset says, at draft and standard. There the
//! impulses are found roughly, and the next step corrects what is left. A few bodies rest by impulses that are found
//! exactly, many by what a step with more rounds leaves. Where all skins are flat or balls, the step is that of
//! `crowd_step.rs`, unless that makes energy, or bodies that are about to rest overlap.

use super::crowd::Strike;
use super::crowd_points::is_curved;
use super::sleep;
use super::step_error::step_overlap_time_stepped;
use crate::links::Links;
use crate::mechanics::{Impact, Lookahead, Other, TimeSteppedIsland};
use crate::rigid::body_state::{Phase, RigidBodyState};
use crate::rigid::narrow_phase::contact_point::{ContactPoint, PairContactPoint};
use crate::rigid::scratch::RigidScratch;
use crate::rigid::solver::contact_constraint::ContactConstraint;
use crate::rigid::tolerances::{
    CONTACT_MARGIN, CROWD_REACH, GAP_ERROR_TIME_STEPPED, GENTLE_PUSH, LARGE_ISLAND, MID_STEP_DRIFT,
    MISSED_POINT_ROUNDS, NO_MOTION, TIME_STEP_HALVINGS, TIME_STEP_SLACK, TIME_STEP_TRAVEL, UNSTRUCK_APPROACH,
    WARM_START, WARM_START_OF_NNCG,
};
use crate::rigid::{RigidWorld, ShapeKind};
use crate::shape::Within;
use glam::DVec3;

impl RigidWorld {
    /// How far ahead a large island plans, if it takes up impacts: not where bodies are driven or joined.
    pub(crate) fn ahead(&self, members: &[u32], bodies: &[RigidBodyState]) -> Option<Lookahead> {
        if !self.joints.bonds.is_empty() || self.gravity_magnitude == 0.0 {
            return None;
        }
        let balls = members.iter().filter(|&&k| self.specs[k as usize].is_ball).count();
        let starts_slowly = !self.takes_crowd_steps(members) && self.were_slow(members, bodies);
        if balls < LARGE_ISLAND && (!self.has_faces(members.iter().copied()) || starts_slowly) {
            return None;
        }
        let (mut time, mut fastest, mut gravity) = (f64::INFINITY, 0.0_f64, 0.0_f64);
        for &k in members {
            let (spec, body) = (&self.specs[k as usize], &bodies[k as usize]);
            if spec.is_driven() {
                return None;
            }
            let (speed, turns) = (body.path.v.length(), body.spin.length());
            time = time
                .min((spec.size / self.gravity_magnitude).sqrt())
                .min(TIME_STEP_TRAVEL * spec.size / speed.max(self.accuracy.settle * spec.speed))
                .min(1.0 / turns);
            gravity = gravity.max(spec.strongest_pull());
            fastest = fastest.max(speed + turns * spec.bounding_radius);
        }
        let span = self.accuracy.step * time;
        Some(Lookahead { span, slack: TIME_STEP_SLACK * fastest * span, fall: 0.5 * gravity * span * span })
    }

    /// Whether bodies that are not yet a time-stepped island are all slow enough to be tested for rest: meetings do not
    /// interrupt their steps often.
    fn were_slow(&self, members: &[u32], bodies: &[RigidBodyState]) -> bool {
        members.iter().all(|&k| {
            let body = &bodies[k as usize];
            body.time_step_island == 0 && sleep::may_rest(self, &self.specs[k as usize], body.path.v, body.spin)
        })
    }

    /// Whether so many of these bodies have flat faces that the preset makes meetings part of their steps. A face that
    /// comes down on another is struck at several points, one after the other, and each time would interrupt the steps
    /// of all.
    pub(super) fn has_faces(&self, members: impl Iterator<Item = u32>) -> bool {
        let skin = |k: u32| &self.specs[k as usize].skin;
        let faces = members.map(skin).filter(|s| matches!(s, ShapeKind::Convex { .. }));
        faces.count() >= self.accuracy.crowd as usize
    }

    /// Whether these bodies move in the steps of `crowd_step.rs`. Not if there are curved skins other than balls: the
    /// points at which these touch move about on them, and only the deepest is listed.
    fn takes_crowd_steps(&self, members: &[u32]) -> bool {
        self.has_faces(members.iter().copied()) && !members.iter().any(|&k| is_curved(&self.specs[k as usize]))
    }

    /// How near bodies have to come in a large island's next step, by their velocities, to be looked at closely.
    fn near_ahead(&self, [i, j]: [usize; 2], ahead: &Lookahead) -> f64 {
        let size = self.specs[i].size.min(self.specs[j].size);
        let strays = if self.accuracy.takes_crowd_steps() { CROWD_REACH * size } else { 0.0 };
        ahead.slack + ahead.fall + CONTACT_MARGIN * self.pair_gap([i, j]) + strays
    }

    /// Whether the balls around two bodies may meet within a large island's next step, which begins at `time`. Only
    /// bodies that fly, or whose clocks say so, are known to be there.
    pub(crate) fn may_be_near_ahead(
        &self,
        [i, j]: [usize; 2],
        bodies: [&RigidBodyState; 2],
        time: f64,
        ahead: &Lookahead,
    ) -> bool {
        if bodies.iter().any(|b| b.phase != Phase::Flight && b.path.t != time) {
            return true;
        }
        let [p, q] = bodies.map(|b| (b.path.at(time), b.path.velocity_after(time - b.path.t)));
        let reach = self.specs[i].bounding_radius + self.specs[j].bounding_radius + self.near_ahead([i, j], ahead);
        // What rounding may change is left to the closer look.
        !are_apart(p.0 - q.0, (p.1 - q.1) * ahead.span, reach * (1.0 + 1e-9))
    }

    /// Whether two bodies may touch within a large island's next step.
    pub(crate) fn may_touch_ahead(&self, [i, j]: [usize; 2], [a, b]: [&RigidBodyState; 2], ahead: &Lookahead) -> bool {
        let [s, t] = [i, j].map(|k| &self.specs[k]);
        if s.is_driven() || t.is_driven() || a.phase == Phase::Gone || b.phase == Phase::Gone {
            return false;
        }
        let near = self.near_ahead([i, j], ahead);
        let v = (a.path.v - b.path.v) * ahead.span;
        if are_apart(a.path.x - b.path.x, v, s.bounding_radius + t.bounding_radius + near) {
            return false;
        }
        if s.is_ball && t.is_ball {
            return true;
        }
        let turns = (a.spin.length() * s.bounding_radius + b.spin.length() * t.bounding_radius) * ahead.span;
        self.may_be_within([i, j], [&a.pose(), &b.pose()], near + v.length() + turns)
    }

    /// Gives a time-stepped island its next step.
    pub(crate) fn settle_in_time_step(
        &self,
        island: &TimeSteppedIsland,
        bodies: &mut [RigidBodyState],
        links: &mut Links,
        scratch: &mut RigidScratch,
        report: &mut dyn FnMut(&Impact),
    ) {
        crate::rigid::island::step::lose_sunk(self, island.members, bodies, links);
        scratch.bounce = 1.0;
        scratch.strikes.clear();
        let is_crowd = self.takes_crowd_steps(island.members);
        scratch.gather_time_stepped(self, island, bodies, if is_crowd { CROWD_REACH } else { 0.0 });
        let mut found = None;
        if is_crowd {
            found = scratch.find_crowd_step(self, island.ahead.span.min(scratch.step_length(self)));
        }
        if is_crowd && found.is_none() {
            scratch.leave_out_far(self);
        }
        let mut h = island.ahead.span.min(scratch.step_length(self));
        let is_still = scratch.crowd.fastest <= self.accuracy.rest_residual * self.gravity_magnitude * h;
        let may_rest = sleep::is_slow(self, scratch) && (found.is_none() || is_still);
        if found.is_none() {
            h *= scratch.bend(self, h);
        }
        // Where impulses are not found exactly, what they leave in a step tells.
        let is_rough = scratch.newton.is_time_stepped;
        if may_rest && !is_rough && sleep::is_supported(self, scratch, h) {
            scratch.firsts.clone_from(&scratch.contacts);
            scratch.link_island(self, island, links);
            return scratch.lie_down(self, bodies);
        }
        // Bodies with faces that are still, and that shifts have left in each other, come out exactly.
        let is_deep = may_rest && scratch.has_faces_in_touch() && scratch.least_gap(self) < 0.0;
        match found.filter(|_| !is_deep) {
            Some(found) => {
                h = found;
                scratch.take_crowd_step(h);
            }
            None => h = scratch.take_time_step(self, h),
        }
        if may_rest && is_rough && sleep::is_still(self, scratch, h) {
            scratch.link_island(self, island, links);
            return scratch.lie_down(self, bodies);
        }
        scratch.write(self, bodies, h);
        let collider = NO_MOTION * self.gravity_magnitude * h;
        for (p, m) in scratch.places.iter().zip(&scratch.members) {
            let body = &mut bodies[p.body];
            body.time_step_island = island.members[0] + 1;
            let before = p.start.v.length().max(p.start.w.length() * m.bounding_radius);
            body.stays = before.max(m.fastest()) <= collider;
        }
        scratch.link_island(self, island, links);
        scratch.report_impacts(self, bodies, h, report);
    }
}

impl RigidScratch {
    /// The part of the last step's impulses that is the initial guess.
    pub(crate) fn kept(&self) -> f64 {
        match (self.rebounds.is_empty(), self.newton.in_rounds) {
            (true, _) => 1.0,
            (false, false) => WARM_START,
            (false, true) => WARM_START_OF_NNCG,
        }
    }

    /// How fast a point approaches at the start of the step, up to which speed it settles, both in m/s, and its
    /// restitution. Points of bodies are counted on after those of scenery, as contacts are.
    fn approach(&self, world: &RigidWorld, point: usize) -> Approach {
        if let Some((k, t)) = self.touches.get(point) {
            let (p, spec) = (&self.places[*k], &world.specs[self.places[*k].body]);
            let law = world.law_at(p.body, t, p.start.x + t.arm);
            let speed = -p.start.velocity(t.arm).dot(t.normal);
            return Approach { speed, settles: world.settle_speed(spec, &law), restitution: law.restitution };
        }
        let (ab, t) = &self.pairs[point - self.touches.len()];
        let [p, q] = ab.map(|k| &self.places[k]);
        let both = [p.body, q.body];
        let (settles, restitution) = (world.pair_settle_speed(both), world.pair_law(both).restitution);
        Approach { speed: -t.rate(&p.start, &q.start), settles, restitution }
    }

    /// Notes at which speed each point parts if it is struck.
    pub(super) fn note_rebounds(&mut self, world: &RigidWorld) {
        self.rebounds.clear();
        for point in 0..self.touches.len() + self.pairs.len() {
            let Approach { speed, settles, restitution } = self.approach(world, point);
            let parts = speed * restitution;
            self.rebounds.push(if parts > settles { parts } else { 0.0 });
        }
    }

    /// The fraction of a step in which the gaps of points that touch do not stray from straight lines by more than
    /// 4 times `MID_STEP_DRIFT`, as in [`straightness`](Self::straightness).
    fn bend(&self, world: &RigidWorld, h: f64) -> f64 {
        let mut worst = 0.0_f64;
        for (ab, t) in &self.pairs {
            let [p, q] = ab.map(|k| &self.places[k]);
            let size = world.specs[p.body].size.min(world.specs[q.body].size);
            let rate = t.rate(&p.start, &q.start);
            if t.gap > MID_STEP_DRIFT * size || rate * h > MID_STEP_DRIFT * size {
                continue;
            }
            let [a, b] = [p, q].map(|p| p.drifted(&world.specs[p.body], p.start.v, p.start.w, h).0);
            let bend = world.pair_again([p.body, q.body], [&a, &b], t).gap - t.gap - h * rate;
            worst = worst.max(bend.abs() / size);
        }
        if worst > 4.0 * MID_STEP_DRIFT { (4.0 * MID_STEP_DRIFT / worst).sqrt() } else { 1.0 }
    }

    /// Takes a step of at most `h` seconds, and returns its length. If the push out of overlaps adds energy, it is left
    /// out; if rebounds do, they are.
    fn take_time_step(&mut self, world: &RigidWorld, mut h: f64) -> f64 {
        (self.newton.gives_way, self.newton.is_hard) = (false, false);
        self.closed = world.joint_gap();
        let mut halvings = 0;
        // Polyhedra rest only out of overlaps, so before that the push goes on even if it lifts them.
        let may_lift = self.has_faces_in_touch() && sleep::is_slow(world, self);
        for _ in 0..=TIME_STEP_HALVINGS {
            for (push, bounce) in [(1.0, 1.0), (GENTLE_PUSH, 1.0), (0.0, 1.0), (0.0, 0.0)] {
                (self.push, self.bounce) = (push, bounce);
                if self.try_time_step(world, &mut h, &mut halvings, may_lift) {
                    return h;
                }
            }
            if !may_lift {
                break;
            }
            h *= 0.5;
        }
        self.bounce = 0.0;
        self.give_in(world, h);
        h
    }

    /// Whether a step of `h` seconds keeps the energy, or adds only what lifting the bodies needs. It is halved while
    /// bodies end it too deep in each other.
    fn try_time_step(&mut self, world: &RigidWorld, h: &mut f64, halvings: &mut usize, may_lift: bool) -> bool {
        let mut step = self.drift(world, *h);
        for _ in 0..MISSED_POINT_ROUNDS {
            if !self.take_missed(world, *h) {
                break;
            }
            step = self.drift(world, *h);
        }
        while *halvings < TIME_STEP_HALVINGS && self.misses(world, *h).is_some() {
            (*h, *halvings) = (0.5 * *h, *halvings + 1);
            step = self.drift(world, *h);
        }
        let may_lift = may_lift || self.push < 1.0;
        (may_lift || self.climbs(world).is_none())
            && (self.second_kick(world, &step) || may_lift && self.only_lifts(world))
    }

    /// Takes up points that are not part of the step and that its drift has brought into each other: of two faces that
    /// do not touch yet, it is not known which points will be the first. Balls have only one, which is part of the step
    /// as soon as it may touch. Returns whether there were any.
    fn take_missed(&mut self, world: &RigidWorld, h: f64) -> bool {
        let (touches, pairs) = (self.touches.len(), self.pairs.len());
        let deep = GAP_ERROR_TIME_STEPPED * step_overlap_time_stepped(world);
        let mut missed = Vec::new();
        for &ab in &self.near {
            let [p, q] = ab.map(|k| &self.places[k]);
            let both = [p.body, q.body];
            if both.iter().all(|&k| world.specs[k].is_ball) {
                continue;
            }
            let bounding_radius = world.specs[p.body].bounding_radius + world.specs[q.body].bounding_radius;
            if (p.end.x - q.end.x).length_squared() > bounding_radius * bounding_radius {
                continue;
            }
            let is_new =
                |t: &PairContactPoint| !self.pairs.iter().any(|(other, o)| *other == ab && o.name() == t.name());
            let gap = world.pair_gap(both);
            world.for_pair_touches(
                both,
                [&p.end, &q.end],
                Within { beside: CONTACT_MARGIN * gap, ..(-deep * gap).into() },
                |t| {
                    if is_new(&t) {
                        missed.push((ab, world.pair_again(both, [&p.start, &q.start], &t)));
                    }
                },
            );
        }
        self.pairs.append(&mut missed);
        let mut sunk = Vec::new();
        for (k, p) in self.places.iter().enumerate().filter(|(_, p)| !world.specs[p.body].is_ball) {
            let spec = &world.specs[p.body];
            let within = Within { beside: CONTACT_MARGIN * spec.gap, ..(-deep * spec.gap).into() };
            let is_new =
                |t: &ContactPoint| !self.touches.iter().any(|(other, o)| *other == k && o.surface == t.surface);
            world.for_touches(p.body, &p.end, within, |t| {
                if is_new(&t) {
                    sunk.push((k, world.touch(p.body, &p.start, t.surface)));
                }
            });
        }
        self.touches.append(&mut sunk);
        if (touches, pairs) == (self.touches.len(), self.pairs.len()) {
            return false;
        }
        // What has been found is the first guess of the next attempt.
        let force = |c: &ContactConstraint| Some(c.impulse * (2.0 / h));
        let (of_touches, of_pairs) = self.contacts.split_at(touches);
        self.loads.clear();
        self.loads.extend(of_touches.iter().map(force));
        self.loads.resize(self.touches.len(), None);
        self.pair_loads.clear();
        self.pair_loads.extend(of_pairs.iter().map(force));
        self.pair_loads.resize(self.pairs.len(), None);
        self.note_rebounds(world);
        true
    }

    /// Links the bodies that touch or bear on each other.
    fn link_island(&self, world: &RigidWorld, island: &TimeSteppedIsland, links: &mut Links) {
        let first = self.touches.len();
        let mut bearing: Vec<[u32; 2]> = Vec::new();
        for ((c, old), (ab, t)) in self.contacts[first..].iter().zip(&self.firsts[first..]).zip(&self.pairs) {
            let both = ab.map(|k| self.places[k].body as u32);
            let touches = t.gap <= CONTACT_MARGIN * world.pair_gap(both.map(|k| k as usize));
            if c.impulse != DVec3::ZERO || old.impulse != DVec3::ZERO || touches {
                bearing.push(both);
            }
        }
        bearing.sort_unstable();
        bearing.dedup();
        let is_member = |k: &u32| island.members.binary_search(k).is_ok();
        links.retain(|link| !link.iter().all(is_member) || bearing.binary_search(&link).is_ok());
        links.add(&bearing);
    }

    /// Reports what struck within the step, at the time at which it touched.
    fn report_impacts(&self, world: &RigidWorld, bodies: &[RigidBodyState], h: f64, report: &mut dyn FnMut(&Impact)) {
        for (n, (c, first)) in self.contacts.iter().zip(&self.firsts).enumerate() {
            let of_touch = |(k, t): &(usize, ContactPoint)| {
                let p = &self.places[*k];
                (
                    p,
                    Other::Surface(world.user_surface(t.surface, p.start.x + t.arm)),
                    t.arm,
                    [t.gap, world.specs[p.body].gap],
                )
            };
            let of_pair = |(ab, t): &([usize; 2], PairContactPoint)| {
                let [p, q] = ab.map(|k| &self.places[k]);
                (p, Other::Body(q.body), t.arms[0], [t.gap, world.pair_gap([p.body, q.body])])
            };
            let (p, other, arm, [gap, level]) =
                self.touches.get(n).map_or_else(|| of_pair(&self.pairs[n - self.touches.len()]), of_touch);
            let Approach { mut speed, settles, .. } = self.approach(world, n);
            let mut after = (gap.max(0.0) / speed).min(h);
            let mut impulse = together(first, c);
            if !self.strikes.is_empty() {
                let Some(strike) = self.strikes[n] else { continue };
                Strike { after, speed, impulse } = strike;
            }
            let rebounds = self.rebounds[n] > 0.0;
            if impulse == DVec3::ZERO
                || speed < UNSTRUCK_APPROACH * settles
                || !rebounds && gap <= CONTACT_MARGIN * level
            {
                continue;
            }
            report(&Impact {
                time: bodies[p.body].path.t + after,
                body: p.body,
                other,
                point: p.start.x + arm,
                normal: c.normal,
                impulse,
                approach: speed,
                lasting: !rebounds || self.bounce == 0.0,
            });
        }
    }
}

/// Whether two points, `x` apart, stay farther apart than `reach` while they move by `v`.
fn are_apart(x: DVec3, v: DVec3, reach: f64) -> bool {
    let part = (-x.dot(v) / v.length_squared().max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
    (x + v * part).length() > reach
}

/// How a point comes near what it may touch.
struct Approach {
    speed: f64,
    settles: f64,
    restitution: f64,
}

/// The impulses of both kicks, as if the normal had not turned between them.
fn together(first: &ContactConstraint, second: &ContactConstraint) -> DVec3 {
    let n = second.normal;
    let load = first.impulse.dot(first.normal);
    let across = first.impulse - first.normal * load;
    second.impulse + n * load + (across - n * across.dot(n))
}

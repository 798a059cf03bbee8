//! How heaps move: in steps of all bodies that may touch each other, in which impacts are part of the step.
//!
//! If each impact in a heap were an event, it would interrupt a step of all bodies, and a thousand balls that are
//! poured into a box make a hundred thousand impacts a second. So a heap takes up all bodies that it may touch within
//! its next step, and finds the impulses of all their contacts at once. With the first kick, no point ends the drift
//! nearer than the gap that lasting contacts keep, whether it touched before or not. With the second, a point that was
//! struck parts at its restitution times its approach before the step (Newton's rule), and impulses lie in Coulomb's
//! cones: this is Moreau's law (Moreau, "Unilateral contact and dry friction in finite freedom dynamics" (1988)) in the
//! steps of `kicks.rs`. Of two faces that do not touch yet, it is not known which points will be the first: those that
//! the drift brings into each other are taken up, and the step is made again. An impact is felt at the end of its step,
//! so the error falls with the length of steps, as do the depth and the number of impacts that one step takes together.
//!
//! Bodies with faces are heaps of this kind from the number on that the preset says, at draft and standard. There the
//! impulses are found roughly, and the next step corrects what is left; before they rest, they are found exactly.

use super::body::{Phase, Turning};
use super::coulomb::Contact;
use super::heap;
use super::pile::{CLOSE_IN_CROWDS, SAG, rough_in_crowds};
use super::scratch::{Place, RigidScratch, TOUCHING};
use super::step::GENTLE;
use super::strike::LEFT;
use super::touch::{PairTouch, Touch};
use super::{Rigid, Skin, rest};
use crate::links::{Link, Links};
use crate::mechanics::{Ahead, Crowd, Impact, Other};
use crate::shape::Within;
use glam::DVec3;

/// Distance over its size that the fastest body of a heap may move within the unit of a step's length. Default 1.
const LONGEST: f64 = 1.0;

/// By how much nearer bodies may come within a step than their velocities before it say, over the way of the fastest
/// body. Default 0.5: a ball that is struck by another of the same mass without rebound.
const SLACK: f64 = 0.5;

/// Crowds of more bodies are solved by conjugate gradients instead of Newton's method. Default 40: in a hundred balls,
/// these take a twentieth of the time.
const DIRECT: usize = 40;

/// The part of the last step's impulses from which the next are sought. Default 0.9: where rigid bodies leave open how
/// they share a load, what they carried is forgotten in some ten steps, and the least impulses are found, which equally
/// elastic contacts would have.
const KEPT: f64 = 0.9;

/// The same for conjugate gradients, which find the load of deep heaps in many steps. Default 0.99.
const KEPT_IN_ROUNDS: f64 = 0.99;

/// How often points that a step's drift brought into each other are looked for.
const MISSES: usize = 3;

/// How often a step is halved because bodies end it deeper in each other than they should.
const HALVINGS: usize = 3;

impl Rigid {
    /// How far ahead a heap plans, if it takes up impacts: not where bodies are driven or joined.
    pub(super) fn ahead(&self, members: &[u32], bodies: &[Turning]) -> Option<Ahead> {
        if !self.joints.bonds.is_empty() || self.strength == 0.0 {
            return None;
        }
        let balls = members.iter().filter(|&&k| self.specs[k as usize].is_ball).count();
        if balls < heap::HEAP && (!self.has_faces(members.iter().copied()) || self.were_slow(members, bodies)) {
            return None;
        }
        let (mut time, mut fastest, mut pull) = (f64::INFINITY, 0.0_f64, 0.0_f64);
        for &k in members {
            let (spec, body) = (&self.specs[k as usize], &bodies[k as usize]);
            if spec.is_driven() {
                return None;
            }
            let (speed, turns) = (body.path.v.length(), body.spin.length());
            time = time
                .min((spec.size / self.strength).sqrt())
                .min(LONGEST * spec.size / speed.max(self.accuracy.settle * spec.speed))
                .min(1.0 / turns);
            pull = pull.max(spec.pull.length());
            fastest = fastest.max(speed + turns * spec.reach);
        }
        let span = self.accuracy.step * time;
        Some(Ahead { span, slack: SLACK * fastest * span, fall: 0.5 * pull * span * span })
    }

    /// Whether bodies that are no crowd yet are all slow enough to be tested for rest: meetings do not interrupt their
    /// steps often.
    fn were_slow(&self, members: &[u32], bodies: &[Turning]) -> bool {
        members.iter().all(|&k| {
            let body = &bodies[k as usize];
            body.crowd == 0 && rest::may_rest(self, &self.specs[k as usize], body.path.v, body.spin)
        })
    }

    /// Whether so many of these bodies have flat faces that the preset makes meetings part of their steps. A face that
    /// comes down on another is struck at several points, one after the other, and each time would interrupt the steps
    /// of all.
    fn has_faces(&self, members: impl Iterator<Item = u32>) -> bool {
        let skin = |k: u32| &self.specs[k as usize].skin;
        let faces = members.map(skin).filter(|s| matches!(s, Skin::Convex { .. }));
        faces.count() >= self.accuracy.crowd as usize
    }

    /// Whether two bodies may touch within a heap's next step.
    pub(super) fn may_touch_ahead(&self, [i, j]: [usize; 2], [a, b]: [&Turning; 2], ahead: &Ahead) -> bool {
        let [s, t] = [i, j].map(|k| &self.specs[k]);
        if s.is_driven() || t.is_driven() || a.phase == Phase::Gone || b.phase == Phase::Gone {
            return false;
        }
        let (x, v) = (a.path.x - b.path.x, (a.path.v - b.path.v) * ahead.span);
        let near = ahead.slack + ahead.fall + TOUCHING * self.pair_gap([i, j]);
        let part = (-x.dot(v) / v.length_squared().max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
        if (x + v * part).length() > s.reach + t.reach + near {
            return false;
        }
        if s.is_ball && t.is_ball {
            return true;
        }
        let turns = (a.spin.length() * s.reach + b.spin.length() * t.reach) * ahead.span;
        self.gap_at_least([i, j], [&a.pose(), &b.pose()]) <= near + v.length() + turns
    }

    /// Gives a crowd its next step.
    pub(super) fn settle_in_crowd(
        &self,
        crowd: &Crowd,
        bodies: &mut [Turning],
        links: &mut Links,
        scratch: &mut RigidScratch,
        report: &mut dyn FnMut(&Impact),
    ) {
        super::step::lose_sunk(self, crowd.members, bodies, links);
        scratch.gather_crowd(self, crowd, bodies);
        let mut h = crowd.ahead.span.min(scratch.step_length(self));
        h *= scratch.bend(self, h);
        if rest::is_slow(self, scratch) && rest::is_supported(self, scratch, h) {
            scratch.firsts.clone_from(&scratch.contacts);
            scratch.link_crowd(self, crowd, links);
            return scratch.lie_down(self, bodies);
        }
        let h = scratch.take_crowd_step(self, h);
        scratch.write(self, bodies, h);
        let still = rest::NO_MOTION * self.strength * h;
        for (p, m) in scratch.places.iter().zip(&scratch.members) {
            let body = &mut bodies[p.body];
            body.crowd = crowd.members[0] + 1;
            let before = p.start.v.length().max(p.start.w.length() * m.reach);
            body.stays = before.max(m.fastest()) <= still;
        }
        scratch.link_crowd(self, crowd, links);
        scratch.report_crowd(self, bodies, h, report);
    }
}

impl RigidScratch {
    /// Finds all points at which a crowd may touch within its next step. Bodies without any fly.
    fn gather_crowd(&mut self, world: &Rigid, crowd: &Crowd, bodies: &mut [Turning]) {
        self.clear();
        let Ahead { span, slack, fall } = crowd.ahead;
        let falls = |k: usize, n: DVec3| 0.5 * world.specs[k].pull.dot(n).abs() * span * span;
        let sag = heap::sag(crowd.members.len(), world.accuracy.gap);
        let mut is_near = vec![false; crowd.members.len()];
        let at = |k: usize| crowd.members.partition_point(|&m| (m as usize) < k);
        for (n, &k) in crowd.members.iter().enumerate() {
            let (k, body) = (k as usize, &mut bodies[k as usize]);
            body.sag = sag;
            let spec = &world.specs[k];
            if std::mem::take(&mut body.sleeps) {
                body.lie_still();
            }
            if body.phase == Phase::Gone {
                continue;
            }
            let pose = body.pose();
            let close = TOUCHING * spec.gap + sag * spec.size;
            let slack = if spec.is_ball { slack } else { 0.0 };
            let speed = pose.v.length() + if spec.is_ball { 0.0 } else { pose.w.length() * spec.reach };
            let within = Within { gap: close + slack + fall + speed * span, beside: close };
            world.for_touches(k, &pose, within, |t| {
                let coming = (-pose.velocity(t.arm).dot(t.normal) * span).max(0.0);
                if t.gap <= close + slack + falls(k, t.normal) + coming {
                    self.touches.push((n, t));
                    self.loads.push(body.load(t.surface));
                    is_near[n] = true;
                }
            });
        }
        for link in crowd.near {
            let [i, j] = link.map(|k| k as usize);
            if bodies[i].phase == Phase::Gone || bodies[j].phase == Phase::Gone {
                continue;
            }
            let (a, b) = (bodies[i].pose(), bodies[j].pose());
            let close = TOUCHING * world.pair_gap([i, j]) + sag * world.specs[i].size.min(world.specs[j].size);
            let turns =
                |k: usize, w: DVec3| if world.specs[k].is_ball { 0.0 } else { w.length() * world.specs[k].reach };
            let slack = if world.specs[i].is_ball && world.specs[j].is_ball { slack } else { 0.0 };
            let speed = (a.v - b.v).length() + turns(i, a.w) + turns(j, b.w);
            let within = Within { gap: close + slack + fall + speed * span, beside: close };
            world.for_pair_touches([i, j], [&a, &b], within, |t: PairTouch| {
                let coming = (-t.rate(&a, &b) * span).max(0.0);
                if t.gap <= close + slack + falls(i, t.normal).max(falls(j, t.normal)) + coming {
                    let ab = [at(i), at(j)];
                    self.pairs.push((ab, t));
                    self.pair_loads.push(bodies[i].pair_load(j, t.name()));
                    ab.iter().for_each(|&n| is_near[n] = true);
                }
            });
        }
        let both = |link: &Link| link.map(|k| at(k as usize));
        let are_near = |ab: &[usize; 2]| ab.iter().all(|&n| is_near[n]);
        self.near.extend(crowd.near.iter().map(both).filter(are_near));
        // From numbers among the members to numbers among those that stay.
        let mut place = Vec::with_capacity(is_near.len());
        for (n, &k) in crowd.members.iter().enumerate() {
            place.push(self.places.len());
            let (k, body) = (k as usize, &mut bodies[k as usize]);
            body.listed = -super::body::NEVER;
            if is_near[n] {
                self.places.push(Place::of(body, k));
            } else if body.phase != Phase::Gone {
                body.list(std::iter::empty());
                world.fly(k, body);
            }
        }
        self.touches.iter_mut().for_each(|(n, _)| *n = place[*n]);
        self.pairs.iter_mut().for_each(|(ab, _)| *ab = ab.map(|n| place[n]));
        self.near.iter_mut().for_each(|ab| *ab = ab.map(|n| place[n]));
        self.in_crowd = true;
        self.stays = self.places.iter().all(|p| bodies[p.body].stays && bodies[p.body].path.t >= bodies[p.body].expiry);
        self.note_rebounds(world);
        let has_faces = world.has_faces(self.places.iter().map(|p| p.body as u32));
        // Bodies that are about to rest must first come out of their overlaps.
        self.newton.in_crowd = has_faces && !rest::is_slow(world, self);
        self.newton.in_rounds = self.places.len() > DIRECT && !has_faces;
    }

    /// The part of the last step's impulses that is the initial guess.
    pub(super) fn kept(&self) -> f64 {
        match (self.rebounds.is_empty(), self.newton.in_rounds) {
            (true, _) => 1.0,
            (false, false) => KEPT,
            (false, true) => KEPT_IN_ROUNDS,
        }
    }

    /// How fast a point approaches at the start of the step, up to which speed it settles, both in m/s, and its
    /// restitution. Points of bodies are counted on after those of scenery, as contacts are.
    fn approach(&self, world: &Rigid, point: usize) -> Approach {
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
    fn note_rebounds(&mut self, world: &Rigid) {
        self.rebounds.clear();
        for point in 0..self.touches.len() + self.pairs.len() {
            let Approach { speed, settles, restitution } = self.approach(world, point);
            let parts = speed * restitution;
            self.rebounds.push(if parts > settles { parts } else { 0.0 });
        }
    }

    /// The fraction of a step in which the gaps of points that touch do not stray from straight lines by more than
    /// 4 times `SAG`, as in [`straightness`](Self::straightness).
    fn bend(&self, world: &Rigid, h: f64) -> f64 {
        let mut worst = 0.0_f64;
        for (ab, t) in &self.pairs {
            let [p, q] = ab.map(|k| &self.places[k]);
            let size = world.specs[p.body].size.min(world.specs[q.body].size);
            let rate = t.rate(&p.start, &q.start);
            if t.gap > SAG * size || rate * h > SAG * size {
                continue;
            }
            let [a, b] = [p, q].map(|p| p.drifted(&world.specs[p.body], p.start.v, p.start.w, h).0);
            let bend = world.pair_again([p.body, q.body], [&a, &b], t).gap - t.gap - h * rate;
            worst = worst.max(bend.abs() / size);
        }
        if worst > 4.0 * SAG { (4.0 * SAG / worst).sqrt() } else { 1.0 }
    }

    /// Takes a step of at most `h` seconds, and returns its length. If the push out of overlaps adds energy, it is left
    /// out; if rebounds do, they are.
    fn take_crowd_step(&mut self, world: &Rigid, mut h: f64) -> f64 {
        (self.newton.gives_way, self.newton.is_hard) = (false, false);
        self.closed = super::jointed::CLOSED;
        let mut halvings = 0;
        // Polyhedra rest only out of overlaps, so before that the push goes on even if it lifts them.
        let may_lift = self.has_faces_in_touch() && rest::is_slow(world, self);
        for _ in 0..=HALVINGS {
            for (push, bounce) in [(1.0, 1.0), (GENTLE, 1.0), (0.0, 1.0), (0.0, 0.0)] {
                (self.push, self.bounce) = (push, bounce);
                if self.try_crowd_step(world, &mut h, &mut halvings, may_lift) {
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
    fn try_crowd_step(&mut self, world: &Rigid, h: &mut f64, halvings: &mut usize, may_lift: bool) -> bool {
        let mut step = self.drift(world, *h);
        for _ in 0..MISSES {
            if !self.take_missed(world, *h) {
                break;
            }
            step = self.drift(world, *h);
        }
        while *halvings < HALVINGS && self.misses(world, *h).is_some() {
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
    fn take_missed(&mut self, world: &Rigid, h: f64) -> bool {
        let (touches, pairs) = (self.touches.len(), self.pairs.len());
        let deep = CLOSE_IN_CROWDS * rough_in_crowds(world);
        let mut missed = Vec::new();
        for &ab in &self.near {
            let [p, q] = ab.map(|k| &self.places[k]);
            let both = [p.body, q.body];
            if both.iter().all(|&k| world.specs[k].is_ball) {
                continue;
            }
            let reach = world.specs[p.body].reach + world.specs[q.body].reach;
            if (p.end.x - q.end.x).length_squared() > reach * reach {
                continue;
            }
            let is_new = |t: &PairTouch| !self.pairs.iter().any(|(other, o)| *other == ab && o.name() == t.name());
            let gap = world.pair_gap(both);
            world.for_pair_touches(both, [&p.end, &q.end], Within { gap: -deep * gap, beside: TOUCHING * gap }, |t| {
                if is_new(&t) {
                    missed.push((ab, world.pair_again(both, [&p.start, &q.start], &t)));
                }
            });
        }
        self.pairs.append(&mut missed);
        let mut sunk = Vec::new();
        for (k, p) in self.places.iter().enumerate().filter(|(_, p)| !world.specs[p.body].is_ball) {
            let spec = &world.specs[p.body];
            let within = Within { gap: -deep * spec.gap, beside: TOUCHING * spec.gap };
            let is_new = |t: &Touch| !self.touches.iter().any(|(other, o)| *other == k && o.surface == t.surface);
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
        let force = |c: &Contact| Some(c.impulse * (2.0 / h));
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
    fn link_crowd(&self, world: &Rigid, crowd: &Crowd, links: &mut Links) {
        let first = self.touches.len();
        let mut bearing: Vec<[u32; 2]> = Vec::new();
        for ((c, old), (ab, t)) in self.contacts[first..].iter().zip(&self.firsts[first..]).zip(&self.pairs) {
            let both = ab.map(|k| self.places[k].body as u32);
            let touches = t.gap <= TOUCHING * world.pair_gap(both.map(|k| k as usize));
            if c.impulse != DVec3::ZERO || old.impulse != DVec3::ZERO || touches {
                bearing.push(both);
            }
        }
        bearing.sort_unstable();
        bearing.dedup();
        let is_member = |k: &u32| crowd.members.binary_search(k).is_ok();
        links.retain(|link| !link.iter().all(is_member) || bearing.binary_search(&link).is_ok());
        links.add(&bearing);
    }

    /// Reports what struck within the step, at the time at which it touched.
    fn report_crowd(&self, world: &Rigid, bodies: &[Turning], h: f64, report: &mut dyn FnMut(&Impact)) {
        for (n, (c, first)) in self.contacts.iter().zip(&self.firsts).enumerate() {
            let of_touch = |(k, t): &(usize, Touch)| {
                let p = &self.places[*k];
                (p, Other::Surface(t.surface), t.arm, [t.gap, world.specs[p.body].gap])
            };
            let of_pair = |(ab, t): &([usize; 2], PairTouch)| {
                let [p, q] = ab.map(|k| &self.places[k]);
                (p, Other::Body(q.body), t.arms[0], [t.gap, world.pair_gap([p.body, q.body])])
            };
            let (p, other, arm, [gap, level]) =
                self.touches.get(n).map_or_else(|| of_pair(&self.pairs[n - self.touches.len()]), of_touch);
            let Approach { speed, settles, .. } = self.approach(world, n);
            let impulse = together(first, c);
            let rebounds = self.rebounds[n] > 0.0;
            if impulse == DVec3::ZERO || speed < LEFT * settles || !rebounds && gap <= TOUCHING * level {
                continue;
            }
            report(&Impact {
                time: bodies[p.body].path.t + (gap.max(0.0) / speed).min(h),
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

/// How a point comes near what it may touch.
struct Approach {
    speed: f64,
    settles: f64,
    restitution: f64,
}

/// The impulses of both kicks, as if the normal had not turned between them.
fn together(first: &Contact, second: &Contact) -> DVec3 {
    let n = second.normal;
    let load = first.impulse.dot(first.normal);
    let across = first.impulse - first.normal * load;
    second.impulse + n * load + (across - n * across.dot(n))
}

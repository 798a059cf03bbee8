//! Lasting contact: what bodies that touch something do next, in steps on their island's own adaptive clock.
//!
//! A step is a half kick of gravity and contact impulses, a drift (straight, with free rotation, which keeps momentum),
//! and another half kick. This is the order of RATTLE (Andersen, J. Comput. Phys. 52 (1983)), a method of second order.
//! With the first impulses, every loaded point ends the drift at the wanted gap and, where friction holds it, has not
//! slipped; they are found in [`STEP_PASSES`] passes over the true geometry. With the second impulses, no point
//! approaches or, where friction holds it, slips. Where a point slides, both halves act against the slip over the
//! drift. Impacts of other points during the drift are found exactly on the actual path. If such an impact interrupts a
//! step, the step's impulses count up to that time.

use super::arc_step::arc_time;
use super::{contacts, level_rolling, rolling, sleep};
use crate::links::Links;
use crate::rigid::body_state::{Momentum, PairLoad, Phase, RigidBodyState, Velocities};
use crate::rigid::motion::free_rotation::rotation;
use crate::rigid::narrow_phase::contact_point::to_middle;
use crate::rigid::scratch::{RigidScratch, StepPoses};
use crate::rigid::solver::contact_constraint::{ContactConstraint, SolverBody, response};
use crate::rigid::solver::force_limit::limit_driven;
use crate::rigid::static_shape::StaticShape;
use crate::rigid::tolerances::{
    CONTACT_MARGIN, CRUSHED_OVERLAP, GENTLE_PUSH, JOINT_STEP_LENGTH, LEAST_SHORTENING, LIFT_ROUNDS, LOW_RING_TILT,
    MAX_SHORTENINGS, STEP_RING_TURN, STEP_TRAVEL, TIDY_GAP,
};
use crate::rigid::{BodyDef, RigidWorld};
use glam::{DQuat, DVec3};
use plaus_dist::math;

/// Decides how an island goes on.
pub(crate) fn settle(
    world: &RigidWorld,
    island: &[u32],
    bodies: &mut [RigidBodyState],
    links: &mut Links,
    scratch: &mut RigidScratch,
) {
    lose_sunk(world, island, bodies, links);
    if island.iter().all(|&k| matches!(bodies[k as usize].phase, Phase::Rest | Phase::Gone)) {
        return;
    }
    scratch.gather(world, island, bodies, links);
    let is_held = !scratch.rows.is_empty() || !scratch.stops.is_empty();
    if is_held && world.strike_stops(scratch, bodies) {
        scratch.gather(world, island, bodies, links);
    }
    if let ([place], [(_, touch)], [], []) =
        (&scratch.places[..], &scratch.touches[..], &scratch.leaving[..], &scratch.rows[..])
        && scratch.stops.is_empty()
        && level_rolling::begin(world, place.body, &mut bodies[place.body], touch)
    {
        return;
    }
    if scratch.places.is_empty() || rolling::begin(world, scratch, bodies) {
        return;
    }
    if scratch.articulated_step(world, bodies) {
        return;
    }
    let mut h = scratch.step_length(world);
    scratch.nominal = h;
    scratch.newton.gives_way = false;
    h *= scratch.straightness(world, h);
    h = scratch.until_key(world, h);
    if sleep::is_slow(world, scratch) && sleep::is_supported(world, scratch, h) {
        scratch.lie_down(world, bodies);
        return;
    }
    h = scratch.until_stop(world, h);
    if let Some((projection, shift, turn)) = sleep::lies_nearly_flat(world, scratch) {
        let body = &mut bodies[scratch.places[0].body];
        body.path.x += shift;
        body.turn = (rotation(turn) * body.turn).normalize();
        body.lie_still();
        return body.list(projection.iter().map(|t| t.surface));
    }
    h = scratch.until_arc_end(world, h);
    if !scratch.arc_step(world, bodies, h) && !scratch.pivot_step(world, bodies, h) {
        let known = scratch.pairs.len();
        scratch.take_step(world, bodies, h, contacts::is_large(island));
        // Whoever interrupts the step must bring both, or one of them keeps an impulse that the other does not.
        for (ab, _) in &scratch.pairs[known..] {
            let [i, j] = ab.map(|k| scratch.places[k].body as u32);
            links.insert(i, j);
        }
    }
}

/// Bodies that have sunk below the world's sink are gone, with their contacts.
pub(super) fn lose_sunk(world: &RigidWorld, island: &[u32], bodies: &mut [RigidBodyState], links: &mut Links) {
    for &k in island {
        let body = &mut bodies[k as usize];
        if body.path.x.z < world.sink && body.phase != Phase::Waiting && !world.specs[k as usize].is_driven() {
            (body.path.v, body.spin) = (DVec3::ZERO, DVec3::ZERO);
            body.begin(Phase::Gone, DVec3::ZERO);
            links.retain(|l| !l.contains(&k));
        }
    }
}

impl RigidScratch {
    /// Takes a step of `h` seconds, shortened if points that have just left would come back within it.
    fn take_step(&mut self, world: &RigidWorld, bodies: &mut [RigidBodyState], mut h: f64, is_large: bool) {
        let mut is_forced = true;
        (self.push, self.closed) = (1.0, world.joint_gap());
        // What joints pull back comes back in shorter steps too.
        let least = if self.rows.is_empty() { 0.0 } else { LEAST_SHORTENING * LEAST_SHORTENING * h };
        // A bounce that is over within this part of a step counts as lasting in a large island, all of whose bodies
        // would have to take so short a step.
        let bounce = if is_large { LEAST_SHORTENING * h } else { 0.0 };
        let mut shortened = 0;
        while shortened < MAX_SHORTENINGS {
            let step = self.drift(world, h);
            // Cuboids rest only out of overlaps, so among them the push has to go on.
            let may_give_in = !is_large && !self.has_faces_in_touch();
            let pushes = may_give_in && self.push > 0.0 && self.contacts.iter().any(ContactConstraint::pushes_out);
            match self
                .returns()
                .or_else(|| self.misses(world, h))
                .or_else(|| self.tears(world, h))
                .or_else(|| self.climbs(world))
            {
                // Shorter steps would have to lift the large island just as high.
                Some(_) if is_large && self.climbs(world).is_some() => {
                    is_forced = true;
                    break;
                }
                Some(part) if h * part < bounce && self.returns().is_some() => {
                    is_forced = true;
                    h = bounce;
                    break;
                }
                Some(_) if pushes && self.only_climbs(world, h) => {
                    if self.is_deep(world) {
                        self.second_kick(world, &step);
                        if self.only_rises(world) {
                            return self.write(world, bodies, h);
                        }
                    }
                    self.push_less();
                }
                Some(part) => {
                    is_forced = true;
                    shortened += 1;
                    h *= part;
                    if h < least {
                        break;
                    }
                }
                None => {
                    is_forced = false;
                    if self.second_kick(world, &step) {
                        return self.write(world, bodies, h);
                    }
                    if pushes {
                        if self.is_deep(world) && self.only_rises(world) {
                            return self.write(world, bodies, h);
                        }
                        self.push_less();
                        continue;
                    }
                    shortened += 1;
                    // The impulses cannot be made to give back this energy; a shorter step adds less of it.
                    h *= 0.5;
                }
            }
        }
        // Overlaps are left as they are: pushing the bodies apart added the energy.
        let mut pushes: &[f64] = &[0.0];
        if is_forced {
            // Bounces too fast for any step, which then count as lasting; or a jam, in which the push lifts bodies too
            // high.
            self.take_leaving();
            pushes = if is_large { &[GENTLE_PUSH, 0.0] } else { &[1.0, GENTLE_PUSH, 0.0] };
        }
        for &push in pushes {
            self.push = push;
            let step = self.drift(world, h);
            if self.tears(world, h).is_none() && (self.second_kick(world, &step) || self.only_lifts(world)) {
                return self.write(world, bodies, h);
            }
        }
        self.give_in(world, h);
        self.write(world, bodies, h);
    }

    /// Pushes less out of overlaps, as that adds energy. A shorter step would push as far.
    fn push_less(&mut self) {
        self.push = if self.push > GENTLE_PUSH { GENTLE_PUSH } else { 0.0 };
    }

    /// Whether the drift of a step is refused only because it lifts bodies too high.
    fn only_climbs(&self, world: &RigidWorld, h: f64) -> bool {
        self.returns().or_else(|| self.misses(world, h)).or_else(|| self.tears(world, h)).is_none()
    }

    /// Whether the whole push is made, out of overlaps too deep to lie down in. A step that makes bodies no faster may
    /// then lift them.
    fn is_deep(&self, world: &RigidWorld) -> bool {
        self.push == 1.0 && sleep::is_deep(world, self)
    }

    /// Makes points that are just leaving part of the lasting contact, without a force in the last step.
    fn take_leaving(&mut self) {
        self.touches.append(&mut self.leaving);
        self.loads.resize(self.touches.len(), None);
        let mut both: Vec<_> = self.touches.drain(..).zip(self.loads.drain(..)).collect();
        both.sort_by_key(|(t, _)| t.0);
        (self.touches, self.loads) = both.into_iter().unzip();
        self.pairs.append(&mut self.parting);
        self.pair_loads.resize(self.pairs.len(), None);
    }

    /// A step that ends before any driven body's next key.
    pub(super) fn until_key(&self, world: &RigidWorld, h: f64) -> f64 {
        let left = |p: &StepPoses| world.specs[p.body].drive.as_ref().map(|drive| drive.left(p.clock));
        let motors = self.motors(world).map(|(motor, clock)| motor.left(clock));
        self.places.iter().filter_map(left).chain(motors).fold(h, f64::min)
    }

    /// Whether energy may come and go: some member is driven, or joints hold some. The energy of a swinging body goes
    /// up and down by the steps' error; only taking energy away would slow it down.
    pub(crate) fn is_open(&self, world: &RigidWorld) -> bool {
        !self.rows.is_empty() || self.places.iter().any(|p| world.specs[p.body].is_driven())
    }

    pub(super) fn step_length(&self, world: &RigidWorld) -> f64 {
        // Steps with joints are a quarter as long, so they do not need a board's thinnest piece as a bound.
        let length = |spec: &BodyDef| if self.rows.is_empty() { spec.size } else { spec.span };
        let mut time = f64::INFINITY;
        for p in &self.places {
            let spec = &world.specs[p.body];
            time = time
                .min((length(spec) / world.gravity_magnitude).sqrt())
                .min(length(spec) / p.start.v.length().max(world.accuracy.settle * spec.speed) * STEP_TRAVEL)
                .min(1.0 / p.start.w.length());
        }
        for (k, t) in &self.touches {
            let p = &self.places[*k];
            let spec = &world.specs[p.body];
            if let Some(axis) = world.rim_axis(p.body, t) {
                // The lowest point of a tilted ring runs around it as its axis goes round the normal, however slowly
                // the body turns: a coin that wobbles.
                let axis = p.start.r * axis;
                let round = t.normal.cross(axis);
                let tilt = round.length();
                if tilt * spec.size > CONTACT_MARGIN * spec.gap {
                    let angle = STEP_RING_TURN * math::cbrt(LOW_RING_TILT / tilt).max(1.0);
                    time = time.min(angle * tilt * tilt / p.start.w.cross(axis).dot(round).abs());
                }
            }
            if let Some(arc) = world.front(t.surface) {
                time = time.min(arc_time(world, arc, p, t));
            }
            if let StaticShape::Table(table) = &world.parts[usize::from(t.part)] {
                let at = table.place(p.start.x + t.arm);
                let bend = table.height.at(at.x, at.y).bend;
                let bend = bend[0].abs().max(bend[2].abs()) + bend[1].abs();
                let speed = p.start.velocity(t.arm).length();
                time = time.min(1.0 / (world.gravity_magnitude * bend).sqrt()).min(1.0 / (bend * speed));
            }
        }
        for ([a, b], t) in &self.pairs {
            let (p, q) = (&self.places[*a], &self.places[*b]);
            let speed = (p.start.velocity(t.arms[0]) - q.start.velocity(t.arms[1])).length();
            time = time.min(length(&world.specs[p.body]).min(length(&world.specs[q.body])) / speed);
        }
        if !self.rows.is_empty() {
            time = time.min(self.spring_time(world));
        }
        if !world.joints.bonds.is_empty() {
            time = time.min(self.string_time(world));
        }
        if world.gravity_magnitude == 0.0 && !time.is_finite() {
            time = world.duration;
        }
        world.accuracy.step * if self.rows.is_empty() { time } else { JOINT_STEP_LENGTH * time }
    }

    /// The factor by which to shorten a step if its drift brings back a point that is just leaving.
    pub(super) fn returns(&self) -> Option<f64> {
        let mut worst = 1.0_f64;
        for (k, t) in &self.leaving {
            let p = &self.places[*k];
            let before = p.start.velocity(t.arm).dot(t.normal);
            let drifting = (p.end.v + p.end.w.cross(t.arm)).dot(t.normal);
            if drifting < 0.25 * before {
                worst = worst.min((0.5 * before / (before - drifting)).max(LEAST_SHORTENING));
            }
        }
        for ([a, b], t) in &self.parting {
            let (p, q) = (&self.places[*a], &self.places[*b]);
            let (before, drifting) = (t.rate(&p.start, &q.start), t.rate(&p.end, &q.end));
            if drifting < 0.25 * before {
                worst = worst.min((0.5 * before / (before - drifting)).max(LEAST_SHORTENING));
            }
        }
        (worst < 1.0).then_some(worst)
    }

    /// Puts members at their starts with the velocities that `free` gives, and contacts without impulses; the contacts
    /// are to act for `time` seconds.
    pub(super) fn prepare(
        &mut self,
        world: &RigidWorld,
        time: f64,
        free: impl Fn(&BodyDef, &StepPoses) -> (DVec3, DVec3),
    ) {
        self.newton.is_hard &= self.newton.is_time_stepped;
        self.members.clear();
        self.members.extend(self.places.iter().map(|p| {
            let spec = &world.specs[p.body];
            let (v, w) = free(spec, p);
            SolverBody::of(spec, &p.start.r, v, w)
        }));
        self.contacts.clear();
        for (a, t) in &self.touches {
            let (p, m) = (&self.places[*a], &self.members[*a]);
            let law = world.law_at(p.body, t, p.start.x + t.arm);
            let k = response(m.inverse_mass, &m.inverse_inertia, t.arm);
            let contact = ContactConstraint::new(*a, None, [t.arm, DVec3::ZERO], t.normal, law.friction, k);
            self.contacts.push(contact.gripping(&law, world.still(p.body), |_| p.start.velocity(t.arm)));
        }
        for ([a, b], t) in &self.pairs {
            let arms = to_middle(t.arms, [a, b].map(|k| self.places[*k].start.x));
            let (both, law) = ([*a, *b].map(|k| &self.places[k]), self.pair_law(world, [*a, *b]));
            let before = |c: &ContactConstraint| c.relative(|k| [self.places[k].start.v, self.places[k].start.w]);
            let still = both.map(|p| world.still(p.body));
            let contact = self.pair_contact(world, [*a, *b], arms, t.normal);
            self.contacts.push(contact.gripping(law, still[0].min(still[1]), before));
        }
        self.prepare_joints(world, time);
        self.limit_driven(world, time);
    }

    /// Limits what driven bodies press with within `time` seconds.
    pub(crate) fn limit_driven(&mut self, world: &RigidWorld, time: f64) {
        let push = |p: &StepPoses| {
            let spec = &world.specs[p.body];
            spec.drive.as_ref().map_or(0.0, |drive| drive.push(p.clock, spec.bounding_radius))
        };
        let gravity = self.places.iter().map(push).fold(world.gravity_magnitude, f64::max);
        let slow = self.places.iter().map(|p| world.specs[p.body].speed).fold(0.0, f64::max) * world.accuracy.settle;
        limit_driven(&mut self.contacts, &self.members, time.abs(), gravity * time.abs() + slow);
    }

    /// Rest: without velocity, flat if the ground is flat, and lifted out of overlaps that steps have left.
    pub(super) fn lie_down(&self, world: &RigidWorld, bodies: &mut [RigidBodyState]) {
        for (k, p) in self.places.iter().enumerate().filter(|(_, p)| !world.specs[p.body].is_driven()) {
            let body = &mut bodies[p.body];
            body.set_motion(&world.specs[p.body], Velocities::default());
            body.begin(Phase::Rest, DVec3::ZERO);
            let touches = || self.touches.iter().filter(|t| t.0 == k).map(|t| &t.1);
            body.list(touches().map(|t| t.surface));
            let tidy = TIDY_GAP * world.specs[p.body].gap;
            let (low, high) =
                touches().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), t| (l.min(t.gap), h.max(t.gap)));
            if (low >= -tidy && high - low <= tidy) || self.has_faces_in_touch() || !self.rows.is_empty() {
                continue;
            }
            if let Some((shift, turn)) = sleep::flatten(touches()) {
                body.path.x += shift;
                body.turn = (rotation(turn) * body.turn).normalize();
            }
            // Straight up, if that helps: it brings no other point of uneven ground nearer.
            let spec = &world.specs[p.body];
            let up = if spec.gravity_magnitude > 0.0 { -spec.gravity / spec.gravity_magnitude } else { DVec3::ZERO };
            for _ in 0..LIFT_ROUNDS {
                let pose = body.pose();
                let again = touches().map(|t| world.touch(p.body, &pose, t.surface)).filter(|t| t.gap < 0.0);
                let Some(t) = again.min_by(|a, b| a.gap.total_cmp(&b.gap)) else { break };
                let rise = up.dot(t.normal);
                body.path.x -= if rise > 0.1 { up * (t.gap / rise) } else { t.normal * t.gap };
            }
        }
    }

    pub(crate) fn write(&self, world: &RigidWorld, bodies: &mut [RigidBodyState], h: f64) {
        for (k, (p, m)) in self.places.iter().zip(&self.members).enumerate() {
            let body = &mut bodies[p.body];
            body.pair_loads.clear();
            if let Some(drive) = &world.specs[p.body].drive {
                drive.hold(body, h);
                continue;
            }
            // In a time-stepped island, points that carry nothing come last: only the first few are kept.
            let those = |carry: bool| {
                let points = self.contacts.iter().zip(&self.touches);
                points.filter(move |(c, t)| t.0 == k && carry != (self.is_time_stepped && c.impulse == DVec3::ZERO))
            };
            let points = || those(true).chain(those(false));
            body.set_loads(points().map(|(c, _)| c.impulse * (2.0 / h)));
            let inertia = &world.specs[p.body].inertia;
            let momentum = |turn: DQuat, v: DVec3, w: DVec3| Momentum { v, l: inertia.momentum(turn, w) };
            body.ends = [momentum(p.turn, p.start.v, p.start.w), momentum(p.end_turn, m.v, m.w)];
            body.angular_momentum_transport = DVec3::ZERO;
            (body.path.v, body.spin) = (p.end.v, p.spin);
            body.begin(Phase::Step, DVec3::ZERO);
            body.expiry = body.path.t + h;
            body.list(points().map(|(_, t)| t.1.surface));
        }
        let first_pair = self.touches.len();
        for ((c, first), (ab, t)) in self.contacts[first_pair..].iter().zip(&self.firsts[first_pair..]).zip(&self.pairs)
        {
            let [p, q] = ab.map(|k| &self.places[k]);
            let load = PairLoad { other: q.body as u32, name: t.name(), force: c.impulse * (2.0 / h) };
            bodies[p.body].pair_loads.push(load);
            self.pass(world, bodies, *ab, first.impulse + c.impulse, h, self.most_passed(world, *ab));
        }
        self.pass_joints(world, bodies, h);
        self.note_crushed(world, bodies);
    }

    /// Notes which bodies driven ones have left no way, where the contact gave way in this step.
    fn note_crushed(&self, world: &RigidWorld, bodies: &mut [RigidBodyState]) {
        let pairs = self.pairs.iter().map(|(ab, t)| (*ab, -t.gap));
        let rows = self.rows.iter().map(|row| ([row.a, row.b.unwrap_or(row.a)], self.apart(world, row)));
        for (c, (ab, depth)) in self.contacts[self.touches.len()..].iter().zip(pairs.chain(rows)) {
            let [a, b] = ab.map(|k| self.places[k].body);
            if c.compliance > 0.0 && depth > CRUSHED_OVERLAP * world.specs[a].size.min(world.specs[b].size) {
                let (body, by) = if world.specs[a].is_driven() { (b, a) } else { (a, b) };
                bodies[body].crushed_by = Some(by as u32);
            }
        }
    }
}

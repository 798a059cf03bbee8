//! The two halves of a step of lasting contact: a kick with the drift after it, and the second kick.

use super::step_error::step_overlap_time_stepped;
use crate::rigid::RigidWorld;
use crate::rigid::body_state::{Pose, RigidBodyState};
use crate::rigid::joints::joint::JointRowKind;
use crate::rigid::narrow_phase::contact_point::{ContactPoint, PairContactPoint, to_middle};
use crate::rigid::scratch::RigidScratch;
use crate::rigid::solver::contact_constraint::{ConstraintKind, ContactConstraint, SolverBody, response};
use crate::rigid::solver::slip::Stiction;
use crate::rigid::solver::{SolverTolerance, solve};
use crate::rigid::static_shape::StaticShape;
use crate::rigid::tolerances::{
    CONTACT_MARGIN, GAP_ERROR, GAP_ERROR_TIME_STEPPED, KEPT_GAP, MAX_MOMENTUM_TRANSPORT, NO_MOTION, PUSH_OUT_SPEED,
    STEP_PASSES, STEP_PASSES_TIME_STEPPED, STEP_PASSES_WITH_CUBOIDS, STEP_PASSES_WITH_JOINTS,
};
use crate::shape::ContactSphere;
use glam::DVec3;

/// A step in progress.
#[derive(Debug, Clone, Copy)]
pub(crate) struct FirstHalf {
    enough: SolverTolerance,
    h: f64,
}

impl RigidScratch {
    /// The first half of a step of `h` seconds (negative for one back in time) from the starts: a kick, and a drift
    /// whose ends are left in `places`. Call the second half, whose velocities are left in `members`, only if it is
    /// worth doing.
    pub(crate) fn drift(&mut self, world: &RigidWorld, h: f64) -> FirstHalf {
        let fine = if self.newton.is_time_stepped { f64::INFINITY } else { self.fine(world) };
        let (push, fine) = (world.gravity_magnitude * h.abs(), fine.min(self.most_apart(world)) / h.abs());
        let enough = SolverTolerance::new((world.accuracy.sweep_tolerance * push).min(fine), push);
        let step = FirstHalf { enough, h };
        self.prepare(world, 0.5 * h, |spec, p| p.kicked(spec, h, 0.5));
        self.aim(world, h);
        self.guess_loads(self.kept() * 0.5 * h);
        self.newton.gives_way |= self.contacts.iter().any(ContactConstraint::is_hard_pressed);
        let mut passes = if !self.rows.is_empty() {
            STEP_PASSES_WITH_JOINTS
        } else if self.newton.is_time_stepped && self.has_faces_in_touch() {
            STEP_PASSES_TIME_STEPPED
        } else if self.has_faces_in_touch() || self.is_at_ledges() {
            STEP_PASSES_WITH_CUBOIDS
        } else {
            STEP_PASSES
        };
        let is_short = passes == STEP_PASSES;
        let mut pass = 0;
        loop {
            solve(&mut self.contacts, &mut self.members, &mut self.newton, enough, world.accuracy.sweeps);
            for (p, m) in self.places.iter_mut().zip(&self.members) {
                p.spin = m.w;
                (p.end, p.end_turn) = p.drifted(&world.specs[p.body], m.v, m.w, h);
            }
            pass += 1;
            if is_short && pass == passes && passes < STEP_PASSES_WITH_CUBOIDS && self.strays(world) {
                passes += 1;
            }
            if pass == passes || !self.correct(world, h) {
                return step;
            }
        }
    }

    /// Whether a point that carries load ends the drift so far from a fixed part that the contact would be lost, or as
    /// deep in it: a body that pivots about an edge would fly, and strike again, or sink in.
    fn strays(&self, world: &RigidWorld) -> bool {
        self.contacts.iter().zip(&self.touches).any(|(c, (k, t))| {
            let (p, spec) = (&self.places[*k], &world.specs[self.places[*k].body]);
            c.impulse != DVec3::ZERO && world.touch(p.body, &p.end, t.surface).gap.abs() > CONTACT_MARGIN * spec.gap
        })
    }

    /// Gives contacts the forces of the last step for this time: a good initial guess.
    pub(super) fn guess_loads(&mut self, time: f64) {
        for (c, load) in self.contacts.iter_mut().zip(self.loads.iter().chain(&self.pair_loads)) {
            if let Some(load) = load
                && c.target > -f64::MAX
            {
                (c.impulse, c.is_known) = (*load * time, true);
                c.push(&mut self.members, c.impulse);
            }
        }
    }

    /// Says what each contact has to achieve over a drift of `h` seconds, and guesses by how much its mean velocity
    /// will differ from its velocity at the start. Outside of stacks, no point is pushed out of an overlap faster than
    /// the weight of the second kick takes away again: of a faster push in a short step, some would stay.
    fn aim(&mut self, world: &RigidWorld, h: f64) {
        let is_pile = self.has_faces_in_touch();
        for (c, (k, t)) in self.contacts.iter_mut().zip(&self.touches) {
            let (p, spec) = (&self.places[*k], &world.specs[self.places[*k].body]);
            let most = PUSH_OUT_SPEED * world.accuracy.settle * spec.speed;
            let most = if is_pile || spec.gravity_magnitude == 0.0 {
                most
            } else {
                most.min(0.5 * spec.gravity_magnitude * h.abs())
            };
            c.target = ((KEPT_GAP * spec.gap - t.gap) / h).min(most);
            // A point fixed in the body turns about its centre of gravity.
            if let Some(sphere) = world.fixed_sphere(p.body, t) {
                let centre = t.arm + t.normal * sphere.radius;
                c.bias = p.start.w.cross(p.start.w.cross(centre)) * (0.5 * h);
            }
        }
        let first_pair = self.touches.len();
        for (c, (ab, t)) in self.contacts[first_pair..].iter_mut().zip(&self.pairs) {
            let at = ab.map(|k| (&self.places[k], &self.members[k]));
            let begin = at.map(|(p, m)| Pose { v: m.v, w: m.w, ..p.start });
            let end = at.map(|(p, m)| p.drifted(&world.specs[p.body], m.v, m.w, h).0);
            let both = at.map(|(p, _)| p.body);
            let after = world.pair_again(both, [&end[0], &end[1]], t);
            c.target = (world.pair_goal(both, t.gap, h) - t.gap) / h;
            c.bias = t.mean_velocity(&after, &begin, &end, h) - c.velocity(&self.members);
        }
        if !self.rows.is_empty() {
            self.aim_joints(world, h, |p, m| p.drifted(&world.specs[p.body], m.v, m.w, h).0);
        }
        if self.push < 1.0 {
            for c in self.contacts.iter_mut().filter(|c| c.pushes_out()) {
                c.target *= self.push;
            }
        }
    }

    /// Learns from the end of the drift how the mean velocities at the contacts differ from those at its start. Returns
    /// whether they are still too far from their targets.
    fn correct(&mut self, world: &RigidWorld, h: f64) -> bool {
        let mut off = false;
        let close = if self.newton.is_time_stepped {
            GAP_ERROR_TIME_STEPPED * step_overlap_time_stepped(world)
        } else {
            GAP_ERROR
        };
        for (c, (k, t)) in self.contacts.iter_mut().zip(&self.touches) {
            let p = &self.places[*k];
            let spec = &world.specs[p.body];
            let after = world.touch(p.body, &p.end, t.surface);
            let mean = t.mean_velocity(&after, world.fixed_sphere(p.body, t), [&p.begin(), &p.end], h);
            let missing = c.target - mean.dot(t.normal);
            off |= (missing > 0.0 || c.impulse != DVec3::ZERO) && missing.abs() * h > close * spec.gap;
            c.bias = mean - c.velocity(&self.members);
        }
        let first_pair = self.touches.len();
        for (c, (ab, t)) in self.contacts[first_pair..].iter_mut().zip(&self.pairs) {
            let at = ab.map(|k| &self.places[k]);
            let both = at.map(|p| p.body);
            let after = world.pair_again(both, [&at[0].end, &at[1].end], t);
            let mean = t.mean_velocity(&after, &at.map(|p| p.begin()), &at.map(|p| p.end), h);
            let missing = c.target - mean.dot(t.normal);
            let matters = c.compliance == 0.0 && (missing > 0.0 || c.impulse != DVec3::ZERO);
            off |= matters && missing.abs() * h > close * world.pair_gap(both);
            c.bias = mean - c.velocity(&self.members);
        }
        off | (!self.rows.is_empty() && self.aim_joints(world, h, |p, _| p.end) > 1.0)
    }

    /// A step whose impulses all act at its start, plastic, wherever the drift then leads. It is the last resort when
    /// bodies are so deep in an edge that no drift goes where its start says. Contacts only take energy.
    pub(super) fn give_in(&mut self, world: &RigidWorld, h: f64) {
        self.prepare(world, h, |spec, p| p.kicked(spec, h, 1.0));
        if self.is_time_stepped {
            // Points that do not touch yet may come to touch.
            let gaps = self.touches.iter().map(|t| t.1.gap).chain(self.pairs.iter().map(|t| t.1.gap));
            self.contacts.iter_mut().zip(gaps).for_each(|(c, gap)| c.target = -gap.max(0.0) / h);
        }
        let push = world.gravity_magnitude * h;
        let enough = SolverTolerance::new(world.accuracy.sweep_tolerance * push, push);
        solve(&mut self.contacts, &mut self.members, &mut self.newton, enough, world.accuracy.sweeps);
        for (p, m) in self.places.iter_mut().zip(&mut self.members) {
            p.spin = m.w;
            (p.end, p.end_turn) = p.drifted(&world.specs[p.body], m.v, m.w, h);
            m.w = p.end.w;
        }
        // To whoever interrupts the step it is two equal kicks.
        self.contacts.iter_mut().for_each(|c| c.impulse *= 0.5);
        self.firsts.clone_from(&self.contacts);
    }

    /// The second kick, over the points that still touch at the ends. Returns whether energy is kept.
    pub(crate) fn second_kick(&mut self, world: &RigidWorld, step: &FirstHalf) -> bool {
        for (m, p) in self.members.iter_mut().zip(&self.places) {
            let spec = &world.specs[p.body];
            let (v, w) = p.kicked_again(spec, step.h);
            *m = SolverBody::of(spec, &p.end.r, v, w);
        }
        // Each half of the step has the contacts' impulses.
        self.slow_down(world, 2.0);
        self.firsts.clone_from(&self.contacts);
        for c in 0..self.contacts.len() {
            let old = self.contacts[c];
            if let Some(row) = c.checked_sub(self.touches.len() + self.pairs.len()) {
                let row = self.rows[row];
                let (mut next, goes_on) = self.row_at_end(world, &row, 0.5 * step.h);
                next.target = self.sought(world, &row, step.h)[1];
                if row.part == JointRowKind::Spring {
                    next.hold = ConstraintKind::DryFriction(old.impulse.length());
                    self.pull_at_end(world, &row, &next, 0.5 * step.h);
                }
                if old.impulse != DVec3::ZERO || goes_on {
                    next.impulse = next.project(old.impulse).0;
                    next.push(&mut self.members, next.impulse);
                } else {
                    next.target = -f64::MAX;
                }
                self.contacts[c] = next;
                continue;
            }
            let (mut next, gap, touching) = if let Some((a, t)) = self.touches.get(c) {
                let (p, m) = (&self.places[*a], &self.members[*a]);
                let after = world.touch(p.body, &p.end, t.surface);
                let k = response(m.inverse_mass, &m.inverse_inertia, after.arm);
                (
                    ContactConstraint::new(*a, None, [after.arm, DVec3::ZERO], after.normal, old.friction, k),
                    after.gap,
                    world.specs[p.body].gap,
                )
            } else {
                let (ab, t) = &self.pairs[c - self.touches.len()];
                let ab = *ab;
                let [p, q] = ab.map(|k| &self.places[k]);
                let after = world.pair_again([p.body, q.body], [&p.end, &q.end], t);
                (
                    self.pair_contact(world, ab, to_middle(after.arms, [p.end.x, q.end.x]), after.normal),
                    after.gap,
                    world.pair_gap([p.body, q.body]),
                )
            };
            if old.impulse != DVec3::ZERO || gap <= CONTACT_MARGIN * touching {
                next.hold_slip(old.slip_direction());
                next.stiction = old.stiction.map(|stiction| Stiction { slip: stiction.slip_after, ..stiction });
                if old.impulse != DVec3::ZERO
                    && let Some(rebound) = self.rebounds.get(c)
                {
                    next.target = rebound * self.bounce;
                }
                (next.impulse, next.is_known) = (old.impulse, old.is_known);
                next.push(&mut self.members, next.impulse);
            } else {
                // The point has left: no impulse, whatever its velocity.
                next.target = -f64::MAX;
            }
            self.contacts[c] = next;
        }
        self.limit_driven(world, 0.5 * step.h);
        solve(&mut self.contacts, &mut self.members, &mut self.newton, step.enough, world.accuracy.sweeps);
        self.resist(world, NO_MOTION * world.gravity_magnitude * step.h, step.enough, world.accuracy.sweeps);
        let mut firsts = std::mem::take(&mut self.firsts);
        for (first, (ab, _)) in firsts[self.touches.len()..].iter_mut().zip(&self.pairs) {
            // Taking back an impulse between bodies that have moved on acts on both at one point too.
            first.arms = to_middle(first.arms, ab.map(|k| self.places[k].end.x));
        }
        let is_kept = self.project_energy(world, &mut firsts, step.enough);
        self.firsts = firsts;
        is_kept
    }

    /// Notes what an impulse between two bodies, made during a step, adds to their angular momenta on the way, unless
    /// half of it is more than `most`. Each takes a share in proportion to its inertia: a light body between a heavy
    /// one and the ground carries impulses that would otherwise spin it round when the step is interrupted.
    pub(crate) fn pass(
        &self,
        world: &RigidWorld,
        bodies: &mut [RigidBodyState],
        ab: [usize; 2],
        impulse: DVec3,
        h: f64,
        most: f64,
    ) {
        let [p, q] = ab.map(|k| &self.places[k]);
        let whole = (p.end.v - q.end.v).cross(impulse) * h;
        if 0.5 * whole.length() <= most {
            let inertia = |body: usize| world.specs[body].inertia.moments.max_element();
            let (own, other) = (inertia(p.body), inertia(q.body));
            bodies[p.body].angular_momentum_transport += whole * (own / (own + other));
            bodies[q.body].angular_momentum_transport += whole * (other / (own + other));
        }
    }

    /// The most that a contact's impulse may [pass](Self::pass): a part of the angular momentum that the two bodies'
    /// speeds in a step can hold. Bodies that wedge each other against fixed parts may carry impulses far larger than
    /// any change of momentum, as rigid bodies' forces are not unique there. An interrupted step would make energy of
    /// those.
    pub(super) fn most_passed(&self, world: &RigidWorld, ab: [usize; 2]) -> f64 {
        let most = |k: usize| {
            let (p, m, spec) = (&self.places[k], &self.members[k], &world.specs[self.places[k].body]);
            let speeds = [p.start.v, p.end.v, m.v].map(DVec3::length).iter().sum::<f64>();
            let spins = [p.start.w, p.spin, m.w].map(DVec3::length).iter().sum::<f64>();
            if spec.is_driven() {
                0.0
            } else {
                spec.mass * spec.bounding_radius * (speeds + spec.bounding_radius * spins)
            }
        };
        MAX_MOMENTUM_TRANSPORT * ab.map(most).iter().sum::<f64>()
    }
}

impl RigidWorld {
    /// The ball at a point of contact if it is fixed in its body, so not a point of a ring or of an edge.
    pub(super) fn fixed_sphere(&self, body: usize, t: &ContactPoint) -> Option<&ContactSphere> {
        let (spec, point) = (&self.specs[body], t.point()?);
        let moves = spec.is_ball
            || !spec.is_fixed_point(point) && !matches!(self.parts[usize::from(t.part)], StaticShape::Table(_));
        if moves { None } else { spec.contact_spheres.get(point) }
    }
}

impl ContactPoint {
    /// Mean velocity at the point over a drift of `h` seconds to `after`: along the normal that of the gap, across it
    /// the velocity of the slip.
    fn mean_velocity(&self, after: &Self, sphere: Option<&ContactSphere>, [begin, end]: [&Pose; 2], h: f64) -> DVec3 {
        let n = self.normal;
        let mean = match sphere {
            // A ball fixed in the body: the path of its centre is known, and it rolls.
            Some(f) => {
                let middle = |t: &Self| t.arm + t.normal * f.radius;
                let way = end.x - begin.x + (middle(after) - middle(self));
                way / h - (begin.w.cross(n) + end.w.cross(after.normal)) * (0.5 * f.radius)
            }
            _ => (begin.velocity(self.arm) + end.velocity(after.arm)) * 0.5,
        };
        mean + n * ((after.gap - self.gap) / h - mean.dot(n))
    }
}

impl PairContactPoint {
    /// The same between two bodies.
    fn mean_velocity(&self, after: &Self, begin: &[Pose; 2], end: &[Pose; 2], h: f64) -> DVec3 {
        let n = self.normal;
        let slip = |t: &Self, [a, b]: &[Pose; 2]| a.velocity(t.arms[0]) - b.velocity(t.arms[1]);
        let mean = (slip(self, begin) + slip(after, end)) * 0.5;
        mean + n * ((after.gap - self.gap) / h - mean.dot(n))
    }
}

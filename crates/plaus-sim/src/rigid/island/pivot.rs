//! A body alone that turns about a point or a line which friction holds: about a corner or an edge of its own, or
//! rolling on a rounded one.
//!
//! While the contact holds, the body's angular velocity ω determines its motion: the arm `r` from the centre of gravity
//! to the contact has no velocity at its end, so `v = r × ω`. A rounded corner with centre `c` and radius ρ has
//! `r = c − ρ n`. With the force `F = m (v̇ − g)`, Euler's equation is
//!
//! `(I + m (r² − r rᵀ)) ω̇ = −ω × I ω + m r × ((ω × c) × ω − g)`;
//!
//! on a line of contact, only its component along the line counts. The equation is integrated by the Runge–Kutta method
//! of fourth order, which is far more accurate than a step of RATTLE and takes less time. The step is taken only if the
//! force is within the friction cone at its start and at its end; otherwise, and wherever more is going on, RATTLE
//! takes it.

use crate::rigid::body_state::RigidBodyState;
use crate::rigid::motion::free_rotation::{Inertia, drift};
use crate::rigid::motion::kinematic::rotation_vector;
use crate::rigid::narrow_phase::contact_point::ContactPoint;
use crate::rigid::scratch::{RigidScratch, StepPoses};
use crate::rigid::static_shape::StaticShape;
use crate::rigid::tolerances::{
    CONTACT_MARGIN, GAP_ERROR, KEPT_GAP, PIVOT_ENERGY_ERROR, PIVOT_NORMAL_ERROR, PIVOT_SLIP, PIVOT_SLOW,
    PIVOT_SPIN_ROUNDS, PIVOT_SUBSTEPS, PIVOT_TURN_ERROR,
};
use crate::rigid::{BodyDef, RigidWorld};
use glam::{DMat3, DQuat, DVec3, DVec4};

/// A body whose contact holds.
struct Pivot<'w> {
    mass: f64,
    inertia: &'w Inertia,
    gravity: DVec3,
    /// Centre of the rounded corner, in body axes from the centre of gravity; and its radius.
    centre: DVec3,
    radius: f64,
    normal: DVec3,
    /// The line of contact, if there are two points.
    line: Option<DVec3>,
}

/// Orientation, angular velocity, and how far the centre of the corner has rolled.
#[derive(Clone, Copy)]
struct Motion {
    turn: DQuat,
    w: DVec3,
    rolled: DVec3,
}

impl Pivot<'_> {
    fn arm(&self, turn: DQuat) -> DVec3 {
        turn * self.centre - self.normal * self.radius
    }

    fn velocity(&self, m: &Motion) -> DVec3 {
        self.arm(m.turn).cross(m.w)
    }

    fn kinetic(&self, m: &Motion) -> f64 {
        0.5 * (self.mass * self.velocity(m).length_squared() + m.w.dot(self.inertia.momentum(m.turn, m.w)))
    }

    /// Angular acceleration, and the force at the contact.
    fn acceleration(&self, m: &Motion) -> (DVec3, DVec3) {
        let (c, w) = (m.turn * self.centre, m.w);
        let r = c - self.normal * self.radius;
        let centripetal = w.cross(c).cross(w);
        let right = r.cross(centripetal - self.gravity) * self.mass - w.cross(self.inertia.momentum(m.turn, w));
        let times = |x: DVec3| self.inertia.momentum(m.turn, x) + (x * r.length_squared() - r * r.dot(x)) * self.mass;
        let turns = match self.line {
            Some(e) => e * (e.dot(right) / e.dot(times(e))),
            None => DMat3::from_cols(times(DVec3::X), times(DVec3::Y), times(DVec3::Z)).inverse() * right,
        };
        (turns, (r.cross(turns) + centripetal - self.gravity) * self.mass)
    }

    /// Rates of change, per component of the quaternion.
    fn rates(&self, m: &Motion) -> (DVec4, DVec3, DVec3) {
        let turn = DQuat::from_vec4(m.w.extend(0.0)) * m.turn;
        (DVec4::from(turn) * 0.5, self.acceleration(m).0, m.w.cross(self.normal) * self.radius)
    }

    /// The motion `h` seconds later.
    fn after(&self, start: &Motion, h: f64) -> Motion {
        let add = |m: &Motion, k: &(DVec4, DVec3, DVec3), h: f64| Motion {
            turn: DQuat::from_vec4(DVec4::from(m.turn) + k.0 * h),
            w: m.w + k.1 * h,
            rolled: m.rolled + k.2 * h,
        };
        let mut m = *start;
        let h = h / f64::from(PIVOT_SUBSTEPS);
        for _ in 0..PIVOT_SUBSTEPS {
            let a = self.rates(&m);
            let b = self.rates(&add(&m, &a, 0.5 * h));
            let c = self.rates(&add(&m, &b, 0.5 * h));
            let d = self.rates(&add(&m, &c, h));
            let turn = (a.0 + (b.0 + c.0) * 2.0 + d.0) / 6.0;
            let mean = |a: DVec3, b: DVec3, c: DVec3, d: DVec3| (a + (b + c) * 2.0 + d) / 6.0;
            m = add(&m, &(turn, mean(a.1, b.1, c.1, d.1), mean(a.2, b.2, c.2, d.2)), h);
            m.turn = m.turn.normalize();
        }
        m
    }

    /// Forces at the points of contact, whose arms these are; none where they do not hold. The second of one point is
    /// zero.
    fn forces(&self, m: &Motion, arms: [DVec3; 2], friction: f64) -> Option<[DVec3; 2]> {
        let (turns, force) = self.acceleration(m);
        let holds = |f: DVec3| {
            let load = f.dot(self.normal);
            load > 0.0 && (f - self.normal * load).length() <= friction * load
        };
        if self.line.is_none() {
            return holds(force).then_some([force, DVec3::ZERO]);
        }
        // The points share the force so that its torque is what turns the body.
        let (d, middle) = (arms[0] - arms[1], 0.5 * (arms[0] + arms[1]));
        let torque = self.inertia.momentum(m.turn, turns) + m.w.cross(self.inertia.momentum(m.turn, m.w));
        let apart = (torque - middle.cross(force)).cross(d) / d.length_squared();
        let both = [0.5 * force + apart, 0.5 * force - apart];
        both.iter().all(|&f| holds(f)).then_some(both)
    }
}

impl RigidScratch {
    /// Takes a step of `h` seconds of a body that pivots alone; returns whether it does.
    pub(super) fn pivot_step(&mut self, world: &RigidWorld, bodies: &mut [RigidBodyState], h: f64) -> bool {
        let Some((pivot, friction)) = self.pivot(world, h) else { return false };
        let (place, first) = (self.places[0], self.touches[0].1);
        let spec = &world.specs[place.body];
        let start = Motion { turn: place.turn, w: place.start.w, rolled: DVec3::ZERO };
        let arms = |by: DQuat| [0, self.touches.len() - 1].map(|k| by * self.touches[k].1.arm);
        let Some(at_start) = pivot.forces(&start, arms(DQuat::IDENTITY), friction) else { return false };
        let mut end = pivot.after(&start, h);
        // Towards the gap that lasting contacts keep, as in other steps.
        let most = 0.5 * spec.gravity_magnitude * h;
        let rise = (KEPT_GAP * spec.gap - first.gap).min(most * h);
        let moved = (start.turn * pivot.centre) + end.rolled + first.normal * rise - end.turn * pivot.centre;
        let before = 0.5
            * (spec.mass * place.start.v.length_squared() + start.w.dot(spec.inertia.momentum(start.turn, start.w)));
        let (wanted, found) = (before + spec.mass * spec.gravity.dot(moved), pivot.kinetic(&end));
        if wanted <= PIVOT_SLOW * before || (wanted - found).abs() > PIVOT_ENERGY_ERROR * found {
            return false;
        }
        end.w *= (wanted / found).sqrt();
        let by = end.turn * start.turn.conjugate();
        let Some(at_end) = pivot.forces(&end, arms(by), friction) else { return false };
        self.prepare(world, 0.5 * h, |_, p| (p.start.v, p.start.w));
        let v = pivot.velocity(&end);
        (self.members[0].v, self.members[0].w) = (v, end.w);
        let place = &mut self.places[0];
        place.spin = spin_between(spec, [start.turn, end.turn], h);
        (place.end, place.end_turn) = place.drifted(spec, moved / h, place.spin, h);
        if !self.ends_in_contact(world, rise, by) || self.returns().is_some() || self.misses(world, h).is_some() {
            return false;
        }
        let passed = (v - self.places[0].start.v - spec.gravity * h) * spec.mass;
        let missing = passed - (at_start[0] + at_start[1] + at_end[0] + at_end[1]) * (0.5 * h);
        let share = missing / self.contacts.len() as f64;
        for (c, force) in self.contacts.iter_mut().zip(at_start) {
            c.impulse = force * (0.5 * h);
        }
        self.firsts.clone_from(&self.contacts);
        for (c, force) in self.contacts.iter_mut().zip(at_end) {
            c.impulse = force * (0.5 * h) + share;
        }
        self.write(world, bodies, h);
        true
    }

    /// The pivot of a step, and its friction, if a body alone has one that holds at the start.
    fn pivot<'w>(&self, world: &'w RigidWorld, h: f64) -> Option<(Pivot<'w>, f64)> {
        let ([place], [], [], []) = (&self.places[..], &self.pairs[..], &self.parting[..], &self.rows[..]) else {
            return None;
        };
        let spec = &world.specs[place.body];
        let (first, line) = match &self.touches[..] {
            [(_, only)] => (only, None),
            [(_, a), (_, b)] if (a.normal - b.normal).length() <= PIVOT_NORMAL_ERROR => {
                (a, Some((b.arm - a.arm).try_normalize()?))
            }
            _ => return None,
        };
        if !self.stops.is_empty()
            || spec.is_ball
            || spec.is_driven()
            || spec.damping.is_some()
            || spec.gravity_magnitude == 0.0
        {
            return None;
        }
        let radius = |t: &ContactPoint| match t.point() {
            Some(point) if !spec.is_fixed_point(point) => None,
            Some(point) => Some(spec.contact_spheres.get(point)?.radius),
            None => Some(0.0),
        };
        let (rounded, mut friction) = (radius(first)?, f64::INFINITY);
        let slow = world.accuracy.sweep_tolerance.max(PIVOT_SLIP) * spec.gravity_magnitude * h;
        for (_, t) in &self.touches {
            let law = world.law_at(place.body, t, place.start.x + t.arm);
            let holds = place.start.velocity(t.arm).length() <= slow
                && law.rolling == 0.0
                && law.spinning == 0.0
                && radius(t) == Some(rounded)
                && (0.0..=CONTACT_MARGIN * spec.gap).contains(&t.gap)
                && !matches!(world.parts[usize::from(t.part)], StaticShape::Table(_));
            if !holds {
                return None;
            }
            friction = friction.min(law.grip());
        }
        let pivot = Pivot {
            mass: spec.mass,
            inertia: &spec.inertia,
            gravity: spec.gravity,
            centre: place.turn.conjugate() * (first.arm + first.normal * rounded),
            radius: rounded,
            normal: first.normal,
            line,
        };
        Some((pivot, friction))
    }

    /// Whether the same points of the body touch the same face at the end of the drift, after a rise and a rotation.
    fn ends_in_contact(&self, world: &RigidWorld, rise: f64, by: DQuat) -> bool {
        let StepPoses { body, start: _, end, .. } = self.places[0];
        let spec = &world.specs[body];
        self.touches.iter().all(|(_, t)| {
            let after = world.touch(body, &end, t.surface);
            let radius = t.point().and_then(|k| spec.contact_spheres.get(k)).map_or(0.0, |s| s.radius);
            let arm = by * (t.arm + t.normal * radius) - t.normal * radius;
            (after.gap - t.gap - rise).abs() <= GAP_ERROR * spec.gap
                && (after.arm - arm).length() <= spec.gap
                && (after.normal - t.normal).length() <= PIVOT_NORMAL_ERROR
        })
    }
}

/// Angular velocity at the start of the free rotation that leads from one orientation to another within `h` seconds.
fn spin_between(spec: &BodyDef, [from, to]: [DQuat; 2], h: f64) -> DVec3 {
    let mut spin = rotation_vector(from, to) / h;
    for _ in 0..PIVOT_SPIN_ROUNDS {
        let missing = rotation_vector(drift(&spec.inertia, from, spin, h).0, to);
        spin += missing / h;
        if missing.length_squared() <= PIVOT_TURN_ERROR * PIVOT_TURN_ERROR {
            break;
        }
    }
    spin
}

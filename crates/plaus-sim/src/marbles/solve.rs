//! One contact of a group, solved exactly given the others: the block of a Gauss–Seidel sweep.
//!
//! Impulses act along the normal half-way through the step and must leave no approach along the normal at its end. On a circle that reflects the velocity about the
//! half-way normal, which keeps its length: the scheme is of second order and does not lose energy to curvature (it is RATTLE's idea).

use crate::material::Law;
use glam::DVec3;

/// One body of a group during a step.
#[derive(Debug, Clone, Copy)]
pub(super) struct Member {
    pub(super) index: u32,
    pub(super) mass: f64,
    pub(super) inertia: f64,
    pub(super) radius: f64,
    pub(super) gyration: f64,
    pub(super) start: DVec3,
    pub(super) start_v: DVec3,
    pub(super) start_w: DVec3,
    pub(super) v: DVec3,
    pub(super) w: DVec3,
    /// Centre at the end of the step, as far as known.
    pub(super) x: DVec3,
    pub(super) is_held: bool,
}

impl Member {
    /// Acceleration of the parabola from the start to where the step ends.
    pub(super) fn acceleration(&self, h: f64) -> DVec3 {
        (self.x - self.start - self.start_v * h) * (2.0 / (h * h))
    }
}

/// A lasting contact of a group: of member `a` with a surface or with member `b`.
#[derive(Debug, Clone, Copy)]
pub(super) struct Contact {
    pub(super) a: usize,
    pub(super) with: With,
    pub(super) law: Law,
    /// Normal towards `a` at the start and at the end of the step.
    pub(super) first: DVec3,
    pub(super) last: DVec3,
    /// Normal impulse.
    pub(super) load: f64,
    /// What the contact has given so far: impulse on `a`, angular impulse on `a` and on `b`.
    impulse: DVec3,
    turn_a: DVec3,
    turn_b: DVec3,
}

/// The partner of a contact.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum With {
    Surface(crate::scenery::Surface),
    Member(usize),
}

impl Contact {
    pub(super) fn new(a: usize, with: With, law: Law, normal: DVec3) -> Self {
        let none = DVec3::ZERO;
        Self { a, with, law, first: normal, last: normal, load: 0.0, impulse: none, turn_a: none, turn_b: none }
    }

    /// Forgets what the contact has given.
    pub(super) fn clear(&mut self) {
        self.load = 0.0;
        self.impulse = DVec3::ZERO;
        self.turn_a = DVec3::ZERO;
        self.turn_b = DVec3::ZERO;
    }

    /// Adds what the contact has given to its members.
    pub(super) fn apply(&self, members: &mut [Member]) {
        let a = &mut members[self.a];
        a.v += self.impulse / a.mass;
        a.w += self.turn_a / a.inertia;
        if let With::Member(b) = self.with {
            let b = &mut members[b];
            b.v -= self.impulse / b.mass;
            b.w += self.turn_b / b.inertia;
        }
    }

    /// Solves the contact and returns the change of velocity of its members.
    pub(super) fn solve(&mut self, members: &mut [Member]) -> f64 {
        match self.with {
            With::Surface(_) => self.solve_surface(&mut members[self.a]),
            With::Member(b) => self.solve_pair(members, b),
        }
    }

    fn push(&self) -> Push {
        Push { first: self.first, last: self.last }
    }

    fn solve_surface(&mut self, m: &mut Member) -> f64 {
        let before = m.v;
        let (v, w) = (m.v - self.impulse / m.mass, m.w - self.turn_a / m.inertia);
        (self.load, m.v, m.w) = respond(m.mass, m.radius, m.gyration, &self.law, &self.push(), v, w);
        self.impulse = (m.v - v) * m.mass;
        self.turn_a = (m.w - w) * m.inertia;
        (m.v - before).length()
    }

    fn solve_pair(&mut self, members: &mut [Member], other: usize) -> f64 {
        let (mut a, mut b) = (members[self.a], members[other]);
        let before = (a.v, b.v);
        a.v -= self.impulse / a.mass;
        b.v += self.impulse / b.mass;
        a.w -= self.turn_a / a.inertia;
        b.w -= self.turn_b / b.inertia;
        let n = self.last;
        let approach = -(a.v - b.v).dot(n);
        let inverse = 1.0 / a.mass + 1.0 / b.mass;
        self.load = approach.max(0.0) / inverse;
        self.impulse = DVec3::ZERO;
        if approach > 0.0 {
            let push = self.push().direction() * self.load;
            let relative = a.v - b.v + push * inverse;
            let slip = relative - (a.w * a.radius + b.w * b.radius).cross(n);
            let slip = slip - n * slip.dot(n);
            let compliance = (1.0 + 1.0 / a.gyration) / a.mass + (1.0 + 1.0 / b.gyration) / b.mass;
            let (stick, limit) = (slip.length() / compliance, self.law.friction * self.load);
            let drag = if stick <= limit { slip / -compliance } else { slip * (-limit / slip.length()) };
            self.impulse = push + drag;
            self.turn_a = drag.cross(n) * a.radius;
            self.turn_b = drag.cross(n) * b.radius;
            a.w += self.turn_a / a.inertia;
            b.w += self.turn_b / b.inertia;
        } else {
            (self.turn_a, self.turn_b) = (DVec3::ZERO, DVec3::ZERO);
        }
        a.v += self.impulse / a.mass;
        b.v -= self.impulse / b.mass;
        let change = (a.v - before.0).length().max((b.v - before.1).length());
        (members[self.a], members[other]) = (a, b);
        change
    }
}

/// Normals of a contact at the start and at the end of a step.
pub(super) struct Push {
    pub(super) first: DVec3,
    pub(super) last: DVec3,
}

impl Push {
    /// Direction of the normal impulse, scaled so that a unit changes the final normal velocity by one unit per mass.
    #[inline]
    fn direction(&self) -> DVec3 {
        let sum = self.first + self.last;
        let along = sum.dot(self.last);
        // Normals that turn by more than a right angle within a step: the step was too long for this edge; use the last.
        if along > 0.5 { sum / along } else { self.last }
    }
}

/// Load, velocity and spin of a ball after a surface has stopped its approach and rubbed it.
#[inline]
pub(super) fn respond(
    mass: f64,
    radius: f64,
    gyration: f64,
    law: &Law,
    push: &Push,
    v: DVec3,
    w: DVec3,
) -> (f64, DVec3, DVec3) {
    let approach = -v.dot(push.last);
    let load = mass * approach.max(0.0);
    if approach > 0.0 {
        let (v, w) = rub((mass, radius, gyration), law, (push.last, load), v + push.direction() * approach, w);
        (load, v, w)
    } else {
        (load, v, w)
    }
}

/// Friction, rolling and spinning resistance on a ball with tangential velocity `v` and spin `w`, under the contact's load.
#[inline]
fn rub(
    (mass, radius, k): (f64, f64, f64),
    law: &Law,
    (n, load): (DVec3, f64),
    v: DVec3,
    w: DVec3,
) -> (DVec3, DVec3) {
    let about = w.dot(n);
    let drilled = (about.abs() - law.spinning * load / (k * mass * radius)).max(0.0).copysign(about);
    let surface = w.cross(n) * radius;
    let free = (v + surface * k) / (1.0 + k);
    let speed = free.length();
    let resisted = speed - law.rolling * load / ((1.0 + k) * mass);
    let rolling = if resisted > 0.0 { free * (resisted / speed) } else { DVec3::ZERO };
    let limit = law.friction * load;
    if (rolling - v).length() * mass <= limit {
        return (rolling, n.cross(rolling) / radius + n * drilled);
    }
    let slip = v - surface;
    let speed = slip.length();
    if speed == 0.0 {
        return (v, w + n * (drilled - about));
    }
    let drag = slip * (-limit / speed);
    let inertia = k * mass * radius * radius;
    (v + drag / mass, w + drag.cross(n) * (radius / inertia) + n * (drilled - about))
}

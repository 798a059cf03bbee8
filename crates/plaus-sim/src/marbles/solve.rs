//! One contact of a group, solved exactly given the others: the block of a Gauss–Seidel sweep.
//!
//! Impulses act along the normal half-way through the step, and must leave no approach along the normal at its end. On
//! a circle this reflects the velocity about the half-way normal, which keeps its length: the scheme is of second order
//! and loses no energy to curvature (it is RATTLE's idea).

use super::MarbleSpec;
use crate::material::Law;
use crate::scenery::Projection;
use glam::DVec3;

/// A ball's response to an impulse, with the quotients that every impulse needs.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Ball {
    pub(super) mass: f64,
    pub(super) radius: f64,
    /// Inertia over mass × radius².
    gyration: f64,
    pub(super) inverse_mass: f64,
    /// Radius over inertia.
    turning: f64,
    /// 1/m + r²/I.
    compliance: f64,
    inverse_radius: f64,
    /// 1/(1 + gyration).
    pub(super) share: f64,
    /// 1/(gyration × radius).
    lever: f64,
}

impl Ball {
    #[inline]
    pub(super) fn new(spec: &MarbleSpec) -> Self {
        let &MarbleSpec { mass, radius, gyration, .. } = spec;
        let inverse_radius = 1.0 / radius;
        let (inverse_mass, lever) = (1.0 / mass, inverse_radius / gyration);
        Self {
            mass,
            radius,
            gyration,
            inverse_mass,
            turning: radius * (inverse_mass * lever * inverse_radius),
            compliance: (1.0 + 1.0 / gyration) * inverse_mass,
            inverse_radius,
            share: 1.0 / (1.0 + gyration),
            lever,
        }
    }

    /// Velocity of its centre once it rolls without slip, from velocity and spin as they are: the momentum about the
    /// point of contact is kept.
    #[inline]
    pub(super) fn rolling(&self, n: DVec3, v: DVec3, w: DVec3) -> DVec3 {
        (v - n * v.dot(n) + w.cross(n) * (self.radius * self.gyration)) * self.share
    }

    /// Inertia in kg m².
    #[inline]
    pub(super) fn inertia(&self) -> f64 {
        self.gyration * self.mass * self.radius * self.radius
    }
}

/// One body of a group during a step.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Member {
    pub(super) index: u32,
    pub(super) ball: Ball,
    pub(super) start: DVec3,
    pub(super) start_v: DVec3,
    pub(super) start_w: DVec3,
    /// Velocity and spin that it would have without contacts.
    pub(super) free: (DVec3, DVec3),
    pub(super) v: DVec3,
    pub(super) w: DVec3,
    /// Centre at the end of the step, as far as known.
    pub(super) x: DVec3,
    pub(super) is_held: bool,
    /// How far it is lifted out of overlaps.
    pub(super) lift: DVec3,
}

impl Member {
    /// A marble at the start of a step.
    pub(super) fn new(index: u32, ball: Ball, x: DVec3, v: DVec3, w: DVec3) -> Self {
        let (start, start_v, start_w) = (x, v, w);
        Self { index, ball, start, start_v, start_w, free: (v, w), v, w, x, is_held: false, lift: DVec3::ZERO }
    }

    /// Sets velocity and spin as they are without contacts.
    pub(super) fn set_free(&mut self, v: DVec3, w: DVec3) {
        (self.free, self.v, self.w) = ((v, w), v, w);
    }

    /// Acceleration of the parabola from the start to where the step ends.
    pub(super) fn acceleration(&self, h: f64) -> DVec3 {
        (self.x - self.start - self.start_v * h) * (2.0 / (h * h))
    }
}

/// A lasting contact of a group: of member `a` with a surface or with member `b`.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Contact {
    pub(super) a: usize,
    pub(super) with: With,
    pub(super) law: Law,
    /// Position of `a` relative to the other at the start of the step; for a pair, the distance is that of the centres.
    pub(super) projection: Projection,
    pub(super) push: Push,
    /// Approach that the contact stopped, in m/s: its load over the mass.
    pub(super) load: f64,
    /// The total effect of the contact so far: changes of velocity and spin of `a` and of `b`.
    given_a: (DVec3, DVec3),
    given_b: (DVec3, DVec3),
    /// For a pair: 1/m and 1/m + r²/I, summed over both. 0 for a surface.
    inverse: f64,
    compliance: f64,
}

/// The partner of a contact.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum With {
    Surface(crate::scenery::Surface),
    Member(usize),
}

const NOTHING: (DVec3, DVec3) = (DVec3::ZERO, DVec3::ZERO);

impl Contact {
    /// A contact of `members[a]`, whose position relative to the other is in `projection`.
    pub(super) fn new(members: &[Member], a: usize, with: With, law: Law, projection: Projection) -> Self {
        let (inverse, compliance) = match with {
            With::Surface(_) => (0.0, 0.0),
            With::Member(b) => {
                let (p, q) = (&members[a].ball, &members[b].ball);
                (p.inverse_mass + q.inverse_mass, p.compliance + q.compliance)
            }
        };
        let push = Push::along(projection.normal);
        Self { a, with, law, projection, push, load: 0.0, given_a: NOTHING, given_b: NOTHING, inverse, compliance }
    }

    /// Forgets the contact's effect.
    pub(super) fn clear(&mut self) {
        self.load = 0.0;
        (self.given_a, self.given_b) = (NOTHING, NOTHING);
    }

    /// Distance of the centre at which it touches; relative velocities of the centres and of the touching points at the
    /// start.
    pub(super) fn start(&self, members: &[Member]) -> (f64, [DVec3; 2]) {
        let (a, n) = (&members[self.a], self.projection.normal);
        let surface = a.start_w * a.ball.radius;
        match self.with {
            With::Surface(_) => (a.ball.radius, [a.start_v, a.start_v - surface.cross(n)]),
            With::Member(b) => {
                let b = &members[b];
                let v = a.start_v - b.start_v;
                (a.ball.radius + b.ball.radius, [v, v - (surface + b.start_w * b.ball.radius).cross(n)])
            }
        }
    }

    /// Whether it bears a load.
    pub(super) fn is_loaded(&self) -> bool {
        self.load != 0.0
    }

    /// The change of its first member's velocity.
    pub(super) fn given(&self) -> DVec3 {
        self.given_a.0
    }

    /// Whether it is a contact of this member.
    pub(super) fn concerns(&self, member: usize) -> bool {
        self.a == member || self.with == With::Member(member)
    }

    /// The contact's effect on its first member: changes of its velocity, and of its spin times its radius.
    pub(super) fn read(&self, members: &[Member], loads: &mut Vec<f64>) {
        loads.extend(self.given_a.0.to_array());
        loads.extend((self.given_a.1 * members[self.a].ball.radius).to_array());
    }

    /// Sets that effect, and the corresponding one on its second member.
    pub(super) fn write(&mut self, members: &[Member], loads: &[f64]) {
        let p = &members[self.a].ball;
        self.given_a = (DVec3::from_slice(loads), DVec3::from_slice(&loads[3..]) * p.inverse_radius);
        if let With::Member(b) = self.with {
            let q = &members[b].ball;
            self.given_b = (self.given_a.0 * (-p.mass * q.inverse_mass), self.given_a.1 * (q.turning / p.turning));
        }
    }

    /// Adds the contact's effect to its members.
    pub(super) fn apply(&self, members: &mut [Member]) {
        let a = &mut members[self.a];
        a.v += self.given_a.0;
        a.w += self.given_a.1;
        if let With::Member(b) = self.with {
            let b = &mut members[b];
            b.v += self.given_b.0;
            b.w += self.given_b.1;
        }
    }

    /// Solves the contact and returns the square of the change of velocity of its members.
    #[inline]
    pub(super) fn solve(&mut self, members: &mut [Member]) -> f64 {
        match self.with {
            With::Surface(_) => self.solve_surface(&mut members[self.a]),
            With::Member(b) => self.solve_pair(members, b),
        }
    }

    #[inline]
    fn solve_surface(&mut self, m: &mut Member) -> f64 {
        let before = m.v;
        let (v, w) = (m.v - self.given_a.0, m.w - self.given_a.1);
        (self.load, m.v, m.w) = respond(&m.ball, &self.law, &self.push, v, w);
        self.given_a = (m.v - v, m.w - w);
        (m.v - before).length_squared()
    }

    fn solve_pair(&mut self, members: &mut [Member], other: usize) -> f64 {
        let (a, b) = (&members[self.a], &members[other]);
        let before = (a.v, b.v);
        let (mut v_a, mut w_a) = (a.v - self.given_a.0, a.w - self.given_a.1);
        let (mut v_b, mut w_b) = (b.v - self.given_b.0, b.w - self.given_b.1);
        let (p, q) = (&a.ball, &b.ball);
        let n = self.push.last;
        let approach = -(v_a - v_b).dot(n) - self.push.slack;
        self.load = approach.max(0.0);
        (self.given_a, self.given_b) = (NOTHING, NOTHING);
        if approach > 0.0 {
            let relative = v_a - v_b + self.push.direction * approach;
            let slip = relative - (w_a * p.radius + w_b * q.radius).cross(n);
            let slip = slip - n * slip.dot(n);
            // Both in units of relative velocity of the centres, until they are impulses.
            let stick = slip * (-self.inverse / self.compliance);
            let sticks = stick.length() <= self.law.friction * approach;
            let (load, drag) =
                if sticks { (approach, stick) } else { self.push.drag(slip, self.law.friction, approach) };
            let drag = drag / self.inverse;
            let impulse = self.push.direction * (load / self.inverse) + drag;
            let turn = drag.cross(self.push.direction);
            self.given_a = (impulse * p.inverse_mass, turn * p.turning);
            self.given_b = (impulse * -q.inverse_mass, turn * q.turning);
            (v_a, w_a) = (v_a + self.given_a.0, w_a + self.given_a.1);
            (v_b, w_b) = (v_b + self.given_b.0, w_b + self.given_b.1);
        }
        (members[self.a].v, members[self.a].w) = (v_a, w_a);
        (members[other].v, members[other].w) = (v_b, w_b);
        (v_a - before.0).length_squared().max((v_b - before.1).length_squared())
    }
}

/// The directions in which a contact pushes during a step.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Push {
    /// Normal at the end of the step.
    pub(super) last: DVec3,
    /// Direction of the normal impulse, scaled so that a unit changes the final normal velocity by one unit per mass.
    direction: DVec3,
    /// Normal velocity towards the other at the end that the contact allows, in m/s: it only closes the gap that was
    /// there, or opened on the way.
    slack: f64,
    /// Slip of the touching points at the start, in m/s.
    slip: DVec3,
}

impl Push {
    /// A push for normals at the start and at the end of the step.
    #[inline]
    pub(super) fn new(first: DVec3, last: DVec3) -> Self {
        let sum = first + last;
        let along = sum.dot(last);
        // Normals that turn by more than a right angle within a step: the step was too long for this edge; use the
        // last.
        Self { last, direction: if along > 0.5 { sum / along } else { last }, slack: 0.0, slip: DVec3::ZERO }
    }

    /// The same for a contact with a gap at the start of a step of `h` seconds, where `v` is the relative velocity of
    /// the centres and `slip` that of the touching points: it only resists overlap at the end.
    #[inline]
    pub(super) fn across(self, first: DVec3, gap: f64, [v, slip]: [DVec3; 2], h: f64) -> Self {
        Self { slack: (2.0 * gap / h + v.dot(first)).max(0.0), slip: slip - first * slip.dot(first), ..self }
    }

    /// Sliding friction of at most `friction` times the load, against the mean of the slip at the start and of `slip`,
    /// which is the slip at the end without friction; and the load that stops `approach` together with it. Both are in
    /// units of the velocity that they change. To second order, the step slides along that mean, and friction against
    /// it never adds energy.
    #[inline]
    fn drag(&self, slip: DVec3, friction: f64, approach: f64) -> (f64, DVec3) {
        let mean = if self.slip.dot(slip) > 0.0 { self.slip + slip } else { slip };
        let across = mean - self.direction * (mean.dot(self.direction) / self.direction.length_squared());
        let along = across.normalize_or_zero();
        // Friction half-way lifts or presses a little at the end.
        let size = friction * self.direction.length();
        let lifts = 1.0 - size * along.dot(self.last);
        if lifts > 0.5 {
            let load = approach / lifts;
            return (load, along * (-size * load));
        }
        (approach, slip.normalize_or_zero() * (-friction * approach))
    }

    /// A push along a normal that does not turn.
    #[inline]
    pub(super) fn along(normal: DVec3) -> Self {
        Self::new(normal, normal)
    }
}

/// The approach that was stopped, and velocity and spin of a ball after a surface has stopped it, with friction. Mass
/// does not matter.
#[inline(always)]
pub(super) fn respond(ball: &Ball, law: &Law, push: &Push, v: DVec3, w: DVec3) -> (f64, DVec3, DVec3) {
    let approach = -v.dot(push.last) - push.slack;
    if approach > 0.0 {
        let left = push.last * -push.slack;
        let (load, v, w) = rub(ball, law, push, approach, v + push.direction * approach - left, w);
        (load, v + left, w)
    } else {
        (0.0, v, w)
    }
}

/// Friction, rolling and spinning resistance on a ball with tangential velocity `v` and spin `w`, under a load that
/// stopped `approach`. Slip is taken at the end of the step. Friction's lever is the normal half-way, so that a spin
/// about the normal follows it.
#[inline(always)]
fn rub(ball: &Ball, law: &Law, push: &Push, approach: f64, v: DVec3, w: DVec3) -> (f64, DVec3, DVec3) {
    let n = push.last;
    let turned = |drag: DVec3| w + drag.cross(push.direction) * ball.lever;
    let drilled = |w: DVec3| {
        let about = w.dot(n);
        ((about.abs() - law.spinning * approach * ball.lever).max(0.0).copysign(about), about)
    };
    let surface = w.cross(n) * ball.radius;
    let free = (v + surface * ball.gyration) * ball.share;
    let speed = free.length();
    let resisted = speed - law.rolling * approach * ball.share;
    let rolling = if resisted > 0.0 { free * (resisted / speed) } else { DVec3::ZERO };
    let limit = law.friction * approach;
    if (rolling - v).length_squared() <= limit * limit {
        let (left, _) = drilled(turned(rolling - v));
        return (approach, rolling, n.cross(rolling) * ball.inverse_radius + n * left);
    }
    let (load, drag) = push.drag(v - surface, law.friction, approach);
    let v = v + push.direction * (load - approach) + drag;
    let held = law.holds_from_turning() && surface == DVec3::ZERO;
    let w = if held { w } else { turned(drag) };
    let (left, about) = drilled(w);
    (load, v, w + n * (left - about))
}

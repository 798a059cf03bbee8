//! Forward dynamics of trees of joints by articulated bodies (Featherstone, *Rigid Body Dynamics Algorithms* (2008),
//! ch. 7): from the outermost bodies inwards, what a body and all that hangs on it resist with; then outwards, how each
//! joint is accelerated. In world axes, about the anchor of each body's joint, with accelerations of material points.

use super::axis::Spring;
use super::joint::WORLD_POSE;
use super::tree::{Freedom, JointTrees, Link, Parent, turned};
use crate::rigid::step_poses::StepPoses;
use crate::rigid::{BodyDef, RigidWorld};
use glam::{DMat3, DQuat, DVec3};
use plaus_dist::math;

/// Place and motion of a point of a parent that other links hang on.
#[derive(Debug, Clone, Copy)]
struct Base {
    p: DVec3,
    turn: DQuat,
    r: DMat3,
    v: DVec3,
    w: DVec3,
    /// Acceleration of the point, and angular acceleration.
    a: DVec3,
    alpha: DVec3,
}

/// A link at one time.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct LinkState {
    /// Orientation, anchor, and offset of the centre of gravity from it.
    pub(crate) turn: DQuat,
    r: DMat3,
    p: DVec3,
    c: DVec3,
    /// Velocity of the anchor, and angular velocity.
    v: DVec3,
    pub(crate) w: DVec3,
    axis: DVec3,
    inertia: DMat3,
    /// What it and all that hangs on it resist with: moment and force are `j α + h a + n` and `hᵀ α + m a + f`.
    j: DMat3,
    h: DMat3,
    m: DMat3,
    n: DVec3,
    f: DVec3,
    /// The response of a hinge or slider to what acts along it, and its share of the moment and the force.
    ja: DVec3,
    ha: DVec3,
    pub(super) d: f64,
    drive: f64,
    /// What its spring does along its axis.
    pull: f64,
    /// A ball's response to a moment.
    free: DMat3,
    /// Accelerations that its parent's motion and its own rates make without any force: of the anchor, and angular.
    gamma: DVec3,
    zeta: DVec3,
    /// What was asked for: of a hinge or slider along its axis; angular; and of the anchor.
    about: f64,
    pub(crate) alpha: DVec3,
    a: DVec3,
}

impl LinkState {
    /// The centre of gravity.
    pub(crate) fn x(&self) -> DVec3 {
        self.p + self.c
    }

    /// Its velocity.
    pub(crate) fn velocity(&self) -> DVec3 {
        self.v + self.w.cross(self.c)
    }

    /// Its acceleration.
    pub(crate) fn acceleration(&self) -> DVec3 {
        self.a + self.alpha.cross(self.c) + self.w.cross(self.w.cross(self.c))
    }
}

/// The matrix of a cross product from the left.
fn cross(r: DVec3) -> DMat3 {
    DMat3::from_cols(DVec3::new(0.0, r.z, -r.y), DVec3::new(-r.z, 0.0, r.x), DVec3::new(r.y, -r.x, 0.0))
}

/// The matrix of the cross products of a vector with the columns of a matrix.
fn times(r: DVec3, m: &DMat3) -> DMat3 {
    DMat3::from_cols(r.cross(m.x_axis), r.cross(m.y_axis), r.cross(m.z_axis))
}

/// What acts on a body, but for its joints: force and torque.
fn acting(spec: &BodyDef, s: &LinkState) -> (DVec3, DVec3) {
    let weight = spec.gravity * spec.mass;
    match &spec.damping {
        None => (weight, DVec3::ZERO),
        Some(damping) => {
            let [a, torque] = spec.acting(damping, &s.r);
            let slowed = s.velocity() * (damping.linear * spec.mass);
            (a * spec.mass - slowed, torque - s.inertia * s.w * damping.angular)
        }
    }
}

impl Base {
    /// The fixed world.
    const FIXED: Self = Self {
        p: DVec3::ZERO,
        turn: DQuat::IDENTITY,
        r: DMat3::IDENTITY,
        v: DVec3::ZERO,
        w: DVec3::ZERO,
        a: DVec3::ZERO,
        alpha: DVec3::ZERO,
    };
}

fn outer(a: DVec3, b: DVec3) -> DMat3 {
    DMat3::from_cols(a * b.x, a * b.y, a * b.z)
}

fn vector(y: &[f64]) -> DVec3 {
    DVec3::new(y[0], y[1], y[2])
}

fn quaternion(y: &[f64]) -> DQuat {
    DQuat::from_xyzw(y[0], y[1], y[2], y[3])
}

/// What is solved for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Ask {
    /// Accelerations under all that acts.
    Accelerations,
    /// The velocities that joints leave of those with which the bodies come: impulses at the joints take the rest.
    Velocities,
}

impl JointTrees {
    /// Coordinates and rates at the start of a step; the rates as joints that hold would have them.
    pub(crate) fn read(&self, places: &[StepPoses], y: &mut Vec<f64>) {
        y.clear();
        y.resize(self.counts[0] + self.counts[1], 0.0);
        for link in &self.links {
            let p = &places[link.place];
            let [q, u] = [link.at[0], self.counts[0] + link.at[1]];
            match link.freedom {
                Freedom::All => {
                    y[q..q + 3].copy_from_slice(&p.start.x.to_array());
                    y[q + 3..q + 7].copy_from_slice(&p.turn.to_array());
                    y[u..u + 3].copy_from_slice(&p.start.v.to_array());
                    y[u + 3..u + 6].copy_from_slice(&p.start.w.to_array());
                }
                Freedom::Axis { axis, slides, .. } => {
                    let (turn, inner) = match link.parent {
                        Parent::Link(k) => {
                            let inner = &places[self.links[k].place];
                            (inner.turn, inner.start)
                        }
                        Parent::Driven(k) => (places[k].turn, places[k].start),
                        Parent::World | Parent::Nothing => (DQuat::IDENTITY, WORLD_POSE),
                    };
                    let moved = if slides {
                        let arm = p.turn * link.own;
                        p.start.velocity(arm) - inner.velocity(p.start.x + arm - inner.x)
                    } else {
                        p.start.w - inner.w
                    };
                    y[u] = moved.dot(turn * axis);
                }
                Freedom::Ball => {
                    y[q..q + 4].copy_from_slice(&p.turn.to_array());
                    y[u..u + 3].copy_from_slice(&p.start.w.to_array());
                }
                Freedom::Weld => {}
            }
        }
    }

    fn base(&self, world: &RigidWorld, places: &[StepPoses], link: &Link, now: &[LinkState], t: f64) -> Base {
        match link.parent {
            Parent::Link(k) => {
                let s = &now[k];
                Base { p: s.p, turn: s.turn, r: s.r, v: s.v, w: s.w, a: s.a, alpha: s.alpha }
            }
            Parent::Driven(k) => match &world.specs[places[k].body].drive {
                Some(drive) => {
                    let m = drive.moved(places[k].clock, t);
                    let r = DMat3::from_quat(m.turn);
                    Base { p: m.x, turn: m.turn, r, v: m.v, w: m.spin, a: m.a, alpha: m.angular_acceleration }
                }
                None => Base::FIXED,
            },
            Parent::World | Parent::Nothing => Base::FIXED,
        }
    }

    /// Puts the links where their coordinates say, `t` seconds after the start of the step, with their velocities.
    pub(crate) fn place(&self, world: &RigidWorld, places: &[StepPoses], y: &[f64], t: f64, now: &mut Vec<LinkState>) {
        now.resize(self.links.len(), LinkState::default());
        for (k, link) in self.links.iter().enumerate() {
            let spec = &world.specs[places[link.place].body];
            let [q, u] = [link.at[0], self.counts[0] + link.at[1]];
            let (inner, outer) = now.split_at_mut(k);
            let s = &mut outer[0];
            if link.freedom == Freedom::All {
                s.turn = quaternion(&y[q + 3..]).normalize();
                (s.r, s.inertia) = turned(s.turn, spec.inertia.moments);
                (s.p, s.c, s.v, s.w) = (vector(&y[q..]), DVec3::ZERO, vector(&y[u..]), vector(&y[u + 3..]));
                continue;
            }
            let base = self.base(world, places, link, inner, t);
            let mut arm = match link.parent {
                Parent::Link(p) => base.r * (link.onto - self.links[p].own),
                _ => base.r * link.onto,
            };
            if let Some(Spring { stiffness, rest, damping }) = link.spring {
                s.pull = stiffness * (rest - y[q]) - damping * y[u];
            }
            if let Freedom::Axis { axis, slides: true, .. } = link.freedom {
                s.axis = base.r * axis;
                arm += s.axis * y[q];
            }
            s.p = base.p + arm;
            s.v = base.v + base.w.cross(arm);
            s.gamma = base.w.cross(base.w.cross(arm));
            s.zeta = DVec3::ZERO;
            (s.turn, s.w) = match link.freedom {
                Freedom::Axis { slides: true, .. } => {
                    let own = s.axis * y[u];
                    s.v += own;
                    s.gamma += base.w.cross(own) * 2.0;
                    (base.turn * link.rest, base.w)
                }
                Freedom::Axis { axis, slides: false, .. } => {
                    let (sin, cos) = math::sin_cos(0.5 * y[q]);
                    let about = DQuat::from_xyzw(axis.x * sin, axis.y * sin, axis.z * sin, cos);
                    s.axis = base.r * axis;
                    let own = s.axis * y[u];
                    s.zeta = base.w.cross(own);
                    (base.turn * about * link.rest, base.w + own)
                }
                Freedom::Ball => (quaternion(&y[q..]).normalize(), vector(&y[u..])),
                Freedom::Weld | Freedom::All => (base.turn * link.rest, base.w),
            };
            (s.r, s.inertia) = turned(s.turn, spec.inertia.moments);
            s.c = -(s.r * link.own);
        }
    }

    /// Solves for accelerations or velocities of links that have been placed. Accelerations take the place of
    /// velocities in the second case.
    pub(crate) fn solve(&self, world: &RigidWorld, places: &[StepPoses], ask: Ask, t: f64, now: &mut [LinkState]) {
        for (link, s) in self.links.iter().zip(&mut *now) {
            let p = &places[link.place];
            let spec = &world.specs[p.body];
            let heavy = s.c * spec.mass;
            s.j = s.inertia + DMat3::from_diagonal(DVec3::splat(s.c.dot(heavy))) - outer(s.c, heavy);
            s.h = cross(heavy);
            s.m = DMat3::from_diagonal(DVec3::splat(spec.mass));
            match ask {
                Ask::Accelerations => {
                    let (force, torque) = acting(spec, s);
                    s.f = s.w.cross(s.w.cross(s.c)) * spec.mass - force;
                    s.n = s.w.cross(s.inertia * s.w) - torque + s.c.cross(s.f);
                }
                Ask::Velocities => {
                    s.f = -(p.start.v * spec.mass);
                    s.n = s.c.cross(s.f) - s.inertia * p.start.w;
                    (s.gamma, s.zeta, s.pull) = (DVec3::ZERO, DVec3::ZERO, 0.0);
                }
            }
        }
        self.gather_inwards(now);
        self.spread_outwards(world, places, ask, t, now);
    }

    /// From the outermost links inwards: what each and all that hangs on it resist with.
    fn gather_inwards(&self, now: &mut [LinkState]) {
        for k in (0..self.links.len()).rev() {
            let link = &self.links[k];
            let (before, after) = now.split_at_mut(k);
            let s = &mut after[0];
            match link.freedom {
                Freedom::Axis { slides, .. } => {
                    let loads;
                    (s.ja, s.ha, loads) = if slides {
                        (s.h * s.axis, s.m * s.axis, s.f)
                    } else {
                        (s.j * s.axis, s.h.transpose() * s.axis, s.n)
                    };
                    s.d = 1.0 / s.axis.dot(if slides { s.ha } else { s.ja });
                    s.drive = -s.axis.dot(loads) * s.d;
                    if link.spring.is_some() {
                        s.drive += s.pull * s.d;
                    }
                }
                Freedom::Ball => s.free = s.j.inverse(),
                Freedom::Weld | Freedom::All => {}
            }
            let Parent::Link(inner) = link.parent else { continue };
            let (mut j, mut h, mut m, mut n, mut f) = (s.j, s.h, s.m, s.n, s.f);
            match link.freedom {
                Freedom::Axis { .. } => {
                    let (ja, ha) = (s.ja * s.d, s.ha * s.d);
                    j -= outer(s.ja, ja);
                    h -= outer(s.ja, ha);
                    m -= outer(s.ha, ha);
                    n += j * s.zeta + s.ja * s.drive;
                    f += h.transpose() * s.zeta + s.ha * s.drive;
                }
                Freedom::Ball => {
                    let back = s.free * s.h;
                    m -= s.h.transpose() * back;
                    f -= back.transpose() * s.n;
                    (j, h, n) = (DMat3::ZERO, DMat3::ZERO, DVec3::ZERO);
                }
                Freedom::Weld | Freedom::All => {}
            }
            let o = &mut before[inner];
            let (r, passed) = (s.p - o.p, f + m * s.gamma);
            o.n += n + h * s.gamma + r.cross(passed);
            o.f += passed;
            let (turned, far) = (times(r, &h.transpose()), times(r, &m));
            o.j += j + turned + turned.transpose() + times(r, &far.transpose());
            o.h += h + far;
            o.m += m;
        }
    }

    /// From the roots outwards: what each link does.
    fn spread_outwards(&self, world: &RigidWorld, places: &[StepPoses], ask: Ask, t: f64, now: &mut [LinkState]) {
        for (k, link) in self.links.iter().enumerate() {
            let (before, after) = now.split_at_mut(k);
            let s = &mut after[0];
            if link.freedom == Freedom::All {
                let back = s.m.inverse();
                let side = s.h * back;
                s.alpha = (s.j - side * s.h.transpose()).inverse() * (side * s.f - s.n);
                s.a = -(back * (s.h.transpose() * s.alpha + s.f));
                continue;
            }
            let base = self.base(world, places, link, before, t);
            let [a, alpha] = if ask == Ask::Velocities && !matches!(link.parent, Parent::Link(_)) {
                [base.v, base.w]
            } else {
                [base.a, base.alpha]
            };
            s.a = a + alpha.cross(s.p - base.p) + s.gamma;
            s.alpha = match link.freedom {
                Freedom::Axis { slides, .. } => {
                    let given = alpha + s.zeta;
                    s.about = s.drive - (s.ja.dot(given) + s.ha.dot(s.a)) * s.d;
                    let own = s.axis * s.about;
                    if slides {
                        s.a += own;
                        given
                    } else {
                        given + own
                    }
                }
                Freedom::Ball => -(s.free * (s.h * s.a + s.n)),
                Freedom::Weld | Freedom::All => alpha,
            };
        }
    }

    /// Takes the velocities that were solved for as rates.
    pub(crate) fn take_velocities(&self, now: &[LinkState], y: &mut [f64]) {
        for (link, s) in self.links.iter().zip(now) {
            let u = self.counts[0] + link.at[1];
            match link.freedom {
                Freedom::All => {
                    y[u..u + 3].copy_from_slice(&s.a.to_array());
                    y[u + 3..u + 6].copy_from_slice(&s.alpha.to_array());
                }
                Freedom::Axis { .. } => y[u] = s.about,
                Freedom::Ball => y[u..u + 3].copy_from_slice(&s.alpha.to_array()),
                Freedom::Weld => {}
            }
        }
    }

    /// Rates of the coordinates and of the rates, of links that have been placed and solved for accelerations.
    pub(crate) fn slopes(&self, y: &[f64], now: &[LinkState], out: &mut [f64]) {
        for (k, link) in self.links.iter().enumerate() {
            let s = &now[k];
            let [q, u] = [link.at[0], self.counts[0] + link.at[1]];
            let turning = |q: &[f64]| {
                let rate = DQuat::from_xyzw(0.5 * s.w.x, 0.5 * s.w.y, 0.5 * s.w.z, 0.0) * quaternion(q);
                rate.to_array()
            };
            match link.freedom {
                Freedom::All => {
                    out[q..q + 3].copy_from_slice(&y[u..u + 3]);
                    out[q + 3..q + 7].copy_from_slice(&turning(&y[q + 3..]));
                    out[u..u + 3].copy_from_slice(&s.a.to_array());
                    out[u + 3..u + 6].copy_from_slice(&s.alpha.to_array());
                }
                Freedom::Axis { is_damped, .. } => {
                    out[q] = y[u];
                    out[u] = s.about;
                    if let Some(spring) = link.spring.filter(|_| is_damped) {
                        out[q + 1] = -spring.damping * y[u] * y[u];
                    }
                }
                Freedom::Ball => {
                    out[q..q + 4].copy_from_slice(&turning(&y[q..]));
                    out[u..u + 3].copy_from_slice(&s.alpha.to_array());
                }
                Freedom::Weld => {}
            }
        }
    }
}

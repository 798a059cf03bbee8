//! Free rotation in closed form.
//!
//! - Three equal moments: `ω` is constant.
//! - Two equal moments (axis `e`, `I₁ = I₂ ≠ I₃`): `R(t) = Rot(L̂, |L| t/I₁) · R₀ · Rot(e, (1 − I₃/I₁) ω₃ t)`.
//! - Three different moments: elliptic functions (`asymmetric_top.rs`); over a short time, which needs only a few
//!   terms, a Taylor series (`series.rs`).

use super::asymmetric_top::AsymmetricTop;
use super::inertia::about;
pub(crate) use super::inertia::rotation;
pub(crate) use super::inertia::{Inertia, InertiaKind};
use super::keyed_rotation::Turns;
pub(crate) use super::series::LEFT_OUT;
use super::series::{Series, magnus, series};
use glam::{DMat3, DQuat, DVec3};
use plaus_dist::math;

/// Orientation and angular velocity after `dt` of free rotation.
pub(crate) fn drift(inertia: &Inertia, turn: DQuat, w: DVec3, dt: f64) -> (DQuat, DVec3) {
    drift_within(inertia, turn, w, dt, LEFT_OUT)
}

/// The same, but for terms of a series below `left_out`.
pub(crate) fn drift_within(inertia: &Inertia, turn: DQuat, w: DVec3, dt: f64, left_out: f64) -> (DQuat, DVec3) {
    match inertia.kind {
        InertiaKind::Equal => ((rotation(w * dt) * turn).normalize(), w),
        InertiaKind::Top(axis) => {
            let top = SymmetricTop::new(inertia, axis, turn, w);
            let p = about(top.along, top.rate * dt);
            ((p * turn * about(DVec3::AXES[axis], top.own * dt)).normalize(), p * w)
        }
        InertiaKind::Different => {
            let own = turn.conjugate() * w;
            if let Some((turn, w)) = series(inertia, turn, own, dt, left_out) {
                return (turn, turn * w);
            }
            match AsymmetricTop::new(inertia.moments, &DMat3::from_quat(turn), own) {
                Some(top) => {
                    let (r, w) = top.at(dt);
                    (DQuat::from_mat3(&r).normalize(), r * w)
                }
                None => ((rotation(w * dt) * turn).normalize(), w),
            }
        }
    }
}

/// Largest angle in rad that [`magnus`] is taken for: a substep of a crowd turns bodies by less, unless they are struck
/// within it.
const LITTLE: f64 = 0.1;

/// The orientation after a small part of a turn, nearly: see [`magnus`]. After a larger one, to within `turn_error`.
pub(crate) fn drift_little(inertia: &Inertia, turn: DQuat, w: DVec3, dt: f64, turn_error: f64) -> DQuat {
    match inertia.kind {
        InertiaKind::Equal => (rotation(w * dt) * turn).normalize(),
        _ if w.length() * dt > LITTLE => drift_within(inertia, turn, w, dt, turn_error).0,
        _ => magnus(inertia, turn, turn.conjugate() * w, dt),
    }
}

/// The two rotations of a symmetric top: about the angular momentum, and about its own axis.
struct SymmetricTop {
    along: DVec3,
    rate: f64,
    own: f64,
}

impl SymmetricTop {
    fn new(inertia: &Inertia, axis: usize, turn: DQuat, w: DVec3) -> Self {
        let e = turn * DVec3::AXES[axis];
        let (own, other) = (inertia.moments[axis], inertia.moments[(axis + 1) % 3]);
        let spin = w.dot(e);
        let momentum = (w - e * spin) * other + e * (spin * own);
        let length = momentum.length();
        let along = if length > 0.0 { momentum / length } else { DVec3::Z };
        Self { along, rate: length / other, own: (1.0 - own / other) * spin }
    }
}

/// A rotation that can be evaluated at many times.
#[derive(Debug, Clone)]
pub(crate) struct FreeRotation {
    fixed: DMat3,
    cos: DMat3,
    sin: DMat3,
    rate: f64,
    /// A top's axis and its rotation about it.
    own: Option<(usize, f64)>,
    /// A top's angular velocity about its angular momentum, and its axis at the time last asked for.
    along: DVec3,
    axis: DVec3,
    course: Option<Box<Course>>,
}

/// A rotation that is not about one axis, nor that of a symmetric top.
#[derive(Debug, Clone)]
enum Course {
    Free(Free),
    /// On keyframes, and the time of theirs from which on its times count.
    Keyed(Turns, f64),
}

/// Free rotation of a body with three different moments.
#[derive(Debug, Clone)]
struct Free {
    inertia: Inertia,
    turn: DQuat,
    /// Angular velocity in body axes at the start.
    w: DVec3,
    /// Its series, from the first time that is asked for on, and which of its terms are left out.
    series: Option<Box<Series>>,
    left_out: f64,
    /// Its closed form, once it is needed; `None` within if it turns steadily.
    top: Option<Option<Box<AsymmetricTop>>>,
    /// Orientation, and angular velocity in body axes, at the time last asked for.
    now: (DMat3, DVec3),
}

impl Free {
    fn new(inertia: &Inertia, turn: DQuat, w: DVec3, left_out: f64) -> Self {
        let w = turn.conjugate() * w;
        Self { inertia: *inertia, turn, w, series: None, left_out, top: None, now: (DMat3::from_quat(turn), w) }
    }

    fn at(&mut self, dt: f64) -> (DMat3, DVec3) {
        let Self { inertia, turn, w, .. } = *self;
        let series = self.series.get_or_insert_with(|| Box::new(Series::new(&inertia, turn, w)));
        self.now = if let Some((turn, w)) = series.at(dt, self.left_out) {
            (DMat3::from_quat(turn), w)
        } else {
            let new = || AsymmetricTop::new(inertia.moments, &DMat3::from_quat(turn), w).map(Box::new);
            match self.top.get_or_insert_with(new) {
                Some(top) => top.at(dt),
                None => (DMat3::from_quat(turn * rotation(w * dt)), w),
            }
        };
        self.now
    }
}

impl FreeRotation {
    /// Free rotation from `turn` with angular velocity `w`, but for terms of a series below `left_out`.
    pub(crate) fn free(inertia: &Inertia, turn: DQuat, w: DVec3, left_out: f64) -> Self {
        match inertia.kind {
            InertiaKind::Equal => Self::steady(turn, w),
            InertiaKind::Top(axis) => {
                let top = SymmetricTop::new(inertia, axis, turn, w);
                let (along, now) = (top.along * top.rate, turn * DVec3::AXES[axis]);
                Self { own: Some((axis, top.own)), along, axis: now, ..Self::about(turn, top.along, top.rate) }
            }
            InertiaKind::Different => Self {
                course: Some(Box::new(Course::Free(Free::new(inertia, turn, w, left_out)))),
                ..Self::steady(turn, DVec3::ZERO)
            },
        }
    }

    /// Rotation at constant angular velocity.
    pub(crate) fn steady(turn: DQuat, w: DVec3) -> Self {
        let rate = w.length();
        Self::about(turn, if rate > 0.0 { w / rate } else { DVec3::Z }, rate)
    }

    /// Rotation on keyframes from a time of theirs on.
    pub(crate) fn keyed(turns: Turns, since: f64) -> Self {
        let course = Some(Box::new(Course::Keyed(turns, since)));
        Self { course, ..Self::steady(DQuat::IDENTITY, DVec3::ZERO) }
    }

    fn about(turn: DQuat, axis: DVec3, rate: f64) -> Self {
        let r = DMat3::from_quat(turn);
        let part = |e: DVec3| axis * axis.dot(e);
        let fixed = DMat3::from_cols(part(r.x_axis), part(r.y_axis), part(r.z_axis));
        let cos = r - fixed;
        let sin = DMat3::from_cols(axis.cross(r.x_axis), axis.cross(r.y_axis), axis.cross(r.z_axis));
        Self { fixed, cos, sin, rate, own: None, along: DVec3::ZERO, axis: DVec3::ZERO, course: None }
    }

    /// Angular velocity, in world axes, at the time last asked for. Only for a free body whose moments are not all
    /// equal. That of a top is the sum of a constant one and of one about its own axis.
    #[inline]
    pub(crate) fn spin(&self) -> Option<DVec3> {
        match self.own {
            Some((_, own)) => Some(self.along + self.axis * own),
            None => match self.course.as_deref() {
                Some(Course::Free(free)) => Some(free.now.0 * free.now.1),
                _ => None,
            },
        }
    }

    /// How the body sees a direction of the world.
    pub(crate) fn view(&self, direction: DVec3) -> RotatingDirection {
        let seen = |part: &DMat3| part.transpose() * direction;
        RotatingDirection { direction, fixed: seen(&self.fixed), cos: seen(&self.cos), sin: seen(&self.sin) }
    }

    /// That direction in body axes after `dt`, and its rate there.
    #[inline]
    pub(crate) fn see(&mut self, view: &RotatingDirection, dt: f64) -> (DVec3, DVec3) {
        if let Some(course) = &mut self.course {
            let (r, w) = course.at(dt);
            let seen = r.transpose() * view.direction;
            return (seen, seen.cross(w));
        }
        let (s, c) = math::sin_cos(self.rate * dt);
        let mut seen = view.fixed + view.cos * c + view.sin * s;
        let mut swing = (view.sin * c - view.cos * s) * self.rate;
        if let Some((axis, own)) = self.own {
            self.axis = self.fixed.col(axis) + self.cos.col(axis) * c + self.sin.col(axis) * s;
            let (s, c) = math::sin_cos(own * dt);
            let (j, k) = ((axis + 1) % 3, (axis + 2) % 3);
            (seen[j], seen[k]) = (seen[j] * c + seen[k] * s, seen[k] * c - seen[j] * s);
            (swing[j], swing[k]) = (swing[j] * c + swing[k] * s, swing[k] * c - swing[j] * s);
            swing[j] += own * seen[k];
            swing[k] -= own * seen[j];
        }
        (seen, swing)
    }

    /// Orientation after `dt`.
    #[inline]
    pub(crate) fn at(&mut self, dt: f64) -> DMat3 {
        if let Some(course) = &mut self.course {
            return course.at(dt).0;
        }
        let (s, c) = math::sin_cos(self.rate * dt);
        let mut r = self.fixed + self.cos * c + self.sin * s;
        if let Some((axis, own)) = self.own {
            self.axis = r.col(axis);
            let (s, c) = math::sin_cos(own * dt);
            let (j, k) = ((axis + 1) % 3, (axis + 2) % 3);
            let (p, q) = (r.col(j), r.col(k));
            *r.col_mut(j) = p * c + q * s;
            *r.col_mut(k) = q * c - p * s;
        }
        r
    }
}

impl Course {
    /// Orientation, and angular velocity in body axes.
    #[inline]
    fn at(&mut self, dt: f64) -> (DMat3, DVec3) {
        match self {
            Self::Free(free) => free.at(dt),
            Self::Keyed(turns, since) => {
                let (turn, spin) = turns.turned(*since + dt);
                (DMat3::from_quat(turn), turn.conjugate() * spin)
            }
        }
    }
}

/// A direction of the world as a rigid body sees it: its constant part, and its parts along the cosine and the sine of
/// the angle.
#[derive(Debug, Clone)]
pub(crate) struct RotatingDirection {
    direction: DVec3,
    fixed: DVec3,
    cos: DVec3,
    sin: DVec3,
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Classic Runge–Kutta with tiny steps on the matrix form: a reference that shares nothing with the formulas.
    fn reference(moments: DVec3, r0: DMat3, w0: DVec3, t: f64, n: usize) -> (DMat3, DVec3) {
        // State: rotation (columns) and body angular velocity.
        let euler = |w: DVec3| -> DVec3 { (moments * w).cross(w) / moments };
        let spin = |r: DMat3, w: DVec3| {
            let hat =
                DMat3::from_cols(DVec3::new(0.0, w.z, -w.y), DVec3::new(-w.z, 0.0, w.x), DVec3::new(w.y, -w.x, 0.0));
            r * hat
        };
        let (mut r, mut w) = (r0, r0.transpose() * w0);
        let h = t / n as f64;
        for _ in 0..n {
            let (k1, l1) = (spin(r, w), euler(w));
            let (k2, l2) = (spin(r + k1 * (0.5 * h), w + l1 * (0.5 * h)), euler(w + l1 * (0.5 * h)));
            let (k3, l3) = (spin(r + k2 * (0.5 * h), w + l2 * (0.5 * h)), euler(w + l2 * (0.5 * h)));
            let (k4, l4) = (spin(r + k3 * h, w + l3 * h), euler(w + l3 * h));
            r += (k1 + k2 * 2.0 + k3 * 2.0 + k4) * (h / 6.0);
            w += (l1 + l2 * 2.0 + l3 * 2.0 + l4) * (h / 6.0);
        }
        (r, r * w)
    }

    fn check(moments: DVec3, tolerance: f64) {
        let inertia = Inertia::new(moments);
        let turn = DQuat::from_xyzw(0.1, -0.4, 0.3, 0.8).normalize();
        let (w, t) = (DVec3::new(3.0, -1.0, 7.0), 1.5);
        let (r, reference_w) = reference(moments, DMat3::from_quat(turn), w, t, 40_000);
        let (q, end_w) = drift(&inertia, turn, w, t);
        let worst = |a: DMat3, b: DMat3| (0..3).map(|k| (a.col(k) - b.col(k)).length()).fold(0.0, f64::max);
        assert!(worst(DMat3::from_quat(q), r) < tolerance, "{} at {moments}", worst(DMat3::from_quat(q), r));
        assert!((end_w - reference_w).length() < 10.0 * tolerance, "{} at {moments}", (end_w - reference_w).length());
        let mut free_rotation = FreeRotation::free(&inertia, turn, w, LEFT_OUT);
        for k in 0..=10 {
            let dt = t * f64::from(k) / 10.0;
            let (there, spin) = drift(&inertia, turn, w, dt);
            assert!(worst(free_rotation.at(dt), DMat3::from_quat(there)) < 1e-13);
            let is_right = |found: Option<DVec3>| found.is_none_or(|w| (w - spin).length() < 1e-13 * w.length());
            assert!(
                is_right(free_rotation.spin())
                    && free_rotation.spin().is_some() == (inertia.kind != InertiaKind::Equal)
            );
            // A direction's rate in body axes is that of a fixed vector in a frame that turns.
            let direction = DVec3::new(0.6, -0.48, 0.64);
            let (seen, swing) = free_rotation.see(&free_rotation.view(direction), dt);
            assert!((seen - there.conjugate() * direction).length() < 1e-13 && is_right(free_rotation.spin()));
            assert!((swing - there.conjugate() * direction.cross(spin)).length() < 1e-13 * w.length());
        }
    }

    /// RK4 with h |ω| = 3e-4 over 12 radians: truncation about 12·(3e-4)⁴/120 < 1e-15, rounding of 4e4 steps about
    /// 1e-13.
    #[test]
    fn free_rotation_agrees_with_a_tight_integration() {
        check(DVec3::new(2.0, 2.0, 2.0), 1e-11);
        check(DVec3::new(2.0, 2.0, 0.5), 1e-11);
        check(DVec3::new(3.0, 1.0, 1.0), 1e-11);
        check(DVec3::new(1.0, 1.9, 1.0), 1e-11);
        check(DVec3::new(1.0, 1.5, 2.2), 1e-11);
        check(DVec3::new(0.2, 1.5, 1.6), 1e-11);
    }

    /// The error of a short rotation falls by the fourth power of its length per step, and is below its bound; a series
    /// without the last term is off by more. A longer rotation is exact.
    #[test]
    fn a_short_rotation_is_off_by_the_fourth_power_of_its_angle() {
        for moments in [DVec3::new(1.0, 1.5, 2.2), DVec3::new(2.0, 2.0, 0.5), DVec3::new(0.2, 1.5, 1.6)] {
            let inertia = Inertia::new(moments);
            let ratio = moments.max_element() / moments.min_element();
            let turn = DQuat::from_xyzw(0.1, -0.4, 0.3, 0.8).normalize();
            for w in [DVec3::new(3.0, -1.0, 7.0), DVec3::new(-0.3, 2.0, 0.1), DVec3::new(1.0, 1.0, -1.0)] {
                let error = |angle: f64| {
                    let dt = angle / w.length();
                    let (exact, found) = (drift(&inertia, turn, w, dt).0, drift_little(&inertia, turn, w, dt, 1e-9));
                    2.0 * (exact.conjugate() * found).xyz().length()
                };
                assert!(error(3.0) < 1e-8, "{} at {moments}", error(3.0));
                let (long, short) = (error(0.08), error(0.04));
                assert!(long <= ratio * ratio * ratio * 0.08 * 0.08 * 0.08 * 0.08 / 24.0, "{long} at {moments}");
                assert!(short <= long / 12.0 + 1e-14, "{short} of {long} at {moments}");
                let plain = rotation(w * (0.08 / w.length())) * turn;
                let plain = 2.0 * (drift(&inertia, turn, w, 0.08 / w.length()).0.conjugate() * plain).xyz().length();
                assert!(plain > 20.0 * long, "the twin would not be caught: {plain} at {moments}");
            }
        }
    }

    #[test]
    fn energy_and_momentum_are_kept_near_the_separatrix() {
        let inertia = Inertia::new(DVec3::new(1.0, 2.0, 2.9));
        let (turn, w) = (DQuat::IDENTITY, DVec3::new(1e-6, 5.0, 0.0));
        let energy = |q: DQuat, w: DVec3| 0.5 * w.dot(inertia.momentum(q, w));
        let (q, v) = drift(&inertia, turn, w, 40.0);
        // 200 radians in about 3000 steps of rounding.
        assert!((energy(q, v) / energy(turn, w) - 1.0).abs() < 1e-12);
        assert!((inertia.momentum(q, v) - inertia.momentum(turn, w)).length() < 1e-11);
    }
}

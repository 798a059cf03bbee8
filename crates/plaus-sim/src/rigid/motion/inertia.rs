//! Moments of inertia, and rotations about an axis.

use glam::{DMat3, DQuat, DVec3};
use plaus_dist::math;

/// The kinds of moments of inertia.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum InertiaKind {
    Equal,
    /// Two equal moments; the index is that of the third.
    Top(usize),
    Different,
}

/// Moments of inertia about the body's axes.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Inertia {
    pub(crate) moments: DVec3,
    pub(crate) kind: InertiaKind,
}

impl Inertia {
    pub(crate) fn new(i: DVec3) -> Self {
        let kind = if i.x == i.y && i.y == i.z {
            InertiaKind::Equal
        } else if i.x == i.y {
            InertiaKind::Top(2)
        } else if i.y == i.z {
            InertiaKind::Top(0)
        } else if i.z == i.x {
            InertiaKind::Top(1)
        } else {
            InertiaKind::Different
        };
        Self { moments: i, kind }
    }

    /// Angular momentum in world axes.
    pub(crate) fn momentum(&self, turn: DQuat, w: DVec3) -> DVec3 {
        if self.kind == InertiaKind::Equal {
            w * self.moments.x
        } else {
            turn * (self.moments * (turn.conjugate() * w))
        }
    }

    /// Angular velocity, in world axes, of a body with this angular momentum.
    pub(crate) fn spin(&self, turn: DQuat, l: DVec3) -> DVec3 {
        if self.kind == InertiaKind::Equal {
            l / self.moments.x
        } else {
            turn * ((turn.conjugate() * l) / self.moments)
        }
    }

    /// The inverse inertia in world axes, for a body turned by `r`.
    #[inline]
    pub(crate) fn inverse(&self, r: &DMat3) -> DMat3 {
        let i = self.moments;
        if self.kind == InertiaKind::Equal {
            return DMat3::from_diagonal(DVec3::splat(1.0 / i.x));
        }
        let scaled = DMat3::from_cols(r.x_axis / i.x, r.y_axis / i.y, r.z_axis / i.z);
        scaled * r.transpose()
    }

    /// An upper bound on the angular speed within `time` seconds of free rotation.
    ///
    /// Angular momentum L and energy E are kept, so it is at most `L / I_min` and `√(2 E / I_min)`, of which the second
    /// is less. Its rate is at most the anisotropy times its square, which bounds it within a short time.
    pub(crate) fn fastest(&self, turn: DQuat, w: DVec3, time: f64) -> f64 {
        let now = w.length();
        let ever = (self.momentum(turn, w).dot(w).max(0.0) / self.moments.min_element()).sqrt().max(now);
        let left = 1.0 - self.anisotropy() * now * time;
        if left > 0.0 { ever.min(now / left) } else { ever }
    }

    /// The largest `|ω̇| / |ω|²` of free rotation.
    pub(crate) fn anisotropy(&self) -> f64 {
        let i = self.moments;
        match self.kind {
            InertiaKind::Equal => 0.0,
            _ => ((i.y - i.z).abs() / i.x).max((i.z - i.x).abs() / i.y).max((i.x - i.y).abs() / i.z),
        }
    }
}

/// Rotation by `angle` about a unit vector.
#[inline]
pub(super) fn about(axis: DVec3, angle: f64) -> DQuat {
    let (s, c) = math::sin_cos(0.5 * angle);
    DQuat::from_xyzw(axis.x * s, axis.y * s, axis.z * s, c)
}

/// Rotation by the vector `turn` in radians.
#[inline]
pub(crate) fn rotation(turn: DVec3) -> DQuat {
    let angle = turn.length();
    if angle > 0.0 { about(turn / angle, angle) } else { DQuat::IDENTITY }
}

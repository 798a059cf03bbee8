//! The ball's path: ballistic hops between bounces about given normals, in closed form.
//!
//! Units: ball diameters, and the time in which gravity is 1; where the ball lands does not depend on gravity.

use super::config::Downward;
use glam::DVec2;
use plaus_dist::math;

/// How the ball bounces.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Table {
    pub(super) restitution: f64,
    pub(super) downward: Downward,
}

/// One bounce: the velocity after it, and whether the rule for downward normals had to decide.
pub(super) struct Bounce {
    pub(super) velocity: DVec2,
    pub(super) downward: bool,
}

/// Unit normal at `degrees` from the vertical.
#[inline]
pub(super) fn normal(degrees: f64) -> DVec2 {
    let (sin, cos) = math::sin_cos(degrees * (std::f64::consts::PI / 180.0));
    DVec2::new(sin, cos)
}

impl Table {
    /// Reflects `incoming` about `normal` and scales the normal component by the restitution (paper, section 5.1).
    /// `None`: the draw is rejected.
    #[inline]
    pub(super) fn bounce(&self, incoming: DVec2, normal: DVec2) -> Option<Bounce> {
        let velocity = incoming - (1.0 + self.restitution) * incoming.dot(normal) * normal;
        if velocity.y > 0.0 {
            return Some(Bounce { velocity, downward: false });
        }
        let velocity = match self.downward {
            Downward::Mirror => DVec2::new(velocity.x, -velocity.y),
            Downward::Reject => return None,
            Downward::Zero => DVec2::new(velocity.x, 0.0),
            Downward::Level => DVec2::new(incoming.x, -self.restitution * incoming.y),
            Downward::Back => -self.restitution * incoming,
        };
        Some(Bounce { velocity, downward: true })
    }
}

/// Velocity of a ball that has fallen `height` from rest.
#[inline]
pub(super) fn fallen(height: f64) -> DVec2 {
    DVec2::new(0.0, -(2.0 * height).sqrt())
}

/// How far a ball launched with `velocity` flies until it is back at its starting height.
#[inline]
pub(super) fn range(velocity: DVec2) -> f64 {
    2.0 * velocity.x * velocity.y
}

/// Velocity on landing back at the height of the launch.
#[inline]
pub(super) fn landing(velocity: DVec2) -> DVec2 {
    DVec2::new(velocity.x, -velocity.y)
}

/// Lets the ball bounce on `normals`: gives its resting place, or `None` if a bounce rejects the draw. `visit` gets
/// each bounce's place, normal and velocity after it.
#[inline]
pub(super) fn fly(
    table: &Table,
    height: f64,
    normals: impl IntoIterator<Item = DVec2>,
    visit: impl FnMut(f64, DVec2, &Bounce),
) -> Option<f64> {
    go_on(table, (0.0, fallen(height)), normals, visit).map(|(x, _)| x)
}

/// The same from where the ball comes down at x with a velocity. Gives where it comes down in the end, and how.
#[inline]
pub(super) fn go_on(
    table: &Table,
    (mut x, mut incoming): (f64, DVec2),
    normals: impl IntoIterator<Item = DVec2>,
    mut visit: impl FnMut(f64, DVec2, &Bounce),
) -> Option<(f64, DVec2)> {
    for normal in normals {
        let bounce = table.bounce(incoming, normal)?;
        visit(x, normal, &bounce);
        x += range(bounce.velocity);
        incoming = landing(bounce.velocity);
    }
    Some((x, incoming))
}

/// Which bounces are downward: bit i for bounce i, counted from 0.
pub(super) type Pattern = u64;

/// Lets the ball bounce: gives its resting place, and which bounces were downward.
#[inline]
pub(super) fn rest(table: &Table, height: f64, normals: impl IntoIterator<Item = DVec2>) -> (Option<f64>, Pattern) {
    rest_from(table, (0.0, fallen(height)), normals)
}

/// The same from where the ball comes down at x with a velocity.
#[inline]
pub(super) fn rest_from(
    table: &Table,
    start: (f64, DVec2),
    normals: impl IntoIterator<Item = DVec2>,
) -> (Option<f64>, Pattern) {
    let (mut downward, mut bit) = (0, 1);
    let end = go_on(table, start, normals, |_, _, bounce| {
        downward |= if bounce.downward { bit } else { 0 };
        bit <<= 1;
    });
    (end.map(|(x, _)| x), downward)
}

//! Points at which bodies touch: fixed parts, or each other.

use super::contact_id::ContactId;
use crate::rigid::body_state::Pose;
use crate::rigid::tolerances::SAME_POINT;
use crate::scenery::Surface;
use glam::DVec3;

/// A point of a body on a part.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ContactPoint {
    /// Its name, and the part that it touches.
    pub(crate) surface: Surface,
    pub(crate) part: u16,
    /// From the centre of gravity to the point of contact, in world axes.
    pub(crate) arm: DVec3,
    /// Unit normal out of the part.
    pub(crate) normal: DVec3,
    pub(crate) gap: f64,
}

impl ContactPoint {
    /// A touch by a numbered point of a body.
    pub(crate) fn of_point(part: u16, point: u16, arm: DVec3, normal: DVec3, gap: f64) -> Self {
        Self { surface: Surface::Part { part, point }, part, arm, normal, gap }
    }

    /// Whether a point of a body of this size, at `arm` from its centre of gravity, is the same.
    pub(crate) fn is_same(&self, arm: DVec3, normal: DVec3, size: f64) -> bool {
        (self.arm - arm).length() <= SAME_POINT * size && self.normal.dot(normal) >= 1.0 - SAME_POINT
    }

    /// The number of the body's point, if it has one.
    #[inline]
    pub(crate) fn point(&self) -> Option<usize> {
        match self.surface {
            Surface::Part { point, .. } => Some(usize::from(point)),
            _ => None,
        }
    }
}

/// The nearest points of two bodies.
#[derive(Debug, Clone, Copy)]
pub(crate) struct PairContactPoint {
    /// Unit normal towards the first.
    pub(crate) normal: DVec3,
    /// From each centre of gravity to its nearest point.
    pub(crate) arms: [DVec3; 2],
    pub(crate) gap: f64,
    /// The elements that meet there, for bodies that are compared by their convex pieces.
    pub(crate) id: Option<ContactId>,
}

impl PairContactPoint {
    /// A number for the elements that meet there, which no other point of the same two bodies has.
    pub(crate) fn name(&self) -> u64 {
        self.id.map_or(0, |ContactId { own, other, mark }| {
            u64::from(mark.number()) | u64::from(own) << 24 | u64::from(other) << 32
        })
    }

    /// Rate of the gap.
    #[inline]
    pub(crate) fn rate(&self, a: &Pose, b: &Pose) -> f64 {
        (a.velocity(self.arms[0]) - b.velocity(self.arms[1])).dot(self.normal)
    }
}

/// Arms from centres of gravity at `x` to the point half way between their ends. If the impulses act on both bodies at
/// one point, the bodies keep their angular momentum.
pub(crate) fn to_middle(arms: [DVec3; 2], x: [DVec3; 2]) -> [DVec3; 2] {
    let half = ((x[0] + arms[0]) - (x[1] + arms[1])) * 0.5;
    [arms[0] - half, arms[1] + half]
}

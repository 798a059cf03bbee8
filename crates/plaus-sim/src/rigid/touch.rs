//! Points at which bodies touch: fixed parts, or each other.

use super::body::Pose;
use crate::scenery::Surface;
use crate::shape::convex_pair::Mark;
use glam::DVec3;

/// The name of a point of contact: a piece of each body, and the elements that meet.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Spot {
    pub(super) own: u8,
    pub(super) other: u32,
    pub(super) mark: Mark,
}

/// Bits for the index of the own piece in a packed name.
const OWN: u32 = 32 - crate::shape::convex_pair::BITS;

impl Spot {
    /// The name of a point of a body on a part.
    pub(super) fn surface(self, part: u16) -> Surface {
        let point = u32::from(self.own) | self.mark.number() << OWN;
        Surface::Spot { part, piece: self.other, point }
    }

    /// The name that was packed.
    pub(super) fn of_surface(piece: u32, point: u32) -> Self {
        Self { own: (point & ((1 << OWN) - 1)) as u8, other: piece, mark: Mark::of_number(point >> OWN) }
    }
}

/// A point of a body on a part.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Touch {
    /// Its name, and the part that it touches.
    pub(crate) surface: Surface,
    pub(crate) part: u16,
    /// From the centre of gravity to the point of contact, in world axes.
    pub(crate) arm: DVec3,
    /// Unit normal out of the part.
    pub(crate) normal: DVec3,
    pub(crate) gap: f64,
}

impl Touch {
    /// A touch by a numbered point of a body.
    pub(crate) fn of_point(part: u16, point: u16, arm: DVec3, normal: DVec3, gap: f64) -> Self {
        Self { surface: Surface::Part { part, point }, part, arm, normal, gap }
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
pub(crate) struct PairTouch {
    /// Unit normal towards the first.
    pub(crate) normal: DVec3,
    /// From each centre of gravity to its nearest point.
    pub(crate) arms: [DVec3; 2],
    pub(crate) gap: f64,
    /// The elements that meet there, for bodies that are compared by their convex pieces.
    pub(crate) spot: Option<Spot>,
}

impl PairTouch {
    /// A number for the elements that meet there, which no other point of the same two bodies has.
    pub(super) fn name(&self) -> u64 {
        self.spot.map_or(0, |Spot { own, other, mark }| {
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
pub(super) fn to_middle(arms: [DVec3; 2], x: [DVec3; 2]) -> [DVec3; 2] {
    let half = ((x[0] + arms[0]) - (x[1] + arms[1])) * 0.5;
    [arms[0] - half, arms[1] + half]
}

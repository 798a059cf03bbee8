//! What identifies a point of contact of convex pieces from step to step.

use crate::scenery::Surface;
use crate::shape::convex_pair::Mark;

/// The name of a point of contact: a piece of each body, and the elements that meet.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct ContactId {
    pub(crate) own: u8,
    pub(crate) other: u32,
    pub(crate) mark: Mark,
}

/// Bits for the index of the own piece in a packed name.
const OWN_PIECE_BITS: u32 = 32 - crate::shape::convex_pair::BITS;

impl ContactId {
    /// The name of a point of a body on a part.
    pub(crate) fn surface(self, part: u16) -> Surface {
        let point = u32::from(self.own) | self.mark.number() << OWN_PIECE_BITS;
        Surface::Spot { part, piece: self.other, point }
    }

    /// The name that was packed.
    pub(crate) fn of_surface(piece: u32, point: u32) -> Self {
        Self {
            own: (point & ((1 << OWN_PIECE_BITS) - 1)) as u8,
            other: piece,
            mark: Mark::of_number(point >> OWN_PIECE_BITS),
        }
    }
}

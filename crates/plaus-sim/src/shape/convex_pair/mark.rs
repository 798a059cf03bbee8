//! The names of points of contact of two pieces.

use crate::shape::On;
use crate::shape::hull_pair::Feature;
use crate::shape::piece::Core;

/// The elements that meet at a point of contact, so that the same point can be found again at other poses.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Mark {
    /// The nearest points, whatever they are.
    Nearest,
    /// Of two polyhedra.
    Polyhedra(Feature),
    /// A corner of the core `of` (0 or 1) on the other.
    Corner { of: u8, corner: u8 },
    /// A point of a rim of the core `of` on the other.
    Rim { of: u8, ring: u8, slot: u8 },
    /// A point of an edge of the core `of`: the one nearest to the other core (0), or where the edge crosses the rim of
    /// the other's lower (1, 2) or upper (3, 4) disc.
    Edge { of: u8, edge: u8, at: u8 },
    /// A corner, or a point of a rim (`slot`), of the first over the plane of a face of the other; or over a plane that
    /// is no piece ([`Mark::PLANE`]).
    Over { element: u8, slot: u8, face: u8 },
    /// Where the line on the side of the core `of` that is nearest to the other core crosses a rim of that core: one of
    /// two places.
    Side { of: u8, ring: u8, at: u8 },
    /// A crossing of two rims: a set bit in `rings` means a core's upper rim, and `side` tells the two crossings apart.
    Rims { rings: [u8; 2], side: u8 },
}

/// Bits of a name: for sixteen kinds, for two numbers of eight bits, and for one of three.
const KIND: u32 = 4;
const FIRST: u32 = 8;
const SECOND: u32 = 8;

/// Bits that a packed name needs.
pub(crate) const BITS: u32 = KIND + FIRST + SECOND + 3;

fn pack([kind, first, second, third]: [u8; 4]) -> u32 {
    u32::from(kind) | u32::from(first) << KIND | u32::from(second) << (KIND + FIRST) | u32::from(third) << (BITS - 3)
}

impl Mark {
    /// The face of a plane that is no piece.
    pub(crate) const PLANE: u8 = u8::MAX;

    /// If it is a point of a rim of the first core: the ring, and the slot.
    pub(crate) fn own_rim(self, core: &Core) -> Option<(u8, u8)> {
        match (self, core) {
            (Self::Rim { of: 0, ring, slot }, Core::Discs(_)) => Some((ring, slot)),
            (Self::Over { element, slot, .. }, Core::Discs(_)) => Some((element, slot)),
            _ => None,
        }
    }

    /// A number that no other name has.
    pub(crate) fn number(self) -> u32 {
        pack(match self {
            Self::Nearest => [0, 0, 0, 0],
            Self::Polyhedra(Feature::Edges(i, j)) => [1, i, j, 0],
            Self::Polyhedra(Feature::Corner { of, corner, on }) => {
                let (kind, on) = match on {
                    On::Face(k) => (2, k),
                    On::Edge(k) => (3, k),
                    On::Corner(k) => (4, k),
                };
                [kind, corner, on, of]
            }
            Self::Corner { of, corner } => [5, corner, of, 0],
            Self::Rim { of, ring, slot } => [6, ring, of, slot],
            Self::Edge { of, edge, at } => [7, edge, of, at],
            Self::Rims { rings: [i, j], side } => [8, i, j, side],
            Self::Over { element, slot, face } => [9, element, face, slot],
            Self::Side { of, ring, at } => [10, of, ring, at],
        })
    }

    /// The name with that number.
    pub(crate) fn of_number(number: u32) -> Self {
        let part = |from: u32, bits: u32| (number >> from & ((1 << bits) - 1)) as u8;
        let (kind, first, second, third) =
            (part(0, KIND), part(KIND, FIRST), part(KIND + FIRST, SECOND), part(BITS - 3, 3));
        let corner = |on: On| Self::Polyhedra(Feature::Corner { of: third, corner: first, on });
        match kind {
            1 => Self::Polyhedra(Feature::Edges(first, second)),
            2 => corner(On::Face(second)),
            3 => corner(On::Edge(second)),
            4 => corner(On::Corner(second)),
            5 => Self::Corner { of: second, corner: first },
            6 => Self::Rim { of: second, ring: first, slot: third },
            7 => Self::Edge { of: second, edge: first, at: third },
            8 => Self::Rims { rings: [first, second], side: third },
            10 => Self::Side { of: first, ring: second, at: third },
            9 => Self::Over { element: first, slot: third, face: second },
            _ => Self::Nearest,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_name_marks() {
        let mut marks = vec![Mark::Nearest];
        for of in 0..2 {
            for k in [0, 1, 17, 63, 185] {
                marks.push(Mark::Polyhedra(Feature::Edges(k, 200 + of)));
                for on in [On::Face(k), On::Edge(k), On::Corner(k)] {
                    marks.push(Mark::Polyhedra(Feature::Corner { of, corner: k / 3, on }));
                }
                marks.push(Mark::Corner { of, corner: k });
                marks.extend((0..5).map(|at| Mark::Edge { of, edge: k, at }));
                marks.push(Mark::Over { element: k, slot: of, face: 254 + of });
            }
            for ring in 0..2 {
                marks.extend((0..5).map(|slot| Mark::Rim { of, ring, slot }));
                marks.extend((0..2).map(|side| Mark::Rims { rings: [of, ring], side }));
                marks.extend((0..2).map(|at| Mark::Side { of, ring, at }));
            }
        }
        let mut numbers: Vec<u32> = marks.iter().map(|m| m.number()).collect();
        for (mark, &number) in marks.iter().zip(&numbers) {
            assert_eq!(Mark::of_number(number), *mark);
            assert!(number < 1 << BITS);
        }
        numbers.sort_unstable();
        numbers.dedup();
        assert_eq!(numbers.len(), marks.len());
    }
}

//! Axes of bodies, and their faces with numbers.

use super::cast::{Cast, FACES};
use glam::{DQuat, DVec3};
use plaus_animation::{Shape, Track};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::borrow::Cow;

/// An axis of a body, in its own frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Axis {
    /// Its first.
    X,
    /// The opposite of its first.
    MinusX,
    /// Its second.
    Y,
    /// The opposite of its second.
    MinusY,
    /// Its third. For a pin, it points to the head.
    #[default]
    Z,
    /// The opposite of its third.
    MinusZ,
}

/// Axes in the order of the pips of a shape.
const AXES: [(Axis, DVec3); 6] = [
    (Axis::X, DVec3::X),
    (Axis::MinusX, DVec3::NEG_X),
    (Axis::Y, DVec3::Y),
    (Axis::MinusY, DVec3::NEG_Y),
    (Axis::Z, DVec3::Z),
    (Axis::MinusZ, DVec3::NEG_Z),
];

impl Axis {
    pub(super) fn vector(self) -> DVec3 {
        AXES.into_iter().find(|(axis, _)| *axis == self).map_or(DVec3::Z, |(_, vector)| vector)
    }
}

/// The number, from 1, of the direction that is most along another one; 0 if there is none.
fn most_along(directions: &[DVec3], up: DVec3) -> u32 {
    let best = (0..directions.len()).max_by(|&a, &b| directions[a].dot(up).total_cmp(&directions[b].dot(up)));
    best.map_or(0, |best| best as u32 + 1)
}

/// The number of the face of a body that counts: of those that are marked, or else of the one that points up most, with
/// faces numbered as on a die: 1 along its z axis, 2 along y, 3 along x.
pub(crate) fn upper_face(marks: &[DVec3], turn: DQuat) -> u32 {
    most_along(if marks.is_empty() { &FACES } else { marks }, turn.inverse() * DVec3::Z)
}

/// The directions along a body's own axes that point up where each of its numbers is read; `None` if it has no numbers.
fn marks<'a>(cast: &'a Cast, track: &Track) -> Option<Cow<'a, [DVec3]>> {
    if let Some(marks) = cast.marks.get(&track.name) {
        return Some(Cow::Borrowed(marks));
    }
    let Shape::Cuboid { pips: Some(pips), .. } = &*track.shape else { return None };
    let of = |face: u8| pips.iter().zip(AXES).find(|(pip, _)| **pip == face).map(|(_, (_, vector))| vector);
    (1..=6).map(of).collect::<Option<Vec<DVec3>>>().map(Cow::Owned)
}

/// The number of a body that counts; `None` if it has no numbers.
pub(super) fn face_up(cast: &Cast, track: &Track, time: f64) -> Option<u32> {
    Some(most_along(&marks(cast, track)?, track.orientation(time).inverse() * DVec3::Y))
}

/// How many faces a body has that are numbered, as far as its name tells: six unless they are marked.
pub(super) fn count(cast: &Cast, body: &str) -> usize {
    cast.marks.get(body).map_or(FACES.len(), Vec::len)
}

/// A side of a body.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Side {
    /// An axis in its own frame.
    Axis(DVec3),
    /// A face, by its number.
    Face(u32),
}

impl Side {
    /// The axis that is meant, in the frame of a body with this name.
    pub(super) fn axis(self, body: &str, cast: &Cast) -> Option<DVec3> {
        match (self, cast.marks.get(body)) {
            (Self::Axis(axis), _) => Some(axis),
            (Self::Face(face), Some(marks)) => marks.get(face as usize - 1).copied(),
            (Self::Face(face), None) => FACES.get(face as usize - 1).copied(),
        }
    }

    /// The same of a body that is seen; `None` if it has no such face.
    pub(super) fn axis_of(self, cast: &Cast, track: &Track) -> Option<DVec3> {
        match self {
            Self::Axis(axis) => Some(axis),
            Self::Face(face) => marks(cast, track)?.get(face as usize - 1).copied(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use plaus_animation::Look;

    #[test]
    fn faces_lie_where_a_die_has_them() {
        let track = |shape| Track::new("die", shape, Look::STONE, Vec::new());
        let (cast, die, ball) = (Cast::default(), track(Shape::die(0.016)), track(Shape::ball(1.0)));
        for (face, vector) in (1..).zip(FACES) {
            assert_eq!(Side::Face(face).axis_of(&cast, &die), Some(vector));
        }
        assert_eq!((Side::Face(1).axis_of(&cast, &ball), Side::Face(7).axis_of(&cast, &die)), (None, None));
        let marked = Cast { marks: [("die".to_owned(), vec![DVec3::X; 7])].into(), ..cast };
        assert_eq!(Side::Face(7).axis_of(&marked, &die), Some(DVec3::X));
    }
}

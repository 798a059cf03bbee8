//! Which face, or axis, of a body is up.

use crate::require::aim::{Aim, End, Up};
use crate::require::claim::Claim;
use crate::require::kinds::Ask;
use crate::require::looks::Looks;
use crate::require::missed::Nat;
use crate::require::place::Place;
use crate::require::probe::Probe;
use crate::require::score::Reach;
use crate::require::when::When;
use crate::scene::ConfigError;
use crate::settings::settings;
use glam::{DQuat, DVec3};
use plaus_animation::{Shape, Track};
use plaus_dist::math;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

settings! {
    /// A face of a die, or an axis of a body, points up: at the end, or at some time.
    pub struct FacesUp {
        /// Name of a body. May be left out if there is only one.
        body: String;
        /// Which face, for a body with pips. Unset: `axis` is used.
        #[schemars(extend("x-example" = 6))]
        face: Option<u32>, 1..=6;
        /// Which axis of the body.
        axis: Axis = Axis::Z;
        /// How far from upright it may be.
        within_deg: f64 = 20.0, 0.1..=180.0, "degree";
        /// How many degrees beyond that cost one nat.
        scale_deg: f64 = 10.0, 1e-3..=1e4, "degree";
        /// At which time: `at_s`, `frame` or `from_s`. Unset: at the end.
        when: When;
    }
}

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

/// Where the faces 1 to 6 of a die lie.
const FACES: [DVec3; 6] = [DVec3::Z, DVec3::Y, DVec3::X, DVec3::NEG_X, DVec3::NEG_Y, DVec3::NEG_Z];

impl Axis {
    fn vector(self) -> DVec3 {
        AXES.into_iter().find(|(axis, _)| *axis == self).map_or(DVec3::Z, |(_, vector)| vector)
    }
}

/// Angle in degrees between an axis of a body and the vertical.
pub(super) fn tilt(track: &Track, axis: DVec3, time: f64) -> f64 {
    let up = track.orientation(time) * axis;
    math::acos(up.y.clamp(-1.0, 1.0)).to_degrees()
}

/// The pips on the face that points most in a direction, which is along the body's axes.
fn most_along(pips: &[u8; 6], direction: DVec3) -> u8 {
    let faces = pips.iter().zip(AXES).map(|(pip, (_, axis))| (direction.dot(axis), *pip));
    faces.max_by(|a, b| a.0.total_cmp(&b.0)).map_or(0, |(_, pip)| pip)
}

/// The number of the face of a body that points up most, with faces numbered as on a die: 1 along its z axis, 2 along
/// y, 3 along x.
pub(crate) fn upper_face(turn: DQuat) -> u8 {
    most_along(&Shape::PIPS, turn.inverse() * DVec3::Z)
}

/// The pips on the face of a body that points up most; `None` if it has no pips.
pub(super) fn face_up(track: &Track, time: f64) -> Option<u8> {
    let Shape::Cuboid { pips: Some(pips), .. } = &track.shape else { return None };
    Some(most_along(pips, track.orientation(time).inverse() * DVec3::Y))
}

impl FacesUp {
    fn axis_of(&self, shape: &Shape) -> Option<DVec3> {
        let Some(face) = self.face else { return Some(self.axis.vector()) };
        let Shape::Cuboid { pips: Some(pips), .. } = shape else { return None };
        pips.iter().zip(AXES).find(|(pip, _)| u32::from(**pip) == face).map(|(_, (_, vector))| vector)
    }
}

impl Ask for FacesUp {
    fn check(&self, place: &Place<'_>) -> Result<(), ConfigError> {
        place.one_body("body", &self.body)?;
        if self.face.is_some() && !place.cast().faces {
            return Err(place.at("face").wrong("no body here has faces with pips; use `axis`"));
        }
        place.turned()?;
        self.when.check(place)
    }

    fn subject(&self) -> Option<&str> {
        Some(&self.body)
    }

    fn nat(&self) -> Option<Nat> {
        Some(Nat::of(self.scale_deg, "degrees"))
    }

    fn reach(&self, probe: &Probe<'_>) -> Reach {
        let probe = probe.turned();
        let margin = |angle: f64| (self.within_deg - angle) / self.scale_deg;
        let Some(time) = probe.moment(self.when.instant()) else { return Reach::between(margin(180.0), margin(0.0)) };
        let track = probe.track(&self.body);
        let angle = track.and_then(|track| Some(tilt(track, self.axis_of(&track.shape)?, time)));
        angle.map_or(Reach::NEVER, |angle| Reach::certain(margin(angle)))
    }

    fn looks(&self) -> Looks {
        Looks::at(self.when.instant())
    }

    fn claims(&self) -> Vec<Claim> {
        let face = self.face.and_then(|face| FACES.get(face as usize - 1));
        let axis = face.copied().unwrap_or(self.axis.vector());
        vec![Claim::Up { body: self.body.clone(), at: self.when.instant(), axis, within_deg: self.within_deg }]
    }

    fn aims(&self) -> Vec<Aim> {
        let is_at_end = self.when.instant().is_none() && self.face.is_none();
        let up = Up { axis: self.axis.vector(), within: self.within_deg, scale: self.scale_deg };
        is_at_end.then(|| Aim { body: self.body.clone(), end: End::Up(up) }).into_iter().collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn faces_lie_where_a_die_has_them() {
        let shape = Shape::die(0.016);
        for (face, vector) in (1..).zip(FACES) {
            let up = FacesUp { face: Some(face), ..FacesUp::default() };
            assert_eq!(up.axis_of(&shape), Some(vector));
        }
        let up = FacesUp { face: Some(1), ..FacesUp::default() };
        assert_eq!(up.axis_of(&Shape::ball(1.0)), None);
    }
}

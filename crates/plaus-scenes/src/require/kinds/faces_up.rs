//! Which face, or axis, of a body is up.

use crate::require::aim::{Aim, End, Up};
use crate::require::cast::{Cast, FACES};
use crate::require::claim::{Claim, Side};
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
use std::borrow::Cow;

settings! {
    /// A face of a die, or an axis of a body, points up: at the end, or at some time.
    pub struct FacesUp {
        /// Name of a body. May be left out if there is only one.
        body: String;
        /// Which face, for a die or a body with marked `faces`: the one that counts, which of a die with 4 faces lies
        /// below. Unset: `axis` is used.
        #[schemars(extend("x-example" = 6))]
        face: Option<u32>, 1..=100;
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
    let Shape::Cuboid { pips: Some(pips), .. } = &track.shape else { return None };
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

impl FacesUp {
    fn axis_of(&self, cast: &Cast, track: &Track) -> Option<DVec3> {
        let Some(face) = self.face else { return Some(self.axis.vector()) };
        marks(cast, track)?.get(face as usize - 1).copied()
    }
}

impl Ask for FacesUp {
    fn check(&self, place: &Place<'_>) -> Result<(), ConfigError> {
        place.one_body("body", &self.body)?;
        let cast = place.cast();
        if self.face.is_some() && !cast.faces && cast.marks.is_empty() {
            return Err(place.at("face").wrong("no body here has faces with numbers; use `axis`, or mark its `faces`"));
        }
        let body = cast.only_or(self.body.clone());
        let most = match body.as_str() {
            "" => cast.marks.values().map(Vec::len).max().unwrap_or(0).max(FACES.len()),
            body => count(cast, body),
        };
        if self.face.is_some_and(|face| face as usize > most) {
            return Err(place.at("face").wrong(&format!("its faces are numbered from 1 to {most}")));
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
        let angle = track.and_then(|track| Some(tilt(track, self.axis_of(probe.cast(), track)?, time)));
        angle.map_or(Reach::NEVER, |angle| Reach::certain(margin(angle)))
    }

    fn looks(&self) -> Looks {
        Looks::at(self.when.instant())
    }

    fn claims(&self) -> Vec<Claim> {
        let side = self.face.map_or(Side::Axis(self.axis.vector()), Side::Face);
        vec![Claim::Up { body: self.body.clone(), at: self.when.instant(), side, within_deg: self.within_deg }]
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
    use plaus_animation::Look;

    #[test]
    fn faces_lie_where_a_die_has_them() {
        let track = |shape| Track::new("die", shape, Look::STONE, Vec::new());
        let (cast, die, ball) = (Cast::default(), track(Shape::die(0.016)), track(Shape::ball(1.0)));
        let up = |face: u32| FacesUp { face: Some(face), ..FacesUp::default() };
        for (face, vector) in (1..).zip(FACES) {
            assert_eq!(up(face).axis_of(&cast, &die), Some(vector));
        }
        assert_eq!((up(1).axis_of(&cast, &ball), up(7).axis_of(&cast, &die)), (None, None));
        let marked = Cast { marks: [("die".to_owned(), vec![DVec3::X; 7])].into(), ..cast };
        assert_eq!(up(7).axis_of(&marked, &die), Some(DVec3::X));
    }
}

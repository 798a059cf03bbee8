//! Claims of requirements, which others may contradict.

use super::cast::{Cast, FACES};
use super::event::Event;
use super::score::Band;
use super::when::Window;
use glam::DVec3;
use plaus_dist::math;

/// A claim about something that can be only one way.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Claim {
    /// An axis of a body, in its own frame, points up to within some degrees, at the end or at a time.
    Up {
        /// The body.
        body: String,
        /// The time; `None` means the end.
        at: Option<f64>,
        /// The axis.
        side: Side,
        /// How far from upright it may be.
        within_deg: f64,
    },
    /// A body comes to rest at a place.
    Place {
        /// The body.
        body: String,
        /// x, y and z in mm; `None` if a coordinate does not matter.
        at: [Option<f64>; 3],
        /// How far off it may be, in mm.
        within: f64,
    },
    /// An event happens within a window.
    Time {
        /// The event.
        event: Box<Event>,
        /// The window.
        window: Window,
    },
    /// These pins are left, and no others.
    Left(Vec<u32>),
    /// A number lies in a band.
    Number {
        /// The name of the number.
        what: String,
        /// Where it begins.
        from: f64,
        /// Where it ends.
        to: f64,
    },
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
    /// The axis that points up, of a body with this name.
    fn axis(self, body: &str, cast: &Cast) -> Option<DVec3> {
        match (self, cast.marks.get(body)) {
            (Self::Axis(axis), _) => Some(axis),
            (Self::Face(face), Some(marks)) => marks.get(face as usize - 1).copied(),
            (Self::Face(face), None) => FACES.get(face as usize - 1).copied(),
        }
    }
}

impl Claim {
    pub(super) fn time(event: Event, window: Window) -> Self {
        Self::Time { event: Box::new(event), window }
    }

    pub(super) fn number(what: String, band: Band) -> Self {
        Self::Number { what, from: band.from, to: band.to }
    }

    /// Why the two cannot both be met; `None` if they may.
    pub(super) fn contradicts(&self, other: &Self, cast: &Cast) -> Option<String> {
        let only = cast.only().unwrap_or_default();
        match (self, other) {
            (
                Self::Up { body: a, at: when, side, within_deg },
                Self::Up { body: b, at: then, side: another, within_deg: besides },
            ) => {
                let [a, b] = named(only, [a, b]);
                let (axis, another) = (side.axis(a, cast)?, another.axis(b, cast)?);
                let between = math::acos(axis.dot(another).clamp(-1.0, 1.0)).to_degrees();
                let apart = a == b && when == then && between > within_deg + besides;
                apart.then(|| format!("two sides of {a}, {between:.0}° apart, cannot both be up"))
            }
            (Self::Place { body: a, at: one, within }, Self::Place { body: b, at: two, within: besides }) => {
                let [a, b] = named(only, [a, b]);
                let squares =
                    one.iter().zip(two).map(|(one, two)| one.zip(*two).map_or(0.0, |(x, y)| math::square(x - y)));
                let between = squares.sum::<f64>().sqrt();
                let apart = a == b && between > within + besides;
                apart.then(|| format!("{a} cannot rest at two places {between:.3} mm apart"))
            }
            (Self::Time { event: a, window: one }, Self::Time { event: b, window: two }) => {
                let [x, y] = named(only, [&a.body, &b.body]);
                let alike =
                    Event { body: x.into(), ..(**a).clone() }.is_same(&Event { body: y.into(), ..(**b).clone() });
                let apart = alike && (one.to < two.from || two.to < one.from);
                apart.then(|| "one event cannot happen in two windows that do not overlap".to_owned())
            }
            (Self::Left(one), Self::Left(other)) => {
                let lacks = |one: &[u32], other: &[u32]| other.iter().find(|pin| !one.contains(pin)).copied();
                let pin = lacks(one, other).or_else(|| lacks(other, one));
                pin.map(|pin| format!("pin {pin} cannot both stand and fall"))
            }
            (Self::Number { what: a, from, to }, Self::Number { what: b, from: low, to: high }) => (a == b
                && (to < low || high < from))
                .then(|| "a number cannot lie in two ranges that do not overlap".to_owned()),
            _ => None,
        }
    }
}

/// Names of bodies; a name that is left out means the only body there is.
fn named<'a>(only: &'a str, names: [&'a str; 2]) -> [&'a str; 2] {
    names.map(|name| if name.is_empty() { only } else { name })
}

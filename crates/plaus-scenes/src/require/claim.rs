//! Claims of requirements, which others may contradict.

use super::cast::Cast;
use super::event::Event;
use super::score::Band;
use super::sides::Side;
use super::when::Window;
use glam::DVec3;
use plaus_dist::math;

/// A claim about something that can be only one way.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Claim {
    /// A side of a body points in a direction to within some degrees, at the end or at a time.
    Points {
        /// The body.
        body: String,
        /// The time; `None` means the end.
        at: Option<f64>,
        /// The side.
        side: Side,
        /// The direction, of length 1, along the scenario's axes.
        toward: DVec3,
        /// How far from it the side may point.
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
                Self::Points { body: a, at: when, side, toward, within_deg },
                Self::Points { body: b, at: then, side: another, toward: elsewhere, within_deg: besides },
            ) => {
                let [a, b] = named(only, [a, b]);
                let angle = |one: DVec3, other: DVec3| math::acos(one.dot(other).clamp(-1.0, 1.0)).to_degrees();
                let sides = angle(side.axis(a, cast)?, another.axis(b, cast)?);
                let ways = angle(*toward, *elsewhere);
                // A rotation keeps angles.
                let apart = a == b && when == then && (sides - ways).abs() > within_deg + besides;
                apart.then(|| match ways {
                    0.0 if *toward == DVec3::Z => format!("two sides of {a}, {sides:.0}° apart, cannot both be up"),
                    _ => format!("two sides of {a}, {sides:.0}° apart, cannot point in directions {ways:.0}° apart"),
                })
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

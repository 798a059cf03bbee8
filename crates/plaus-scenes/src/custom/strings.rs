//! Strings, fastened to a body or wound on a drum of it.

use super::amount::{Amount, Impulse, Length, Place, Rounding};
use super::values::{Collector, MM, Numbers, Owner, Value, Values, vector};
use crate::scene::ConfigError;
use glam::DVec3;
use plaus_sim::rigid::{self, Start, Winding};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A string: it pulls where it is taut, and never pushes. It touches nothing; the bodies at its two ends may touch each
/// other.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct StringJoint {
    /// Where its other end is at the start; there it is fastened to `to`. Its first end is where the joint is.
    pub to_mm: [Amount<Place>; 3],
    /// How much longer it is than what it spans at the start.
    #[serde(default)]
    pub slack_mm: Amount<Rounding>,
    /// The drum of the body on which it is wound. Unset: it is fastened to the body.
    #[serde(default)]
    pub wound: Option<Wound>,
    /// An impact whose impulse on the string is larger breaks it, and so does a pull of that impulse with which it
    /// becomes taut, unless that is so slow that it counts as lasting. Unset: it never breaks.
    #[serde(default)]
    pub breaks_at_n_s: Option<Amount<Impulse>>,
}

/// The drum on which a string is wound. Its middle is where the joint is. The string winds and unwinds without
/// slipping; when it is all off, it hangs from where it is fastened on the rim, and then winds on the other way round.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Wound {
    /// The direction of its axis at the start, of any length but 0. Pulling string off it turns the drum anticlockwise
    /// about this axis.
    pub axis: [f64; 3],
    /// Its radius, to the middle of the string.
    pub radius_mm: Amount<Length>,
    /// How much string is wound at the start.
    #[serde(default)]
    pub length_mm: Amount<Rounding>,
}

/// A string with its numbers as values.
#[derive(Debug, Clone)]
pub(super) struct Cord {
    to: Values,
    slack: Value,
    /// Axis, radius, and what is wound.
    wound: Option<(DVec3, Value, Value)>,
}

impl Cord {
    /// The string of a joint that is at `at`.
    pub(super) fn new(
        collector: &mut Collector,
        owner: &Owner<'_>,
        string: &StringJoint,
        at: &Values,
    ) -> Result<Self, ConfigError> {
        let to = collector.three(owner, "kind.string.to_mm", ["to_x", "to_y", "to_z"], &string.to_mm)?;
        let slack = collector.number(owner, "kind.string.slack_mm", "slack", &string.slack_mm)?;
        let wound = match &string.wound {
            None => None,
            Some(Wound { axis, radius_mm, length_mm }) => {
                let axis = DVec3::from_array(*axis);
                if axis.try_normalize().is_none() {
                    let message = "a direction needs a length: [0, 1, 0], for example";
                    return Err(owner.wrong("kind.string.wound.axis", message));
                }
                let radius = collector.number(owner, "kind.string.wound.radius_mm", "drum_radius", radius_mm)?;
                let length = collector.number(owner, "kind.string.wound.length_mm", "wound", length_mm)?;
                Some((axis, radius, length))
            }
        };
        // Of what is uncertain, a draw in which an end is within the drum counts as one with the end on its rim.
        let fixed = |values: &Values| {
            let ends = values.map(|value| collector.ends(value));
            ends.iter().all(|(low, high)| low == high).then(|| DVec3::from_array(ends.map(|(low, _)| low)))
        };
        if let (Some(at), Some(end)) = (fixed(at), fixed(&to)) {
            let way = end - at;
            match &wound {
                None if way == DVec3::ZERO && collector.ends(slack).0 == 0.0 => {
                    let message = "it is where the joint is, so the string has no length: move it, or give `slack_mm`";
                    return Err(owner.wrong("kind.string.to_mm", message));
                }
                Some((axis, radius, _)) => {
                    let (far, (least, _)) = (way.reject_from(*axis).length(), collector.ends(*radius));
                    if far < least {
                        let message = format!(
                            "it is {far} mm from the axis of the drum, whose radius is {least} mm: it must be outside"
                        );
                        return Err(owner.wrong("kind.string.to_mm", message));
                    }
                }
                None => {}
            }
        }
        Ok(Self { to, slack, wound })
    }

    /// The string in a draw, from a point of a body to the fixed world.
    pub(super) fn joint(&self, numbers: &Numbers<'_>, at: DVec3, body: usize, start: &Start) -> rigid::Joint {
        let to = vector(&self.to, numbers) * MM;
        let joint = match self.wound {
            None => rigid::Joint::string(at, to, body, start),
            Some((axis, radius, length)) => {
                let [radius, length] = [radius, length].map(|value| value.metres(numbers));
                rigid::Joint::wound(at, to, &Winding { axis, radius: radius.max(LEAST), length }, body, start)
            }
        };
        let rigid::JointKind::String(string) = joint.kind else { return joint };
        joint.with_length((string.length + self.slack.metres(numbers)).max(LEAST))
    }
}

/// Least length in m.
const LEAST: f64 = 1e-9;

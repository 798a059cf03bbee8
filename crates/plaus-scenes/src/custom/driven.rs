//! Bodies that follow keyframes: a paddle, a tray, a foot.

use super::amount::{self, Amount};
use super::shapes::{Made, Shape};
use super::values::{Collector, MM, Numbers, Owner, Value, Values, vector};
use crate::scene::ConfigError;
use crate::turns::by_angles;
use glam::DQuat;
use plaus_sim::rigid::{Interpolation, Key, Keyframes, Track};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::ops::{Add, Mul, Sub};

/// A body that follows its keyframes, whatever it meets: what it hits is moved, and it goes on.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Driven {
    /// Its name, for requirements, tables and exports.
    pub name: String,
    /// Makes an array of this many, as for bodies. Unset: only one.
    #[serde(default)]
    #[schemars(range(min = 1, max = 4096))]
    pub count: Option<u32>,
    /// Its shape.
    pub shape: Shape,
    /// The name of its material.
    #[serde(default)]
    pub material: String,
    /// Colour as on the web, `#c04030`. Unset: the material's.
    #[serde(default)]
    pub colour: String,
    /// How it moves between keys.
    #[serde(default)]
    pub between: Going,
    /// Where it is at which times, in order of time. Before the first key and after the last it stands still.
    #[schemars(length(min = 1, max = 10_000))]
    pub keys: Vec<At>,
    /// Groups that it is in, as for bodies.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[schemars(length(max = 64), extend("default" = []))]
    pub no_contact: Vec<String>,
    /// How likely it is there at all, as for bodies. Unset: it always is.
    #[serde(default)]
    pub present: Option<Amount<amount::Chance>>,
}

/// Where a body is at a time.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct At {
    /// When. It must come after the previous key, whatever is uncertain about the two.
    pub at_s: Amount<amount::Moment>,
    /// Where its origin is: its middle, or the origin of the points of a hull and of the pieces of a compound. It turns
    /// about it.
    pub at_mm: [Amount<amount::Place>; 3],
    /// How it is turned: about the world's x axis, then about y, then about z.
    #[serde(default)]
    pub turn_deg: [Amount<amount::Angle>; 3],
}

/// How something moves between keys.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Going {
    /// It stays where it is, and jumps to the next key at its time. The jump itself hits nothing.
    Step,
    /// Its origin moves in a straight line at a steady speed, and it turns about it the shorter way, as steadily.
    #[default]
    Linear,
    /// It moves along a curve without corners, and starts and stops gently. At a key it has the mean velocity between
    /// the previous key and the next.
    Smooth,
    /// It starts from rest, and between two keys its acceleration is constant: after 1 s at 1 m and 2 s at 4 m it was 2
    /// m/s² all the time. Its velocity has no jumps but for the last key, after which it stands still. A hinge's motor
    /// has a constant angular acceleration in the same way; a driven body turns as with `linear`.
    Accelerated,
}

/// The least time between two keys, in seconds: rounding cannot change their order.
const LEAST_GAP: f64 = 1e-9;

impl From<Going> for Interpolation {
    fn from(going: Going) -> Self {
        match going {
            Going::Step => Self::Step,
            Going::Linear => Self::Linear,
            Going::Smooth | Going::Accelerated => Self::Cubic,
        }
    }
}

/// The time of a key, which must come after the one before it.
pub(super) fn key_time(
    collector: &mut Collector,
    owner: &Owner<'_>,
    (name, short): (&str, &str),
    at: &Amount<amount::Moment>,
    before: Option<Value>,
) -> Result<Value, ConfigError> {
    let time = collector.number(owner, name, short, at)?;
    // Not a number where both may be at any time.
    let gap = before.map_or(f64::INFINITY, |before| collector.least_gap(before, &[time]));
    if gap.is_nan() || gap < LEAST_GAP {
        let (early, late) = collector.ends(time);
        let seconds = (gap.abs() * 1e6).round() / 1e6;
        let least = match gap {
            0.0.. => format!("{seconds} s after"),
            _ if gap.is_finite() => format!("{seconds} s before"),
            _ => "long before".to_owned(),
        };
        let message = format!(
            "a key, from {early} to {late} s, may come {least} the one before it: it must come {LEAST_GAP} s later at \
             least, such as at the same quantity and more"
        );
        return Err(owner.wrong(name, message));
    }
    Ok(time)
}

/// A way with its numbers as values.
#[derive(Debug, Clone)]
pub(super) struct Way {
    between: Going,
    keys: Vec<(Value, Values, Values)>,
}

impl Way {
    pub(super) fn new(collector: &mut Collector, owner: &Owner<'_>, driven: &Driven) -> Result<Self, ConfigError> {
        let mut keys = Vec::with_capacity(driven.keys.len());
        let mut before = None;
        for (index, key) in driven.keys.iter().enumerate() {
            let names = ["at_s", "at_mm", "turn_deg"].map(|name| format!("keys[{index}].{name}"));
            let short = |axis: &str| format!("key_{}_{axis}", index + 1);
            let [x, y, z] = ["x", "y", "z"].map(short);
            let [turn_x, turn_y, turn_z] = ["turn_x", "turn_y", "turn_z"].map(short);
            let time = key_time(collector, owner, (&names[0], &short("at")), &key.at_s, before)?;
            before = Some(time);
            let place = collector.three(owner, &names[1], [&x, &y, &z], &key.at_mm)?;
            keys.push((time, place, collector.three(owner, &names[2], [&turn_x, &turn_y, &turn_z], &key.turn_deg)?));
        }
        Ok(Self { between: driven.between, keys })
    }

    /// Whether no draw changes it.
    pub(super) fn is_fixed(&self) -> bool {
        let fixed = |values: &Values| values.iter().all(|value| value.is_fixed());
        self.keys.iter().all(|(time, place, turn)| time.is_fixed() && fixed(place) && fixed(turn))
    }

    /// Where it is first.
    pub(super) fn first(&self) -> (Values, Values) {
        self.keys.first().map_or(([Value::Fixed(0.0); 3], [Value::Fixed(0.0); 3]), |key| (key.1, key.2))
    }

    /// The way of a draw, of a body of this shape.
    pub(super) fn keyframes(&self, numbers: &Numbers<'_>, made: &Made) -> Keyframes {
        let (mut places, mut turns) = (Vec::new(), Vec::new());
        let mut last = DQuat::IDENTITY;
        for (time, place, turn) in &self.keys {
            let (time, turn) = (time.of(numbers), by_angles(turn.map(|angle| angle.of(numbers))));
            places.push((time, vector(place, numbers) * MM + turn * made.centre));
            // Of the two quaternions of a rotation that which is nearer to the one before.
            let turn = (turn * made.axes).normalize();
            last = if turn.dot(last) < 0.0 { -turn } else { turn };
            turns.push((time, last));
        }
        let turning = if self.between == Going::Accelerated { Going::Linear } else { self.between };
        Keyframes { position: track(self.between, &places), rotation: track(turning, &turns) }
    }
}

/// A track through values at times. At a smooth key it has the mean rate from the key before to the one after, at the
/// ends 0; at an accelerated one that which a constant acceleration since the key before leads to.
pub(super) fn track<T>(between: Going, values: &[(f64, T)]) -> Track<T>
where
    T: Copy + Add<Output = T> + Sub<Output = T> + Mul<f64, Output = T>,
{
    let mean = |from: &(f64, T), to: &(f64, T)| (to.1 - from.1) * (1.0 / (to.0 - from.0));
    let mut last: Option<(usize, T)> = None;
    let key = |(index, &(time, value)): (usize, &(f64, T))| {
        let still = value * 0.0;
        let slope = match (between, last) {
            (Going::Accelerated, Some((before, rate))) => mean(&values[before], &values[index]) * 2.0 - rate,
            (Going::Accelerated, None) => still,
            _ => index
                .checked_sub(1)
                .and_then(|before| values.get(before))
                .zip(values.get(index + 1))
                .map_or(still, |(before, after)| mean(before, after)),
        };
        last = Some((index, slope));
        Key { time, value, slopes: [slope; 2] }
    };
    Track { between: between.into(), keys: values.iter().enumerate().map(key).collect() }
}

//! Places that are uncertain within a region, all of its volume equally likely.
//!
//! A place follows from three variables that are uniform from 0 to 1, by a map under which equal volumes stay equal. So
//! any move over variables is exact, whatever the region.

use super::amount::{Amount, Length, Rounding};
use super::laws::LawOf;
use super::values::{Collector, Owner, Value, Values};
use crate::scene::ConfigError;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A region about a place, aligned with the world's axes, all of its volume equally likely; or a surface.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Within {
    /// A ball.
    Ball(WithinBall),
    /// A box.
    Box(WithinBox),
    /// An upright cylinder.
    Cylinder(WithinCylinder),
    /// The surface of a piece of scenery.
    Surface(WithinSurface),
}

/// A ball about the place.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct WithinBall {
    /// Its radius.
    pub radius_mm: Amount<Length>,
}

/// A box whose middle is the place.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct WithinBox {
    /// Its edges along x, y and z. An edge may be 0: with a height of 0 it is a level rectangle.
    pub size_mm: [Amount<Rounding>; 3],
}

/// An upright cylinder whose middle is the place.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct WithinCylinder {
    /// Its radius.
    pub radius_mm: Amount<Length>,
    /// Its height. Unset or 0: it is a level disc.
    #[serde(default)]
    pub height_mm: Amount<Rounding>,
}

/// Anywhere on the surface of a mesh, a box or a hull that stands still, all of its area equally likely. `at_mm` is
/// then added to that place.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct WithinSurface {
    /// The name of the piece of scenery. Its corners must be certain, but not where it is.
    pub of: String,
    /// How far above the surface, along its normal.
    #[serde(default)]
    pub above_mm: Amount<Rounding>,
    /// Only where the surface looks along the scenery's own z axis, within this angle. With 89 all that neither is
    /// upright nor hangs over, with 180 everywhere.
    #[serde(default = "upwards")]
    #[schemars(extend("minimum" = 0.0, "maximum" = 180.0, "x-unit" = "degree"))]
    pub facing_deg: f64,
    /// Whether the body's own z axis points along the surface's normal, before `turn_deg`: so that a box lies on a
    /// slope.
    #[serde(default)]
    pub along: bool,
}

/// The default of `facing_deg`.
fn upwards() -> f64 {
    89.0
}

/// Coordinates in a box, a cylinder and a ball. Archimedes: equal heights of a ball's surface have equal areas.
const IN_BOX: [&str; 3] = ["at + x * (u - 0.5)", "at + y * (v - 0.5)", "at + z * (w - 0.5)"];
const IN_CYLINDER: [&str; 3] =
    ["at + radius * sqrt(u) * cos(360 * v)", "at + radius * sqrt(u) * sin(360 * v)", "at + height * (w - 0.5)"];
const IN_BALL: [&str; 3] = [
    "at + 2 * radius * pow(max(w, 1e-300), 1 / 3) * sqrt(u * (1 - u)) * cos(360 * v)",
    "at + 2 * radius * pow(max(w, 1e-300), 1 / 3) * sqrt(u * (1 - u)) * sin(360 * v)",
    "at + radius * pow(max(w, 1e-300), 1 / 3) * (2 * u - 1)",
];

impl Within {
    /// A place in this region about `at`. The variables are called `ball.within_u` and so on; a level disc has two, and
    /// an edge that is always 0 has none.
    pub(super) fn place(
        &self,
        collector: &mut Collector,
        owner: &Owner<'_>,
        at: &Values,
    ) -> Result<Values, ConfigError> {
        let (sizes, texts) = match self {
            // Such a place does not follow from arithmetic: see `surface.rs`.
            Self::Surface(_) => return Ok(*at),
            Self::Ball(ball) => {
                let radius = collector.number(owner, "within.ball.radius_mm", "within_radius", &ball.radius_mm)?;
                (vec![("radius", radius)], IN_BALL)
            }
            Self::Box(cuboid) => {
                let shorts = ["within_x", "within_y", "within_z"];
                let [x, y, z] = collector.three(owner, "within.box.size_mm", shorts, &cuboid.size_mm)?;
                (vec![("x", x), ("y", y), ("z", z)], IN_BOX)
            }
            Self::Cylinder(can) => {
                let radius = collector.number(owner, "within.cylinder.radius_mm", "within_radius", &can.radius_mm)?;
                let height = collector.number(owner, "within.cylinder.height_mm", "within_height", &can.height_mm)?;
                (vec![("radius", radius), ("height", height)], IN_CYLINDER)
            }
        };
        let is_flat = |name: &str| sizes.contains(&(name, Value::Fixed(0.0)));
        let unused = [is_flat("x"), is_flat("y"), is_flat("z") || is_flat("height")];
        let mut means = sizes.clone();
        for (name, is_unused) in ["u", "v", "w"].into_iter().zip(unused) {
            let value = if is_unused {
                Value::Fixed(0.5)
            } else {
                let law = Amount::<super::amount::Plain>::of(LawOf::Uniform([0.0, 1.0]));
                collector.number(owner, "within", &format!("within_{name}"), &law)?
            };
            means.push((name, value));
        }
        let mut place = *at;
        for (coordinate, text) in place.iter_mut().zip(texts) {
            let mut means = means.clone();
            means.push(("at", *coordinate));
            *coordinate = collector.follows(text, &means).map_err(|message| owner.wrong("within", message))?;
        }
        Ok(place)
    }
}

//! Cups.

use super::{
    Amount, ConfigError, Deserialize, Form, JsonSchema, Length, Made, Reader, Round, Said, Serialize, WorldError,
};
use glam::{DQuat, DVec3};
use plaus_dist::math;
use plaus_sim::shape::ConvexHull;
use std::f64::consts::TAU;

/// Flat pieces of a wall: the simulator allows as many corners of a face, and the base has them.
const WALLS: u32 = 12;

/// A cup, open at the upper end of its z axis. Its wall is of 12 flat pieces, whose corners are as far from the axis as
/// the radii say; their middles are nearer by 3.4 %.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Cup {
    /// Its outer radius at the rim.
    pub radius_mm: Amount<Length>,
    /// Its outer radius at the foot. Unset: that at the rim.
    #[serde(default)]
    pub foot_mm: Option<Amount<Length>>,
    /// Distance from foot to rim; `at_mm` is half way between them.
    pub height_mm: Amount<Length>,
    /// Thickness of its base, and how much less the inner radius is than the outer one.
    pub thickness_mm: Amount<Length>,
}

impl Said for Cup {
    fn read(&self, reader: &mut Reader<'_>) -> Result<Form, ConfigError> {
        let radius = reader.number("radius_mm", "radius", &self.radius_mm)?;
        let foot = self.foot_mm.as_ref().map_or(Ok(radius), |foot| reader.number("foot_mm", "foot", foot))?;
        let height = reader.number("height_mm", "height", &self.height_mm)?;
        let thickness = reader.number("thickness_mm", "thickness", &self.thickness_mm)?;
        if [radius, foot, height].iter().any(|size| reader.collector.least_gap(thickness, &[*size]) <= 0.0) {
            return Err(reader.wrong("thickness_mm", "nothing is hollow: less than its radii and its height"));
        }
        Ok(reader.form(Round::Not, move |numbers| {
            let metres = [radius, foot, height, thickness].map(|value| value.metres(numbers));
            let pieces = pieces(metres)
                .into_iter()
                .map(|points| Ok((Made::hull(ConvexHull::new(&points, 0.0)?)?, DVec3::ZERO, DQuat::IDENTITY, 1.0)));
            Made::joined(pieces.collect::<Result<Vec<_>, WorldError>>()?)
        }))
    }
}

/// The corners of each convex piece of a cup, in m: of its wall all around, and of its base.
fn pieces([radius, foot, height, thickness]: [f64; 4]) -> Vec<Vec<DVec3>> {
    let corner = |nth: u32, up: f64, inwards: f64| {
        let (sin, cos) = math::sin_cos(TAU * f64::from(nth % WALLS) / f64::from(WALLS));
        let out = foot + (radius - foot) * up / height - inwards;
        DVec3::new(out * cos, out * sin, up - 0.5 * height)
    };
    let ring = |nths: [u32; 2], up: f64, inwards: f64| nths.map(|nth| corner(nth, up, inwards));
    let wall = |nth: u32| {
        let ends = [0.0, height].into_iter().flat_map(|up| [0.0, thickness].map(|inwards| (up, inwards)));
        ends.flat_map(|(up, inwards)| ring([nth, nth + 1], up, inwards)).collect()
    };
    let base = [0.0, thickness].into_iter().flat_map(|up| (0..WALLS).map(move |nth| corner(nth, up, thickness)));
    let base = base.collect();
    (0..WALLS).map(wall).chain([base]).collect()
}

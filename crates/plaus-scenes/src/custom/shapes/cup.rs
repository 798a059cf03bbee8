//! Cups.

use super::{
    Amount, ConfigError, Deserialize, Form, JsonSchema, Length, Made, Reader, Round, Said, Serialize, WorldError,
    animation,
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
        let sizes = [("radius_mm", radius), ("foot_mm", foot), ("height_mm", height)];
        let too_small = sizes.iter().find(|(_, size)| reader.collector.least_gap(thickness, &[*size]) <= 0.0);
        if let Some((key, size)) = too_small {
            let (most, least) = (reader.collector.ends(thickness).1, reader.collector.ends(*size).0);
            let message = format!("nothing is hollow: it may be {most}, and `{key}` only {least}");
            return Err(reader.wrong("thickness_mm", message));
        }
        Ok(reader.form(Round::Not, move |numbers| {
            let [radius, foot, height, thickness] =
                [radius, foot, height, thickness].map(|value| value.metres(numbers));
            Sizes { radius, foot, height, thickness }.made()
        }))
    }
}

/// The sizes of a cup in m.
#[derive(Debug, Clone, Copy)]
struct Sizes {
    radius: f64,
    foot: f64,
    height: f64,
    thickness: f64,
}

impl Sizes {
    /// A corner so far above the foot and within the outer wall.
    fn corner(&self, nth: u32, [up, inwards]: [f64; 2]) -> DVec3 {
        let (sin, cos) = math::sin_cos(TAU * f64::from(nth % WALLS) / f64::from(WALLS));
        let out = self.foot + (self.radius - self.foot) * up / self.height - inwards;
        DVec3::new(out * cos, out * sin, up - 0.5 * self.height)
    }

    /// The corners of each convex piece: of the wall all around, and of the base, on which alone a cup stands.
    fn pieces(&self) -> Vec<Vec<DVec3>> {
        let Self { height, thickness, .. } = *self;
        let ends = [[thickness, 0.0], [thickness, thickness], [height, 0.0], [height, thickness]];
        let wall = |nth: u32| ends.iter().flat_map(|end| [nth, nth + 1].map(|nth| self.corner(nth, *end))).collect();
        let ring = |up: f64| (0..WALLS).map(move |nth| self.corner(nth, [up, 0.0]));
        (0..WALLS).map(wall).chain([ring(0.0).chain(ring(thickness)).collect()]).collect()
    }

    fn made(&self) -> Result<Made, WorldError> {
        let piece =
            |points: Vec<DVec3>| Ok((Made::hull(ConvexHull::new(&points, 0.0)?)?, DVec3::ZERO, DQuat::IDENTITY, 1.0));
        let made = Made::joined(self.pieces().into_iter().map(piece).collect::<Result<_, WorldError>>()?)?;
        let (mut vertices, triangles) = self.surface();
        vertices.iter_mut().for_each(|vertex| *vertex -= made.centre);
        Ok(Made { drawn: animation::Shape::Solid { vertices, triangles }.into(), ..made })
    }

    /// Its surface: rings of corners, from the outside of the foot over the rim to the base within, each joined to the
    /// next; both ends are closed.
    fn surface(&self) -> (Vec<DVec3>, Vec<[u32; 3]>) {
        let Self { height, thickness, .. } = *self;
        let rings = [[0.0, 0.0], [height, 0.0], [height, thickness], [thickness, thickness]];
        let vertices = rings.iter().flat_map(|end| (0..WALLS).map(|nth| self.corner(nth, *end))).collect();
        let strip = |ring: u32| {
            (0..WALLS).flat_map(move |k| {
                let [a, b] = [k, (k + 1) % WALLS].map(|k| ring * WALLS + k);
                [[a, b, b + WALLS], [a, b + WALLS, a + WALLS]]
            })
        };
        let fan = |ring: u32| (1..WALLS - 1).map(move |k| [0, k, k + 1].map(|k| ring * WALLS + k));
        let below = fan(0).map(|[a, b, c]| [a, c, b]);
        (vertices, (0..3).flat_map(strip).chain(below).chain(fan(3)).collect())
    }
}

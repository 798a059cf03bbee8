//! Tables with random bumps.

use super::{
    Amount, ConfigError, Deserialize, JsonSchema, Length, MM, Numbers, Reader, Rounding, Said, Serialize, Value, What,
    WorldError, animation,
};
use crate::animation::upright;
use crate::uneven::{Bumps, Field, LARGEST_SCORE, MOST_CUT, Site, Values, relief};
use glam::{DQuat, DVec3};
use plaus_sim::field::{Grid, Spline};
use plaus_sim::material::Material;
use plaus_sim::rigid::{self, StaticShape};

/// A table with random bumps: its height is a smooth curve (a uniform cubic b-spline) through random control points on
/// a square grid, whose origin is at `at_mm`. It is level unless `turn_deg` turns it. All points of all properties are
/// independent of each other.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Table {
    /// Standard deviation of a control point's height about that of `at_mm`. Heights beyond six of them count as six.
    pub bumps_mm: Amount<Rounding>,
    /// Distance between neighbouring control points.
    pub spacing_mm: Amount<Length>,
    /// Coulomb's coefficient of friction between the table and whatever touches it. Unset: it follows from the
    /// materials.
    #[serde(default)]
    pub friction: Option<Patchy>,
    /// Restitution between the table and whatever hits it. Unset: it follows from the materials.
    #[serde(default)]
    pub restitution: Option<Patchy>,
}

/// A coefficient that differs from place to place: a curve through random control points on the same grid as the
/// bumps.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Patchy {
    /// Mean of a control point's normal law, before the law is cut off where the coefficient can have no values.
    #[schemars(range(min = 0.0, max = 10.0))]
    pub mean: f64,
    /// Standard deviation of that law. At most a twentieth of it may be cut off.
    #[schemars(range(min = 0.0, max = 10.0))]
    pub sd: f64,
}

/// A table of a scenario.
#[derive(Debug, Clone)]
pub(in crate::custom) struct Uneven {
    bumps: Value,
    spacing: Value,
    friction: Option<Values>,
    restitution: Option<Values>,
    /// Its place among the tables of a draw.
    index: usize,
}

/// How often a body's reach may hold the distance of control points: its surface is covered with points that are so far
/// apart at most.
const MOST_POINTS: f64 = 20.0;

impl Said<What> for Table {
    fn read(&self, reader: &mut Reader<'_>) -> Result<What, ConfigError> {
        let bumps = reader.number("bumps_mm", "bumps_sd", &self.bumps_mm)?;
        let spacing = reader.number("spacing_mm", "spacing", &self.spacing_mm)?;
        let patchy = |name: &str, said: &Option<Patchy>, high: f64| {
            let Some(Patchy { mean, sd }) = *said else { return Ok(None) };
            if let Some(beyond) = Values::beyond(mean, sd, 0.0, high) {
                let range = if high.is_finite() { "from 0 to 1" } else { "at least 0" };
                let message = format!(
                    "a mean of {mean} with a standard deviation of {sd} gives values that are not {range} with \
                     probability {beyond:.3}: at most {MOST_CUT} may be cut off"
                );
                return Err(reader.wrong(name, message));
            }
            // Any end that no score reaches does.
            Ok(Some(Values::new(mean, sd, 0.0, high.min(mean + 2.0 * LARGEST_SCORE * sd))))
        };
        let friction = patchy("friction", &self.friction, f64::INFINITY)?;
        let restitution = patchy("restitution", &self.restitution, 1.0)?;
        let index = reader.collector.table(format!("{}.bumps", reader.owner.name));
        Ok(What::Table(Uneven { bumps, spacing, friction, restitution, index }))
    }
}

impl Uneven {
    /// A field of a draw's table, with its origin at a place in m along the table's axes.
    fn field(&self, field: Field, values: Values, at: DVec3, numbers: &Numbers<'_>) -> Result<Spline, WorldError> {
        let name = match field {
            Field::Height => "height",
            Field::Restitution => "restitution",
            Field::Friction => "friction",
        };
        let grid = Grid { origin: [at.x, at.y], spacing: self.spacing(numbers) };
        let bumps: &Bumps = numbers.table(self.index);
        let score = bumps.source();
        Spline::new(name, grid, values.range(), move |i, j| values.at(score(Site { field, i: i as i32, j: j as i32 })))
    }

    /// The fields that are random.
    pub(in crate::custom) fn fields(&self) -> impl Iterator<Item = Field> {
        let is_random = [true, self.restitution.is_some(), self.friction.is_some()];
        Field::ALL.into_iter().zip(is_random).filter_map(|(field, is_random)| is_random.then_some(field))
    }

    /// Distance of control points in m.
    pub(in crate::custom) fn spacing(&self, numbers: &Numbers<'_>) -> f64 {
        self.spacing.metres(numbers)
    }

    fn height(&self, at: DVec3, numbers: &Numbers<'_>) -> Result<Spline, WorldError> {
        self.field(Field::Height, Values::plain(at.z, self.bumps.metres(numbers)), at, numbers)
    }

    /// Whether its points are too close for a body that reaches so far, in m; with a distance in mm that is not.
    pub(in crate::custom) fn too_fine(&self, reach: f64, numbers: &Numbers<'_>) -> Option<f64> {
        (reach > MOST_POINTS * self.spacing(numbers)).then(|| reach / MOST_POINTS / MM)
    }

    /// The simulator's part of a draw, at a place in m; without a turn it is level.
    pub(in crate::custom) fn make(
        &self,
        (place, turn): (DVec3, Option<DQuat>),
        material: Material,
        numbers: &Numbers<'_>,
    ) -> Result<StaticShape, WorldError> {
        // A level table's fields are over the world's own axes.
        let at = if turn.is_some() { DVec3::ZERO } else { place };
        let mut table = rigid::Table::new(self.height(at, numbers)?, material);
        let field = |which, values: Option<Values>| values.map(|values| self.field(which, values, at, numbers));
        table.friction = field(Field::Friction, self.friction).transpose()?;
        table.restitution = field(Field::Restitution, self.restitution).transpose()?;
        Ok(StaticShape::Table(Box::new(match turn {
            Some(turn) => table.slanted(place, turn),
            None => table,
        })))
    }

    /// As it is drawn, so far in m around the origin.
    pub(in crate::custom) fn drawn(
        &self,
        (at, turn): (DVec3, Option<DQuat>),
        reach: f64,
        numbers: &Numbers<'_>,
    ) -> Result<animation::Form, WorldError> {
        let (ends, spacing) = ([[-reach; 2], [reach; 2]], self.spacing(numbers));
        let Some(turn) = turn else {
            let height = self.height(at, numbers)?;
            return Ok(relief(ends, spacing, |x, y| height.value(x, y)));
        };
        let height = self.height(DVec3::ZERO, numbers)?;
        let level = relief(ends, spacing, |x, y| height.value(x, y));
        let animation::Form::Heightfield { step, columns, heights, .. } = &level else { return Ok(level) };
        let (columns, rows) = (*columns, heights.len() as u32 / columns);
        let corner = |(k, height): (u32, &f64)| {
            let [right, near] = [f64::from(k % columns) * step[0], f64::from(k / columns) * step[1]];
            upright(at + turn * DVec3::new(right - reach, reach - near, *height))
        };
        let cells = (0..(rows - 1) * columns).filter(|k| (k + 1) % columns != 0);
        let halves = cells.flat_map(|k| [[k, k + columns, k + columns + 1], [k, k + columns + 1, k + 1]]);
        Ok(animation::Form::Mesh { vertices: (0..).zip(heights).map(corner).collect(), triangles: halves.collect() })
    }
}

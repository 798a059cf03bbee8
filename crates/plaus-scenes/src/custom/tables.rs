//! Tables with random bumps.

use super::forms::{Patchy, Table};
use super::solids::MM;
use super::values::{Collector, Numbers, Owner, Value};
use crate::animation::{self, upright};
use crate::scene::ConfigError;
use crate::uneven::{Bumps, Field, LARGEST_SCORE, MOST_CUT, Site, Values, relief};
use glam::{DQuat, DVec3};
use plaus_sim::WorldError;
use plaus_sim::field::{Grid, Spline};
use plaus_sim::material::Material;
use plaus_sim::rigid::{StaticShape, Table as Simulated};

/// A table of a scenario.
#[derive(Debug, Clone)]
pub(super) struct Uneven {
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

impl Uneven {
    pub(super) fn new(collector: &mut Collector, owner: &Owner<'_>, table: &Table) -> Result<Self, ConfigError> {
        let patchy = |name: &str, said: &Option<Patchy>, high: f64| {
            let Some(Patchy { mean, sd }) = *said else { return Ok(None) };
            if let Some(beyond) = Values::beyond(mean, sd, 0.0, high) {
                let range = if high.is_finite() { "from 0 to 1" } else { "at least 0" };
                let message = format!(
                    "a mean of {mean} with a standard deviation of {sd} gives values that are not {range} with \
                     probability {beyond:.3}: at most {MOST_CUT} may be cut off"
                );
                return Err(owner.wrong(&format!("shape.table.{name}"), message));
            }
            // Any end that no score reaches does.
            Ok(Some(Values::new(mean, sd, 0.0, high.min(mean + 2.0 * LARGEST_SCORE * sd))))
        };
        Ok(Self {
            bumps: collector.number(owner, "shape.table.bumps_mm", "bumps_sd", &table.bumps_mm)?,
            spacing: collector.number(owner, "shape.table.spacing_mm", "spacing", &table.spacing_mm)?,
            friction: patchy("friction", &table.friction, f64::INFINITY)?,
            restitution: patchy("restitution", &table.restitution, 1.0)?,
            index: collector.table(format!("{}.bumps", owner.name)),
        })
    }

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
    pub(super) fn fields(&self) -> impl Iterator<Item = Field> {
        let is_random = [true, self.restitution.is_some(), self.friction.is_some()];
        Field::ALL.into_iter().zip(is_random).filter_map(|(field, is_random)| is_random.then_some(field))
    }

    /// Distance of control points in m.
    pub(super) fn spacing(&self, numbers: &Numbers<'_>) -> f64 {
        self.spacing.of(numbers) * MM
    }

    fn height(&self, at: DVec3, numbers: &Numbers<'_>) -> Result<Spline, WorldError> {
        self.field(Field::Height, Values::plain(at.z, self.bumps.of(numbers) * MM), at, numbers)
    }

    /// Whether its points are too close for a body that reaches so far, in m; with a distance in mm that is not.
    pub(super) fn too_fine(&self, reach: f64, numbers: &Numbers<'_>) -> Option<f64> {
        (reach > MOST_POINTS * self.spacing(numbers)).then(|| reach / MOST_POINTS / MM)
    }

    /// The simulator's part of a draw, at a place in m; without a turn it is level.
    pub(super) fn make(
        &self,
        (place, turn): (DVec3, Option<DQuat>),
        material: Material,
        numbers: &Numbers<'_>,
    ) -> Result<StaticShape, WorldError> {
        // A level table's fields are over the world's own axes.
        let at = if turn.is_some() { DVec3::ZERO } else { place };
        let mut table = Simulated::new(self.height(at, numbers)?, material);
        let field = |which, values: Option<Values>| values.map(|values| self.field(which, values, at, numbers));
        table.friction = field(Field::Friction, self.friction).transpose()?;
        table.restitution = field(Field::Restitution, self.restitution).transpose()?;
        Ok(StaticShape::Table(Box::new(match turn {
            Some(turn) => table.slanted(place, turn),
            None => table,
        })))
    }

    /// As it is drawn, so far in m around the origin.
    pub(super) fn drawn(
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

//! The table as the simulator sees it: what the scores of its control points mean, and the world that follows.

use super::config::{Config, Spilt, Table};
use super::draw::{Field, LARGEST_SCORE, Realisation, Site};
use crate::scene::ConfigError;
use crate::uneven::{MOST_CUT, Values};
use glam::DVec3;
use plaus_dist::math;
use plaus_sim::field::{Grid, Points, Spline};
use plaus_sim::rigid::{StaticShape, Table as Uneven};
use plaus_sim::scenery::Plane;
use plaus_sim::{Law, Laws, Material, WorldError};

/// Dice and table are made of one material.
pub(super) const MATERIAL: Material = Material(0);

/// A field with another mean in the spill.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Patched {
    dry: Values,
    wet: Values,
}

/// The laws of all control points.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Surface {
    grid: Grid,
    height: Values,
    restitution: Patched,
    friction: Patched,
    spilt: Option<Spilt>,
    /// The fields that are random.
    pub(super) random: Vec<Field>,
}

impl Surface {
    /// The laws of a configuration.
    ///
    /// # Errors
    ///
    /// [`ConfigError`] if too much of a law would be cut off.
    pub(super) fn new(config: &Config) -> Result<Self, ConfigError> {
        let (Table { grid_mm, bumps_mm, bounce, bounce_sd, grip, grip_sd, .. }, spilt) = (config.table, config.spilt);
        let is_spilt = spilt.radius_mm > 0.0;
        let wet = |value: f64, dry: f64| if is_spilt { value } else { dry };
        for (table, name, mean, sd, high, range) in [
            ("table", "bounce", bounce, bounce_sd, 1.0, "[0, 1]"),
            ("spilt", "bounce", wet(spilt.bounce, bounce), bounce_sd, 1.0, "[0, 1]"),
            ("table", "grip", grip, grip_sd, f64::INFINITY, "[0, ∞)"),
            ("spilt", "grip", wet(spilt.grip, grip), grip_sd, f64::INFINITY, "[0, ∞)"),
        ] {
            if let Some(beyond) = Values::beyond(mean, sd, 0.0, high) {
                let message = format!(
                    "a mean {name} of {mean} with a spread of {sd} leaves {range} with probability {beyond:.3}; at most {MOST_CUT} of the law may be cut off: use a smaller {name}_sd, or a mean farther inside"
                );
                return Err(ConfigError::new(format!("world.dice.{table}.{name}"), message));
            }
        }
        let patched = |dry: f64, wet: f64, sd: f64, high: f64| {
            // Within any range that a score can reach.
            let high = high.min(dry.max(wet) + 2.0 * LARGEST_SCORE * sd);
            Patched { dry: Values::new(dry, sd, 0.0, high), wet: Values::new(wet, sd, 0.0, high) }
        };
        let height = bumps_mm * 1e-3;
        let mut random = Vec::new();
        for (field, sd) in Field::ALL.into_iter().zip([bumps_mm, bounce_sd, grip_sd]) {
            random.extend((sd > 0.0).then_some(field));
        }
        Ok(Self {
            grid: Grid { origin: [0.0; 2], spacing: grid_mm * 1e-3 },
            height: Values::plain(0.0, height),
            restitution: patched(bounce, wet(spilt.bounce, bounce), bounce_sd, 1.0),
            friction: patched(grip, wet(spilt.grip, grip), grip_sd, f64::INFINITY),
            spilt: is_spilt.then_some(spilt),
            random,
        })
    }

    /// Distance of control points, in m.
    pub(super) fn spacing(&self) -> f64 {
        self.grid.spacing
    }

    /// The highest that the table can be anywhere, in m.
    pub(super) fn highest(&self) -> f64 {
        self.height.range()[1]
    }

    /// Whether what was spilt makes the laws depend on the place.
    pub(super) fn is_patched(&self) -> bool {
        self.spilt.is_some()
    }

    /// Whether the table is plain and the same throughout.
    pub(super) fn is_plain(&self) -> bool {
        self.random.is_empty() && self.spilt.is_none()
    }

    fn is_wet(&self, shifted: [i32; 2], site: Site) -> bool {
        self.spilt.is_some_and(|spilt| {
            let there = [site.i.wrapping_add(shifted[0]), site.j.wrapping_add(shifted[1])];
            let [x, y] = there.map(|k| f64::from(k) * self.grid.spacing);
            let (x, y) = (x - spilt.x_mm * 1e-3, y - spilt.y_mm * 1e-3);
            x * x + y * y <= math::square(spilt.radius_mm * 1e-3)
        })
    }

    /// The value of a control point of a table shifted by `shifted` cells: metres for heights, otherwise a pure number.
    pub(super) fn value(&self, shifted: [i32; 2], site: Site, score: f64) -> f64 {
        let patched = match site.field {
            Field::Height => return self.height.at(score),
            Field::Restitution => &self.restitution,
            Field::Friction => &self.friction,
        };
        if self.is_wet(shifted, site) { patched.wet.at(score) } else { patched.dry.at(score) }
    }

    /// The sites on which any field at a point depends.
    pub(super) fn support(&self, x: f64, y: f64) -> impl Iterator<Item = [i32; 2]> {
        let [i, j] = [x, y].map(|at| (at / self.grid.spacing).floor() as i32);
        (0..16).map(move |k| [i - 1 + k / 4, j - 1 + k % 4])
    }

    /// A field of a table.
    pub(super) fn spline(&self, field: Field, table: &Realisation) -> Result<Spline, WorldError> {
        let (name, range) = match field {
            Field::Height => ("height", self.height.range()),
            Field::Restitution => ("restitution", [0.0, 1.0]),
            Field::Friction => ("friction", [0.0, self.friction.dry.range()[1]]),
        };
        let (laws, source, shifted) = (self.clone(), table.source(), table.shifted);
        Spline::new(name, self.grid, range, move |i, j| {
            let site = Site { field, i: i as i32, j: j as i32 };
            laws.value(shifted, site, source(site))
        })
    }

    /// A table without bumps, of mean restitution and friction throughout.
    pub(super) fn plain(&self) -> Result<StaticShape, WorldError> {
        Ok(StaticShape::Plane(Plane::new(DVec3::ZERO, DVec3::Z, MATERIAL)?))
    }

    /// The table as a part of a world. Properties that are not random are not fields.
    pub(super) fn part(&self, table: &Realisation) -> Result<StaticShape, WorldError> {
        let is_field = |field| self.random.contains(&field) || (field != Field::Height && self.spilt.is_some());
        if !Field::ALL.into_iter().any(is_field) {
            return self.plain();
        }
        let mut uneven = Uneven::new(self.spline(Field::Height, table)?, MATERIAL);
        if is_field(Field::Restitution) {
            uneven.restitution = Some(self.spline(Field::Restitution, table)?);
        }
        if is_field(Field::Friction) {
            uneven.friction = Some(self.spline(Field::Friction, table)?);
        }
        Ok(StaticShape::Table(Box::new(uneven)))
    }

    /// The laws where the table has no fields, and between dice.
    pub(super) fn laws(&self) -> Result<Laws, WorldError> {
        Laws::uniform(Law::new(self.friction.dry.mean, self.restitution.dry.mean))
    }
}

/// The fields of a part.
fn splines(part: &mut StaticShape) -> impl Iterator<Item = (Field, &mut Spline)> {
    let table = match part {
        StaticShape::Table(table) => Some(table),
        _ => None,
    };
    table.into_iter().flat_map(|table| {
        let rest = table.friction.iter_mut().map(|spline| (Field::Friction, spline));
        let bounce = table.restitution.iter_mut().map(|spline| (Field::Restitution, spline));
        std::iter::once((Field::Height, &mut table.height)).chain(bounce).chain(rest)
    })
}

/// Memory used by the parts' fields so far, in bytes.
pub(super) fn bytes(parts: &mut [StaticShape]) -> usize {
    parts.iter_mut().flat_map(splines).map(|(_, spline)| spline.bytes()).sum()
}

/// The control points of a table that were looked at.
#[derive(Debug, Default)]
pub(super) struct Touched(Vec<(Field, Points)>);

impl Touched {
    /// Those of a world's parts; the parts forget them.
    pub(super) fn take(parts: &mut [StaticShape]) -> Self {
        Self(parts.iter_mut().flat_map(splines).map(|(field, spline)| (field, spline.take_touched())).collect())
    }

    /// Whether a point is among them.
    pub(super) fn has(&self, site: Site) -> bool {
        let here = [i64::from(site.i), i64::from(site.j)];
        self.0.iter().any(|(field, points)| *field == site.field && points.has(here))
    }

    /// The points of each field, in order.
    pub(super) fn sites(&self) -> impl Iterator<Item = Site> {
        let of = |(field, points): &(Field, Points)| {
            let site = |[i, j]: [i64; 2]| Site { field: *field, i: i as i32, j: j as i32 };
            points.in_order().into_iter().map(site).collect::<Vec<_>>()
        };
        self.0.iter().flat_map(of)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_spill_has_means_of_its_own() {
        let mut config = Config::default();
        (config.spilt.radius_mm, config.spilt.x_mm) = (20.0, 80.0);
        let surface = Surface::new(&config).unwrap();
        let at = |i| surface.value([0; 2], Site { field: Field::Friction, i, j: 0 }, 0.0);
        // Medians; the cut at 0 moves that of the wet part by 8e-5.
        for (i, median) in [(0, 0.35), (7, 0.35), (8, 0.15), (10, 0.15), (12, 0.15), (13, 0.35)] {
            assert!((at(i) - median).abs() < 1e-4, "{i}: {}", at(i));
        }
        // After a shift of the table, other points lie there.
        assert_eq!(surface.value([8, 0], Site { field: Field::Friction, i: 0, j: 0 }, 0.0), at(8));
    }
}

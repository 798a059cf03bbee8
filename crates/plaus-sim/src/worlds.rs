//! A simple world, for first steps, tests, benchmarks and the trade-off study: a die on a table, flat or bumpy.

use crate::accuracy::Accuracy;
use crate::error::WorldError;
use crate::field::{Grid, Spline};
use crate::material::{Law, Laws, Material};
use crate::rigid::{BodySpec, RigidWorld, RigidWorldDesc, Start, StaticShape, Table};
use crate::scenery::Plane;
use crate::shape::{Cuboid, Shape};
use glam::{DQuat, DVec3};

/// A cuboid thrown onto a table.
#[derive(Debug, Clone, Copy)]
pub struct DieOnTable {
    /// Edges of the die in m.
    pub edges: DVec3,
    /// Radius of its edges in m.
    pub rounding: f64,
    /// In kg/m³.
    pub density: f64,
    /// Between die and table.
    pub law: Law,
    /// Spread of the table's control heights over the grid's spacing; 0 is a flat table.
    pub bumps: f64,
    /// Distance of control points over the die's first edge.
    pub spacing: f64,
    /// Tolerances.
    pub accuracy: Accuracy,
}

impl Default for DieOnTable {
    /// A 16 mm die of celluloid on wood.
    fn default() -> Self {
        Self {
            edges: DVec3::splat(0.016),
            rounding: 0.0,
            density: 1200.0,
            law: Law::new(0.35, 0.5),
            bumps: 0.0,
            spacing: 0.5,
            accuracy: Accuracy::default(),
        }
    }
}

impl DieOnTable {
    /// The world. `gaussian(i, j)` gives each control height in units of the spread, within ±8.
    ///
    /// # Errors
    /// [`WorldError`] for impossible numbers.
    pub fn world(&self, gaussian: impl Fn(i64, i64) -> f64 + Send + Sync + 'static) -> Result<RigidWorld, WorldError> {
        self.world_of(1, gaussian)
    }

    /// The same with several identical dice.
    ///
    /// # Errors
    /// [`WorldError`] for impossible numbers.
    pub fn world_of(
        &self,
        dice: usize,
        gaussian: impl Fn(i64, i64) -> f64 + Send + Sync + 'static,
    ) -> Result<RigidWorld, WorldError> {
        let material = Material(0);
        let part = if self.bumps == 0.0 {
            StaticShape::Plane(Plane::new(DVec3::ZERO, DVec3::Z, material)?)
        } else {
            let spacing = self.spacing * self.edges.x;
            let spread = self.bumps * spacing;
            let grid = Grid { origin: [0.0, 0.0], spacing };
            let height =
                Spline::new("height", grid, [-8.0 * spread, 8.0 * spread], move |i, j| spread * gaussian(i, j))?;
            StaticShape::Table(Box::new(Table::new(height, material)))
        };
        let shape = Shape::Cuboid(Cuboid::new(self.edges, self.rounding)?);
        RigidWorld::new(RigidWorldDesc {
            bodies: vec![BodySpec::solid(shape, self.density, material); dice],
            parts: vec![part],
            laws: Laws::uniform(self.law)?,
            gravity: DVec3::new(0.0, 0.0, -9.81),
            accuracy: self.accuracy,
            skin: 1.0,
            sink: f64::NEG_INFINITY,
            duration: 20.0,
        })
    }

    /// A random throw from a hand's height: `uniform` gives numbers in [0, 1). Height 8–12 cm, 0.5–1.5 m/s along x, up
    /// to 30 rad/s about each axis, any orientation.
    pub fn throw(&self, mut uniform: impl FnMut() -> f64) -> Start {
        let mut between = |low: f64, high: f64| low + (high - low) * uniform();
        let position = DVec3::new(0.0, 0.0, between(0.08, 0.12));
        let velocity = DVec3::new(between(0.5, 1.5), between(-0.2, 0.2), between(-0.5, 0.0));
        let spin = DVec3::new(between(-30.0, 30.0), between(-30.0, 30.0), between(-30.0, 30.0));
        // Uniform orientations by rejection from the ball of quaternions.
        let orientation = loop {
            let q = DQuat::from_xyzw(between(-1.0, 1.0), between(-1.0, 1.0), between(-1.0, 1.0), between(-1.0, 1.0));
            if (0.01..=1.0).contains(&q.length_squared()) {
                break q.normalize();
            }
        };
        Start { position, orientation, velocity, spin, time: 0.0 }
    }

    /// Several dice thrown together: as in [`throw`](Self::throw), but side by side in two rows, each towards the
    /// middle of all dice at up to 1 m/s, so that they meet in the air.
    pub fn throw_together(&self, dice: usize, mut uniform: impl FnMut() -> f64) -> Vec<Start> {
        // Two of them cannot touch, in any orientation.
        let apart = 1.05 * self.edges.length();
        let middle = 0.25 * (dice.saturating_sub(1)) as f64;
        (0..dice)
            .map(|k| {
                let start = self.throw(&mut uniform);
                let place = DVec3::new((k % 2) as f64 - 0.5, (k / 2) as f64 - middle, 0.0) * apart;
                let inwards = -place.normalize_or_zero() * uniform();
                let height = DVec3::new(0.0, 0.0, 6.0 * self.edges.z);
                Start { position: place + height, velocity: start.velocity + inwards, ..start }
            })
            .collect()
    }
}

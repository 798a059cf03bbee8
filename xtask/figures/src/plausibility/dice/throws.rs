//! Throws from the scene's prior onto a flat table, and the faces that come up.

use super::published::Rolled;
use crate::Result;
use crate::plausibility::chance::Count;
use plaus_dist::{Purpose, Seed};
use plaus_mcmc::{ModelError, State, Target};
use plaus_scenes::dice::{Config, Dice, End, Rotation, Work};
use rayon::prelude::*;

/// Properties of a throw that are not published.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Conditions {
    /// Restitution of the table.
    pub(super) bounce: f64,
    /// Coefficient of friction.
    pub(super) grip: f64,
    /// Mean height of release in mm.
    pub(super) height_mm: f64,
    /// Mean speed along the table in m/s.
    pub(super) speed: f64,
    /// Standard deviation of each component of the angular velocity in rad/s.
    pub(super) spin: f64,
    /// Radius of the edges in mm, for cuboids with y = 16 mm.
    pub(super) rounding_mm: f64,
}

impl Default for Conditions {
    /// The scene's conditions, and sharp edges.
    fn default() -> Self {
        let Config { throw, table, .. } = Config::default();
        Self {
            bounce: table.bounce,
            grip: table.grip,
            height_mm: throw.z_mm,
            speed: throw.vx,
            spin: throw.spin_sd,
            rounding_mm: 0.0,
        }
    }
}

impl Conditions {
    /// The scene with one cuboid x × y × y, where y is the edge of the scene's die, on a flat table that it can't
    /// leave.
    fn scene(self, ratio: f64) -> Result<Dice> {
        let mut config = Config { constraints: Vec::new(), ..Config::default() };
        config.die.edge_x_mm = ratio * config.die.edge_y_mm;
        config.die.rounding_mm = self.rounding_mm;
        (config.table.length_mm, config.table.width_mm) = (1e5, 1e5);
        (config.table.bumps_mm, config.table.bounce_sd, config.table.grip_sd) = (0.0, 0.0, 0.0);
        (config.table.bounce, config.table.grip) = (self.bounce, self.grip);
        (config.throw.z_mm, config.throw.vx, config.throw.spin_sd) = (self.height_mm, self.speed, self.spin);
        Ok(Dice::new(&config)?)
    }

    /// How often each face of such a cuboid was uppermost at rest; the first number is how often it did not come to
    /// rest.
    pub(super) fn faces(self, ratio: f64, throws: u64, seed: u64) -> Result<[u64; 7]> {
        let scene = self.scene(ratio)?;
        let one = |work: &mut Work, k: u64| -> std::result::Result<u8, ModelError> {
            let draw = scene.start(&mut Seed(seed).chain(0).at(k, Purpose::START));
            let trip = &State::evaluate(&scene, draw, work)?.outcome.trips[0];
            // The body's own faces, because the scene turns the pips of a cuboid at random, which would make any cuboid
            // fair.
            Ok(if trip.end == End::AtRest { Rotation::IDENTITY.uppermost(trip.orientation).0 } else { 0 })
        };
        let faces: Vec<u8> =
            (0..throws).into_par_iter().map_init(Work::default, one).collect::<std::result::Result<_, _>>()?;
        let mut counts = [0; 7];
        faces.into_iter().for_each(|face| counts[usize::from(face)] += 1);
        Ok(counts)
    }

    /// How often a square face was uppermost, among the throws that came to rest.
    pub(super) fn square(self, ratio: f64, throws: u64, seed: u64) -> Result<Count> {
        let counts = self.faces(ratio, throws, seed)?;
        // Faces 3 and 4 lie along the first axis.
        Ok(Count::new(counts[3] + counts[4], counts[1..].iter().sum()))
    }

    /// The same for every cuboid that was rolled.
    pub(super) fn squares(self, rolled: &[Rolled], throws: u64, seed: u64) -> Result<Vec<Count>> {
        rolled
            .iter()
            .map(|rolled| self.square(rolled.ratio, throws, seed + (100.0 * rolled.ratio).round() as u64))
            .collect()
    }
}

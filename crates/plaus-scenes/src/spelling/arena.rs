//! The box in the simulator's terms, in metres, and errors of configurations that make no box.

use super::bins::Bins;
use super::config::{Config, Order, Vertices};
use super::draw::Drops;
use super::word::Word;
use crate::scene::ConfigError;
use crate::world::{Physical, PlainWorld};
use glam::DVec3;
use plaus_dist::math;
use plaus_sim::marbles::{Marble, MarbleSpec, MarbleWorld, Marbles, Phase, Start};
use plaus_sim::scenery::Scenery;
use plaus_sim::{Accuracy, Law, Laws, Material, WorldError};

/// Offsets whose length exceeds this many standard deviations of a coordinate have density 0; without the cut, the
/// probability of that is 8e-14.
const LONGEST: f64 = 8.0;

/// Largest length of an offset, as a share of the partitions' thickness: less than half, so that no vertex leaves its
/// partition.
const SHARE: f64 = 0.45;

/// Metres in a millimetre.
pub(super) const MM: f64 = 1e-3;

/// Everything that is the same for all draws.
#[derive(Debug)]
pub(super) struct Arena {
    pub(super) bins: Bins,
    /// Made once: its broad phase costs more than a few thousand drops.
    scenery: Scenery,
    pub(super) laws: Laws,
    /// The random vertices of the simulator's mesh, and their places without an offset.
    pub(super) vertices: Vec<(u32, DVec3)>,
    interval: f64,
    order: Order,
    accuracy: Accuracy,
    /// When the simulation ends, in s.
    pub(super) duration: f64,
    /// Whether balls touch each other.
    pub(super) touch: bool,
}

impl Arena {
    pub(super) fn new(config: &Config, word: &Word, balls: usize) -> Result<Self, ConfigError> {
        check(config)?;
        let size = &config.dimensions;
        let bins = Bins {
            columns: word.columns(),
            rows: word.rows(),
            side: size.bin_mm * MM,
            thickness: size.partition_mm * MM,
            height: size.partition_height_mm * MM,
            crown: 0.0,
            depth: size.depth_mm * MM,
            bowl: size.floor_radius_mm * MM,
            drop: config.drop_height_mm * MM,
            marble: config.ball_radius_mm * MM,
            density: config.density,
            // Slightly more, so that rounding does not make the longest offset too long.
            margin: longest_offset(config) * MM * (1.0 + 1e-9),
            ..Bins::default()
        };
        let (nx, ny) = (word.columns(), word.rows());
        let inner = |k: usize| (1..nx).contains(&(k % (nx + 1))) && (1..ny).contains(&(k / (nx + 1)));
        let is_random = |k: &usize| config.vertices == Vertices::Crossings || inner(*k);
        let vertices = (0..bins.crossings()).filter(is_random).map(|k| (k as u32, bins.crossing(k))).collect();
        let fail = |error: WorldError| ConfigError::new("world.spelling.box", error);
        let arena = Self {
            scenery: bins.scenery().map_err(fail)?,
            laws: laws(config).map_err(fail)?,
            bins,
            vertices,
            interval: config.drop_interval_s,
            order: config.order,
            accuracy: config.accuracy.tolerances(),
            duration: config.drop_interval_s * balls as f64 + config.settle_s,
            touch: config.balls_touch,
        };
        arena.world(1).map_err(|error| ConfigError::new("world.spelling", error))?;
        Ok(arena)
    }

    /// Any ball.
    pub(super) fn ball(&self) -> MarbleSpec {
        let volume = 4.0 / 3.0 * std::f64::consts::PI * math::powi(self.bins.marble, 3);
        MarbleSpec::solid(self.bins.marble, volume * self.bins.density, BALL)
    }

    /// A world of `count` balls with all vertices in their regular places.
    pub(super) fn world(&self, count: usize) -> Result<Marbles, WorldError> {
        Marbles::new(MarbleWorld {
            specs: vec![self.ball(); count],
            laws: self.laws.clone(),
            scenery: self.scenery.clone(),
            gravity: DVec3::new(0.0, 0.0, -GRAVITY),
            accuracy: self.accuracy,
            duration: self.duration,
        })
    }

    /// The same, with a place for each ball: above the middle of a bin of its own.
    pub(super) fn plain_world(&self, balls: usize) -> Result<PlainWorld, WorldError> {
        let Bins { side, drop, .. } = self.bins;
        let over = |bin: usize| {
            let (column, row) = (bin % self.bins.columns, bin / self.bins.columns);
            DVec3::new((column as f64 + 0.5) * side, (row as f64 + 0.5) * side, drop)
        };
        Ok(PlainWorld {
            world: Physical::Marbles(Box::new(self.world(balls)?)),
            places: (0..balls).map(over).collect(),
        })
    }

    /// Where the random vertex `index` is, given an offset in mm.
    pub(super) fn moved(&self, index: usize, offset: &[f64; 3]) -> (u32, DVec3) {
        let (vertex, home) = self.vertices[index];
        (vertex, home + DVec3::from_array(*offset) * MM)
    }

    /// How each ball starts; `None` for one that is not dropped.
    pub(super) fn starts(&self, draw: &Drops) -> impl Iterator<Item = Option<Start>> {
        let mut turn = 0;
        draw.balls.iter().map(move |ball| {
            let slot = turn;
            turn += usize::from(self.order == Order::Slots || ball.is_some());
            ball.map(|[x, y]| Start {
                time: self.interval * slot as f64,
                ..Start::at_rest(DVec3::new(x * MM, y * MM, self.bins.drop))
            })
        })
    }

    /// The bin in which a ball lies once everything is at rest.
    pub(super) fn bin_of(&self, ball: &Marble) -> Option<u16> {
        self.bins.holds(ball.path.x).filter(|_| ball.phase == Phase::Rest)
    }
}

/// The simulator's materials.
const BALL: Material = Material(0);
pub(super) const BOX: Material = Material(1);
pub(super) const MATERIALS: u16 = 2;

fn laws(config: &Config) -> Result<Laws, WorldError> {
    let contact = &config.contact;
    let mut laws = Laws::new(MATERIALS, Law::new(contact.ball_friction, contact.ball_restitution))?;
    // The same resistance, half as strong, stops spinning about the normal: a ball that only spins looks as if at rest.
    let on_box = Law::new(contact.box_friction, contact.box_restitution);
    laws.set(BALL, BOX, on_box.with_resistance(contact.rolling_resistance, 0.5 * contact.rolling_resistance))?;
    Ok(laws)
}

/// The longest offset a vertex can have, in mm.
pub(super) fn longest_offset(config: &Config) -> f64 {
    (LONGEST * config.sigma_mm).min(SHARE * config.dimensions.partition_mm)
}

/// The largest number of balls.
pub(super) fn balls(config: &Config, word: &Word) -> Result<usize, ConfigError> {
    let (bins, needed) = (word.columns() * word.rows(), word.designated().len());
    let fail = |message: String| Err(ConfigError::new("world.spelling.balls", message));
    match config.balls as usize {
        0 => Ok(needed),
        given if given > bins => fail(format!("{given} balls are more than the {bins} bins of the box")),
        given if given < needed => fail(format!("{given} balls cannot fill {needed} bins")),
        given => Ok(given),
    }
}

/// Lower and upper ends of the drop rectangle along x and y, in mm.
pub(super) fn rectangle(config: &Config, word: &Word) -> Result<[[f64; 2]; 2], ConfigError> {
    let size = &config.dimensions;
    // Inside of the box; a ball's centre keeps its radius from the walls.
    let edge = 0.5 * size.partition_mm + config.ball_radius_mm + config.drop_inset_mm;
    let sides = [word.columns(), word.rows()].map(|bins| [edge, bins as f64 * size.bin_mm - edge]);
    let short = sides.iter().map(|[low, high]| high - low).fold(f64::INFINITY, f64::min);
    if short > 0.0 {
        return Ok(sides);
    }
    let most = config.drop_inset_mm + 0.5 * short;
    let message = format!("the drop rectangle is empty: the inset must be less than {most:.3} mm in this box");
    Err(ConfigError::new("world.spelling.drop_inset_mm", message))
}

/// Checks conditions between keys that are each in range.
fn check(config: &Config) -> Result<(), ConfigError> {
    let (size, radius) = (&config.dimensions, config.ball_radius_mm);
    let fail = |key: &str, message: String| Err(ConfigError::new(format!("world.spelling.{key}"), message));
    if config.sigma_mm > 0.25 * size.partition_mm {
        let most = 0.25 * size.partition_mm;
        return fail(
            "sigma_mm",
            format!("{} mm is more than a quarter of the partitions' thickness, {most} mm", config.sigma_mm),
        );
    }
    let room = size.bin_mm - size.partition_mm - 2.0 * longest_offset(config);
    if 2.0 * radius > room {
        let message =
            format!("a ball of radius {radius} mm does not fit a bin: it must be at most {:.3} mm", 0.5 * room);
        return fail("ball_radius_mm", message);
    }
    // In its bin, a ball must lie lower than on the partitions.
    let half = 0.5 * size.bin_mm;
    if size.floor_radius_mm <= radius.max(half * std::f64::consts::SQRT_2) {
        let least = radius.max(half * std::f64::consts::SQRT_2);
        let message = format!(
            "a bowl of {} mm does not span a whole bin: it must be more than {least:.3} mm",
            size.floor_radius_mm
        );
        return fail("box.floor_radius_mm", message);
    }
    let rim = size.floor_radius_mm - (size.floor_radius_mm * size.floor_radius_mm - 2.0 * half * half).sqrt();
    if rim > 0.5 * size.partition_height_mm {
        let message = format!(
            "the bowl rises {rim:.3} mm to the corners of its bin: it must be flatter, or the partitions higher than {:.3} mm",
            2.0 * rim
        );
        return fail("box.floor_radius_mm", message);
    }
    let least = size.partition_height_mm + radius + longest_offset(config);
    if config.drop_height_mm <= least {
        let message =
            format!("{} mm is not above the partitions: it must be more than {least:.3} mm", config.drop_height_mm);
        return fail("drop_height_mm", message);
    }
    if config.balls_touch {
        // Time to fall by a diameter, 2r = g t²/2: the next ball then finds its place free.
        let least = (4.0 * radius * MM / GRAVITY).sqrt();
        if config.drop_interval_s < least {
            let message = format!(
                "{} s is too short: a ball needs {least:.4} s to fall by its own diameter",
                config.drop_interval_s
            );
            return fail("drop_interval_s", message);
        }
    }
    Ok(())
}

/// The simulator's gravity, m/s².
pub(super) const GRAVITY: f64 = 9.81;

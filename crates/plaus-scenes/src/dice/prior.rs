//! The law of a throw without the constraints.

use super::config::Config;
use super::draw::{Draw, NUMBERS, Realisation, Throw, number};
use crate::turns::any_orientation;
use glam::DVec3;
use plaus_dist::stream::below;
use plaus_dist::{Density, Gaussian, LogDensity, NotANumber, ParamError, Sample, Stream, TruncatedGaussian};
use plaus_mcmc::{Law, Var, Vars};

/// Names and units of the numbers' columns, and the factors from SI units.
const COLUMNS: [(&str, &str, f64); NUMBERS] = [
    ("x", "mm", 1e3),
    ("y", "mm", 1e3),
    ("z", "mm", 1e3),
    ("vx", "m/s", 1.0),
    ("vy", "m/s", 1.0),
    ("vz", "m/s", 1.0),
    ("wx", "rad/s", 1.0),
    ("wy", "rad/s", 1.0),
    ("wz", "rad/s", 1.0),
];

/// The prior of a draw. Its density is taken with respect to the law of the tables themselves, so every table counts 1.
/// A control point that no die touches drops out by itself, and the ratio of a move that changes a point is also taken
/// with respect to the point's law.
#[derive(Debug, Clone)]
pub struct Prior {
    /// For each die: place, velocity, angular velocity.
    numbers: Vec<[Gaussian; NUMBERS]>,
    /// The height of release; its law is cut off where a die would reach into the table.
    height: TruncatedGaussian,
    turns: usize,
    tables: usize,
    /// Dice thrown onto one table begin at least this far apart, in m; otherwise the draw has density 0.
    clear: f64,
    /// Distance of control points, in m.
    spacing: f64,
}

impl Prior {
    pub(super) fn new(config: &Config, lowest: f64, turns: usize, clear: f64) -> Result<Self, ParamError> {
        let throw = &config.throw;
        let (place, mm) = (throw.place_sd_mm * 1e-3, 1e-3);
        let height = Gaussian::new(throw.z_mm * mm, throw.height_sd_mm * mm)?;
        let spin = Gaussian::new(0.0, throw.spin_sd)?;
        let speed = |mean| Gaussian::new(mean, throw.velocity_sd);
        let die = |k: u32| {
            let y = throw.y_mm + throw.apart_mm * (f64::from(k) - 0.5 * f64::from(config.dice - 1));
            Ok([
                Gaussian::new(throw.x_mm * mm, place)?,
                Gaussian::new(y * mm, place)?,
                height,
                speed(throw.vx)?,
                speed(throw.vy)?,
                speed(throw.vz)?,
                spin,
                spin,
                spin,
            ])
        };
        Ok(Self {
            numbers: (0..config.dice).map(die).collect::<Result<_, ParamError>>()?,
            height: TruncatedGaussian::new(height.mean(), height.sd(), lowest, f64::INFINITY)?,
            turns,
            tables: if config.together { 1 } else { config.dice as usize },
            clear: if config.together { clear } else { 0.0 },
            spacing: config.table.grid_mm * 1e-3,
        })
    }

    /// The variables: each die's numbers, its orientation and the turn of its pips; then the tables, each of which
    /// belongs to its die if dice are thrown alone.
    pub(super) fn vars(&self) -> Vars {
        let mut all = Vec::new();
        for (die, laws) in self.numbers.iter().enumerate() {
            let number = die as u32 + 1;
            for (k, (name, unit, factor)) in COLUMNS.into_iter().enumerate() {
                let law = if k == 2 { Law::Truncated(self.height) } else { Law::Gaussian(laws[k]) };
                all.push(Var::new(name, unit, law).of("die", number).column(factor));
            }
            all.extend(["orientation", "turn"].map(|name| Var::new(name, "", Law::Own).of("die", number)));
        }
        let table = |k| {
            let table = Var::new("table", "", Law::Own);
            if self.tables == self.numbers.len() { table.of("die", k as u32 + 1) } else { table }
        };
        all.extend((0..self.tables).map(table));
        Vars::new(all)
    }

    /// The law of one number of a die's initial conditions, before the height is cut off.
    #[must_use]
    pub fn number(&self, die: usize, number: usize) -> &Gaussian {
        &self.numbers[die][number]
    }

    /// The value of one number of a die's initial conditions, including its table's shift.
    #[must_use]
    pub fn value(&self, draw: &Draw, die: usize, which: usize) -> f64 {
        let value = *number(&draw.throws[die], which);
        if which < 2 { value + draw.offset(die, self.spacing)[which] } else { value }
    }

    /// Log density of one die's throw, except for its place along the table and the cut of heights.
    ///
    /// # Errors
    /// [`NotANumber`] if the throw holds a NaN.
    pub fn log_density_elsewhere(&self, throw: &Throw, die: usize) -> Result<LogDensity, NotANumber> {
        let density = |k: usize| self.numbers[die][k].log_density(number(throw, k));
        (2..NUMBERS).try_fold(LogDensity::ONE, |sum, k| Ok(sum + density(k)?))
    }

    /// How many orientations its symmetry makes equivalent.
    #[must_use]
    pub fn turns(&self) -> usize {
        self.turns
    }

    /// One die's throw.
    pub fn throw(&self, die: usize, stream: &mut Stream) -> Throw {
        let law = &self.numbers[die];
        let mut three = |from: usize| DVec3::from_array(std::array::from_fn(|axis| law[from + axis].sample(stream)));
        let (position, velocity, spin) = (three(0), three(3), three(6));
        let position = DVec3 { z: self.height.sample(stream), ..position };
        let orientation = any_orientation(stream);
        Throw { position, orientation, velocity, spin, turn: below(stream, self.turns) as u8 }
    }

    /// A draw from the prior.
    pub fn sample(&self, stream: &mut Stream) -> Draw {
        let throws = (0..self.numbers.len()).map(|die| self.throw(die, stream)).collect();
        Draw { throws, tables: (0..self.tables).map(|_| Realisation::new(stream)).collect() }
    }

    /// Log density of a draw, where the orientations' law and that of the tables have density 1.
    ///
    /// # Errors
    /// [`NotANumber`] if the draw holds a NaN.
    pub fn log_density(&self, draw: &Draw) -> Result<LogDensity, NotANumber> {
        let mut sum = LogDensity::ONE;
        for (die, laws) in self.numbers.iter().enumerate() {
            for (k, law) in laws.iter().enumerate() {
                let value = self.value(draw, die, k);
                sum = sum + if k == 2 { self.height.log_density(&value)? } else { law.log_density(&value)? };
            }
        }
        for (k, throw) in draw.throws.iter().enumerate() {
            if draw.throws[..k].iter().any(|other| other.position.distance(throw.position) < self.clear) {
                return Ok(LogDensity::ZERO);
            }
        }
        Ok(sum)
    }
}

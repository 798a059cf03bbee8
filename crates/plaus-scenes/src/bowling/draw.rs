//! What is random: the ball's delivery and where the pins are set; and their prior.

use super::config::Config;
use super::release::{Laws, Quantity};
use crate::scene::ConfigError;
use plaus_dist::{Density, IsotropicGaussian, LogDensity, NotANumber, Radial, Sample, Stream};
use serde::{Deserialize, Serialize};

/// The values of all random variables.
#[derive(Debug, PartialEq, Serialize, Deserialize)]
pub struct Shot {
    /// Values of the ball's quantities, in the order of [`Quantity::ALL`].
    pub ball: [f64; 10],
    /// Offset from its spot of each pin that is set up, in ascending order of their numbers, in mm.
    pub pins: Vec<[f64; 2]>,
}

impl Shot {
    /// The value of a quantity.
    #[must_use]
    pub fn get(&self, quantity: Quantity) -> f64 {
        self.ball[quantity as usize]
    }
}

impl Clone for Shot {
    fn clone(&self) -> Self {
        Self { ball: self.ball, pins: self.pins.clone() }
    }
    fn clone_from(&mut self, source: &Self) {
        self.ball = source.ball;
        self.pins.clone_from(&source.pins);
    }
}

/// The prior: all quantities independent, but that the ball starts above the lane, whatever its radius.
///
/// The paper prints a sum over the pins' factors, which is no density; its text says product, as it is here.
#[derive(Debug, Clone)]
pub struct Prior {
    laws: Laws,
    offset: IsotropicGaussian<2>,
    fresh_as_printed: Radial<2>,
    pins: usize,
}

impl Prior {
    /// The prior of a configuration that sets up this many pins.
    ///
    /// # Errors
    /// [`ConfigError`] where a law is none.
    pub(super) fn new(config: &Config, pins: usize) -> Result<Self, ConfigError> {
        let blame = |error| ConfigError::new("world.bowling.pin_sigma_mm", error);
        let sigma = config.pin_sigma_mm;
        Ok(Self {
            laws: Laws::new(config)?,
            offset: IsotropicGaussian::new(sigma).map_err(blame)?,
            fresh_as_printed: Radial::new(sigma).map_err(blame)?,
            pins,
        })
    }

    /// The laws of the ball's quantities.
    #[must_use]
    pub fn laws(&self) -> &Laws {
        &self.laws
    }

    /// A pin's offset.
    pub fn offset(&self, stream: &mut Stream) -> [f64; 2] {
        self.offset.sample(stream)
    }

    /// Log density of a pin's offset.
    ///
    /// # Errors
    /// [`NotANumber`] where it is NaN.
    pub fn log_offset(&self, offset: &[f64; 2]) -> Result<LogDensity, NotANumber> {
        self.offset.log_density(offset)
    }

    /// A draw of the prior; with the paper's recipe for pins (a random direction, a Gaussian distance) where
    /// `as_printed`, which is another law.
    pub fn sample(&self, as_printed: bool, draw: &mut Shot, stream: &mut Stream) {
        for quantity in Quantity::ALL {
            draw.ball[quantity as usize] = self.laws.sample(quantity, &draw.ball, stream);
        }
        draw.pins.clear();
        for _ in 0..self.pins {
            let offset = if as_printed { self.fresh_as_printed.sample(stream) } else { self.offset(stream) };
            draw.pins.push(offset);
        }
    }

    /// Log density of a draw.
    ///
    /// # Errors
    /// [`NotANumber`] where the draw holds a NaN.
    pub fn log_density(&self, draw: &Shot) -> Result<LogDensity, NotANumber> {
        let ball: LogDensity = Quantity::ALL
            .into_iter()
            .map(|quantity| self.laws.log_density(quantity, &draw.ball))
            .sum::<Result<LogDensity, NotANumber>>()?;
        draw.pins.iter().try_fold(ball, |sum, offset| Ok(sum + self.log_offset(offset)?))
    }
}

//! What is random: the ball's delivery and where the pins are set.
//!
//! Everything is independent, except that the ball starts above the lane, whatever its radius. The paper prints a sum
//! over the pins' factors, which is not a density; its text says product, as here.

use super::config::Config;
use super::release::{self, Quantity};
use crate::in_place::clone_in_place;
use crate::scene::ConfigError;
use plaus_mcmc::{Law, Offset, Var, Vars};
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

    /// The numbers of a variable, by its index in [`vars`].
    pub(super) fn values(&self, var: usize) -> Option<&[f64]> {
        let pin = || self.pins.get(var - self.ball.len()).map(<[f64; 2]>::as_slice);
        self.ball.get(var).map(std::slice::from_ref).or_else(pin)
    }

    /// The same, to change.
    pub(super) fn values_mut(&mut self, var: usize) -> Option<&mut [f64]> {
        let place = var.checked_sub(self.ball.len());
        match place {
            None => self.ball.get_mut(var).map(std::slice::from_mut),
            Some(place) => self.pins.get_mut(place).map(<[f64; 2]>::as_mut_slice),
        }
    }
}

clone_in_place!(Shot { ball, pins });

/// The variables of a configuration that sets up these pins: the ball's quantities, then the pins' offsets.
pub(super) fn vars(config: &Config, pins: &[usize]) -> Result<Vars, ConfigError> {
    let offset = Offset::new(config.pin_sigma_mm, f64::INFINITY)
        .map_err(|error| ConfigError::new("world.bowling.pin_sigma_mm", error))?;
    let quantity = |(quantity, law): (Quantity, Law)| {
        let ((name, unit), is_uncertain) = (quantity.name(), law.is_uncertain());
        let var = Var::new(name, unit, law);
        if is_uncertain { var.column(1.0) } else { var }
    };
    let pin = |&pin: &usize| Var::new("offset", "mm", Law::Plane(offset.clone())).of("pin", pin as u32);
    let ball = Quantity::ALL.into_iter().zip(release::laws(config.delivery, &config.release)?).map(quantity);
    Ok(Vars::new(ball.chain(pins.iter().map(pin)).collect()))
}

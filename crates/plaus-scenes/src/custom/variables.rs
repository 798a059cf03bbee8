//! Where a draw has the values of its variables.

use super::Custom;
use super::values::{Drawn, Slot};
use crate::turns::{any_orientation, turned_a_little};
use plaus_dist::Stream;
use plaus_mcmc::{Variables, Vars};

impl Variables for Custom {
    fn vars(&self) -> &Vars {
        &self.vars
    }

    fn get<'a>(&self, draw: &'a Drawn, var: usize) -> Option<&'a [f64]> {
        match self.slots.get(var)? {
            Slot::Number(index) => draw.numbers.get(*index).map(std::slice::from_ref),
            Slot::Turn(_) | Slot::Table(_) => None,
        }
    }

    fn get_mut<'a>(&self, draw: &'a mut Drawn, var: usize) -> Option<&'a mut [f64]> {
        match self.slots.get(var)? {
            Slot::Number(index) => draw.numbers.get_mut(*index).map(std::slice::from_mut),
            Slot::Turn(_) | Slot::Table(_) => None,
        }
    }

    fn renew_own(&self, draw: &mut Drawn, var: usize, stream: &mut Stream) {
        match self.slots.get(var) {
            Some(Slot::Turn(index)) => draw.turns[*index] = any_orientation(stream),
            Some(Slot::Table(index)) => draw.tables[*index].renew(stream),
            Some(Slot::Number(_)) | None => {}
        }
    }

    fn step_own(&self, draw: &mut Drawn, var: usize, size: f64, stream: &mut Stream) {
        match self.slots.get(var) {
            Some(Slot::Turn(index)) => draw.turns[*index] = turned_a_little(draw.turns[*index], size, stream),
            Some(Slot::Table(index)) => draw.tables[*index].step(size, stream),
            Some(Slot::Number(_)) | None => {}
        }
    }
}

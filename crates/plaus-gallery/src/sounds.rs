//! Sounds: how each thing rings, once for each page; and what presses it and when, for each solution.

use crate::models::Bytes;
use plaus_export::sound::{Score, Thing};
use serde_json::{Value, json};

/// All things that sound.
#[derive(Debug, Default)]
pub(crate) struct Sounds {
    known: Vec<Thing>,
    pub(crate) list: Vec<Value>,
}

impl Sounds {
    /// Stores a score, and returns its number of contacts. Impacts are in the order of the animation's.
    pub(crate) fn add(&mut self, score: &Score, bytes: &mut Bytes) -> usize {
        let numbers: Vec<u16> = score.things.iter().map(|(_, thing)| self.number(thing)).collect();
        bytes.f32s(score.strikes.iter().map(|strike| strike.length));
        bytes.f32s(score.strikes.iter().map(|strike| strike.impulse));
        for side in 0..2 {
            bytes.u16s(score.strikes.iter().map(|strike| numbers[strike.pair[side]]));
        }
        bytes.f32s(score.rubs.iter().map(|rub| rub.start));
        bytes.f32s(score.rubs.iter().map(|rub| rub.end));
        for kind in 0..2 {
            bytes.f32s(score.rubs.iter().map(|rub| rub.speeds[kind]));
            bytes.f32s(score.rubs.iter().map(|rub| rub.forces[kind]));
        }
        for side in 0..2 {
            bytes.u16s(score.rubs.iter().map(|rub| numbers[rub.pair[side]]));
        }
        score.rubs.len()
    }

    /// The number of a thing with this sound.
    fn number(&mut self, thing: &Thing) -> u16 {
        let known = self.known.iter().position(|known| known == thing).unwrap_or_else(|| {
            let modes: Vec<[f64; 3]> = thing.modes.iter().map(|mode| [mode.omega, mode.fades, mode.loud]).collect();
            self.list.push(json!({"click": thing.click, "modes": modes}));
            self.known.push(thing.clone());
            self.known.len() - 1
        });
        known as u16
    }
}

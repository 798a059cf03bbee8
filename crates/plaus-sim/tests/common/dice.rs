//! Random numbers of a throw.
#![allow(dead_code, unreachable_pub)]

use glam::{DQuat, DVec3};
use plaus_dist::{Purpose, Seed, Stream, open_unit};

/// Random numbers of one throw.
pub struct Dice(Stream);

impl Dice {
    pub fn new(seed: u64, throw: u64) -> Self {
        Self(Seed(seed).chain(0).at(throw, Purpose::START))
    }

    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * open_unit(&mut self.0)
    }

    pub fn in_cube(&mut self) -> DVec3 {
        DVec3::new(self.between(-1.0, 1.0), self.between(-1.0, 1.0), self.between(-1.0, 1.0))
    }

    pub fn turn(&mut self) -> DQuat {
        loop {
            let q = DQuat::from_vec4(self.in_cube().extend(self.between(-1.0, 1.0)));
            if (0.01..=1.0).contains(&q.length_squared()) {
                return q.normalize();
            }
        }
    }
}

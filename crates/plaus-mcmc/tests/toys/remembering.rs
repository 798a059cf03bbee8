//! The balls again, with a memory of where the current state's balls lie. Balls that did not move are looked up in it.

use super::balls::{Balls, Drops};
use plaus_dist::{LogDensity, LogPotential, Stream};
use plaus_mcmc::{ModelError, Simulated, StateRefOf, Target, view::View};

pub struct Remembering {
    pub balls: Balls,
    /// A bug: the memory follows every simulation, accepted or not.
    pub forgets_verdict: bool,
}

/// The bin of each ball, of the current state and of the candidate.
#[derive(Default)]
pub struct Memory {
    current: Vec<Option<usize>>,
    candidate: Vec<Option<usize>>,
}

impl Target for Remembering {
    type Draw = Drops;
    type Outcome = Vec<u32>;
    type Scratch = Memory;
    fn start(&self, stream: &mut Stream) -> Drops {
        self.balls.start(stream)
    }
    fn log_prior(&self, draw: &Drops) -> Result<LogDensity, ModelError> {
        self.balls.log_prior(draw)
    }
    fn simulate(
        &self,
        draw: &Drops,
        current: Option<StateRefOf<'_, Self>>,
        _: LogPotential,
        memory: &mut Memory,
    ) -> Result<Simulated<Vec<u32>>, ModelError> {
        let known = current.filter(|_| memory.current.len() == draw.len());
        memory.candidate.clear();
        for (ball, drop) in draw.iter().enumerate() {
            let unchanged = known.is_some_and(|state| state.draw[ball] == *drop);
            let bin = if unchanged { memory.current[ball] } else { drop.map(|place| self.balls.bin(place)) };
            memory.candidate.push(bin);
        }
        let mut loads = vec![0; self.balls.bins];
        memory.candidate.iter().flatten().for_each(|&bin| loads[bin] += 1);
        Ok(Simulated::Complete(loads))
    }
    fn log_constraint(&self, loads: &Vec<u32>) -> Result<LogPotential, ModelError> {
        self.balls.log_constraint(loads)
    }
    fn decided(&self, accepted: bool, memory: &mut Memory) {
        if accepted || self.forgets_verdict {
            std::mem::swap(&mut memory.current, &mut memory.candidate);
        }
    }
}

impl View for Remembering {
    type Seen = Balls;
    fn seen(&self) -> &Balls {
        &self.balls
    }
}

//! Multilevel splitting: particles from the prior climb the constraint; in each round the lowest ones are replaced.
//!
//! In each round all particles at the lowest log constraint ℓ die. Each is replaced by a copy of a living one, moved on
//! within the prior above ℓ. If k of N particles die, the share of the prior above ℓ, relative to ℓ and above, is
//! estimated as `1 − k/N`. The dead leave their share of the weight behind, so the estimate of any event's probability
//! is
//!
//! `Σ_rounds w/N · (dead that meet it) + w/N · (living ones at the end that meet it)`,  `w = Π (1 − k/N)`.
//!
//! Letting all at one level die together makes this right where many particles share a level: constraints that count
//! fulfilled parts consist of plateaus. The usual estimator, a factor `1 − 1/N` for each death, is not even consistent
//! there (C. Walter, "Rare event simulation and splitting for discontinuous random variables", ESAIM: P&S 19, 2015,
//! arXiv 1507.00919, gives this correction; Bréhier, Gazeau, Goudenège, Lelièvre & Rousset, "Unbiasedness of some
//! generalized adaptive multilevel splitting algorithms", Annals of Applied Probability 26, 2016, show that the
//! weighted sum is unbiased for any event and any stopping rule). It needs draws from the prior above ℓ that are
//! independent of the copied particle; a number of steps of the target's moves approximates that.

use super::above::Above;
use super::{BRANCH, ChanceError, ChancePulse, DRAW, Parts, at_least, prior, streams};
use crate::chain::Chain;
use crate::moves::Mixture;
use crate::target::{Goal, State, StateOf};
use crate::view::lend;
use plaus_dist::stream::below;
use plaus_dist::{ChainStreams, LogPotential, Seed};
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// Settings of splitting.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Splitting {
    /// Particles of a batch, at least 2.
    pub particles: u32,
    /// Steps that a copy makes, at least 1.
    pub steps: u64,
    /// A batch ends when the weight that remains falls below this.
    pub least: f64,
}

/// The result of a batch.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Split {
    /// The estimated probability of the goal, then of each of its parts.
    pub probability: Vec<f64>,
    /// Number of levels climbed.
    pub levels: u64,
    /// Number of particles that died.
    pub deaths: u64,
    /// Number of simulations, including those that stopped early.
    pub simulations: u64,
    /// Number of the first particles that have descendants among the last ones.
    pub ancestors: u32,
}

/// One of a batch's particles.
struct Particle<D, O> {
    state: State<D, O>,
    level: LogPotential,
    met: Vec<bool>,
    ancestor: u32,
}

/// Splits one batch of particles towards the goal of `target`, with its `moves`.
///
/// # Errors
/// [`ChanceError`] if the model fails, the plan makes no batch, or the pulse was stopped.
pub fn split<T: Goal + 'static>(
    (target, moves): (&T, &Arc<Mixture<T>>),
    parts: Parts<'_, T>,
    seed: Seed,
    batch: u32,
    splitting: Splitting,
    pulse: &ChancePulse,
) -> Result<Split, ChanceError> {
    at_least("particles", u64::from(splitting.particles), 2)?;
    at_least("steps", splitting.steps, 1)?;
    let mut population = Population::new((target, parts), seed, batch, splitting, pulse)?;
    let lent = lend::<Above<'_, T>>(Arc::clone(moves)).map_err(|error| population.failed(error.to_string()))?;
    while !population.is_there() {
        population.climb(&lent)?;
    }
    Ok(population.end())
}

struct Population<'a, T: Goal> {
    target: &'a T,
    parts: Parts<'a, T>,
    splitting: Splitting,
    batch: u32,
    pulse: &'a ChancePulse,
    streams: ChainStreams,
    particles: Vec<Particle<T::Draw, T::Outcome>>,
    /// Share of the prior that the particles represent.
    weight: f64,
    made: Split,
    /// Number of steps made by all copies: each step has random numbers of its own.
    steps: u64,
}

impl<'a, T: Goal + 'static> Population<'a, T> {
    fn new(
        (target, parts): (&'a T, Parts<'a, T>),
        seed: Seed,
        batch: u32,
        splitting: Splitting,
        pulse: &'a ChancePulse,
    ) -> Result<Self, ChanceError> {
        let count = 1 + parts.count;
        let (streams, mut scratch) = (streams(seed, batch), T::Scratch::default());
        let mut particles = Vec::with_capacity(splitting.particles as usize);
        for draw in 0..u64::from(splitting.particles) {
            // These draws differ from the counted ones: an estimate that shared them would agree without being
            // independent.
            let mut stream = streams.at((1 << 47) + draw, DRAW);
            let state = prior(target, &mut stream, &mut scratch);
            let state = state.map_err(|source| ChanceError::Model { batch, draw, source })?;
            particles.push(Particle::new((target, parts), state, draw as u32, count));
            pulse.made(1)?;
        }
        let simulations = particles.len() as u64;
        let made = Split { probability: vec![0.0; count], levels: 0, deaths: 0, simulations, ancestors: 0 };
        Ok(Self { target, parts, splitting, batch, pulse, streams, particles, weight: 1.0, made, steps: 0 })
    }

    fn failed(&self, message: String) -> ChanceError {
        ChanceError::Model { batch: self.batch, draw: 0, source: crate::target::ModelError::new(message) }
    }

    /// The lowest level; outcomes that the constraint forbids are at the lowest level of all.
    fn lowest(&self) -> LogPotential {
        let mut levels = self.particles.iter().map(|particle| particle.level);
        let first = levels.next().unwrap_or(LogPotential::ZERO);
        levels.fold(first, |lowest, level| if level < lowest { level } else { lowest })
    }

    /// Whether there is nothing left to climb for: all particles have reached the goal, are at one level, or represent
    /// next to nothing.
    fn is_there(&self) -> bool {
        let lowest = self.lowest();
        self.particles.iter().all(|particle| particle.met[0])
            || self.particles.iter().all(|particle| particle.level == lowest)
            || self.weight < self.splitting.least
    }

    /// Removes the lowest particles and replaces them by copies of others.
    fn climb(&mut self, moves: &Mixture<Above<'a, T>>) -> Result<(), ChanceError> {
        let level = self.lowest();
        let all = self.particles.len() as f64;
        let (dead, living): (Vec<usize>, Vec<usize>) =
            (0..self.particles.len()).partition(|&index| self.particles[index].level <= level);
        for &index in &dead {
            let met = &self.particles[index].met;
            let share = self.weight / all;
            self.made.probability.iter_mut().zip(met).for_each(|(sum, &met)| *sum += if met { share } else { 0.0 });
        }
        self.weight *= living.len() as f64 / all;
        self.made.levels += 1;
        self.made.deaths += dead.len() as u64;
        let mut stream = self.streams.at(self.made.levels, BRANCH);
        for index in dead {
            let parent = living[below(&mut stream, living.len())];
            self.particles[index] = self.copy(parent, level, moves)?;
        }
        Ok(())
    }

    /// A copy of a particle, moved on above a level.
    fn copy(
        &mut self,
        parent: usize,
        level: LogPotential,
        moves: &Mixture<Above<'a, T>>,
    ) -> Result<Particle<T::Draw, T::Outcome>, ChanceError> {
        let (above, steps) = (Above { target: self.target, level }, self.splitting.steps);
        let from = &self.particles[parent];
        let state = State { log_constraint: LogPotential::ONE, ..from.state.clone() };
        let counts = vec![Default::default(); moves.names().len()];
        let mut chain = Chain::resume(&above, moves, self.streams, self.steps, state, counts);
        for _ in 0..steps {
            chain.step().map_err(|source| ChanceError::Chain { batch: self.batch, source })?;
        }
        self.steps += steps;
        let simulations = chain.counts().iter().map(|one| one.rejected_early + one.rejected + one.accepted).sum();
        self.made.simulations += simulations;
        self.pulse.made(simulations)?;
        let mut state = chain.state().clone();
        let level = self.target.log_constraint(&state.outcome);
        state.log_constraint = level.map_err(|source| self.failed(source.to_string()))?;
        Ok(Particle::new((self.target, self.parts), state, from.ancestor, self.made.probability.len()))
    }

    fn end(mut self) -> Split {
        let share = self.weight / self.particles.len() as f64;
        let mut ancestors: Vec<u32> = self.particles.iter().map(|particle| particle.ancestor).collect();
        for particle in &self.particles {
            let sums = self.made.probability.iter_mut().zip(&particle.met);
            sums.for_each(|(sum, &met)| *sum += if met { share } else { 0.0 });
        }
        ancestors.sort_unstable();
        ancestors.dedup();
        self.made.ancestors = ancestors.len() as u32;
        self.made
    }
}

impl<D: Clone, O: Clone> Particle<D, O> {
    fn new<T>((target, parts): (&T, Parts<'_, T>), state: StateOf<T>, ancestor: u32, count: usize) -> Self
    where
        T: Goal<Draw = D, Outcome = O>,
    {
        let mut met = vec![false; count];
        parts.look(target, state.by_ref(), &mut met);
        Self { level: state.log_constraint, met, ancestor, state }
    }
}

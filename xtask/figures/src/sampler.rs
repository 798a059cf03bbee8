//! Chains of a scene, as columns of numbers.

use crate::Result;
use crate::clock::seconds;
use plaus_dist::{ChainStreams, Seed};
use plaus_mcmc::{Chain, Decision, Mixture, MoveCounts, StateOf};
use plaus_scenes::{Rules, Scene};
use rayon::prelude::*;

/// A scene with the moves by which it is sampled, exactly.
pub(crate) struct Sampler<S: Scene> {
    pub(crate) scene: S,
    pub(crate) moves: Mixture<S>,
}

/// Scalars of several chains.
pub(crate) struct Traces {
    /// For each scalar, chain and iteration.
    pub(crate) columns: Vec<Vec<Vec<f64>>>,
    /// Accepted share of all iterations after the warm-up.
    pub(crate) acceptance: f64,
}

/// How a chain fared until it first satisfied its constraint.
pub(crate) struct First<S: Scene> {
    /// Iterations made.
    pub(crate) iterations: u64,
    /// Processor time, including that of the start.
    pub(crate) seconds: f64,
    /// Where the chain is.
    pub(crate) state: StateOf<S>,
    /// Whether that state satisfies it.
    pub(crate) found: bool,
}

/// Length and seed.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Length {
    pub(crate) seed: u64,
    pub(crate) chains: u64,
    pub(crate) warmup: u64,
    pub(crate) iterations: u64,
}

impl<S: Scene> Sampler<S> {
    pub(crate) fn new(scene: S) -> Result<Self> {
        let moves = scene.moves(&Rules::exact())?;
        Ok(Self { scene, moves })
    }

    /// The states of iterations 0 .. `count` of one chain, the first being its start.
    pub(crate) fn states(&self, seed: u64, chain: u64, count: u64) -> Result<Vec<StateOf<S>>> {
        let mut chain = Chain::start(&self.scene, &self.moves, Seed(seed).chain(chain))?;
        let mut states = vec![chain.state().clone()];
        for _ in 1..count {
            chain.step()?;
            states.push(chain.state().clone());
        }
        Ok(states)
    }

    /// The scalars with the indices `wanted`.
    pub(crate) fn traces(&self, length: Length, wanted: &[usize]) -> Result<Traces> {
        let chains = (0..length.chains).into_par_iter().map(|chain| self.trace(length, chain, wanted));
        let chains = chains.collect::<Result<Vec<_>>>()?;
        let mut columns = vec![Vec::new(); wanted.len()];
        let mut counts = MoveCounts::default();
        for (scalars, counted) in chains {
            counts.add(&counted);
            for (column, scalar) in columns.iter_mut().zip(scalars) {
                column.push(scalar);
            }
        }
        Ok(Traces { columns, acceptance: counts.acceptance() })
    }

    fn trace(&self, length: Length, chain: u64, wanted: &[usize]) -> Result<(Vec<Vec<f64>>, MoveCounts)> {
        let streams = Seed(length.seed).chain(chain);
        let mut chain = Chain::start(&self.scene, &self.moves, streams)?;
        for _ in 0..length.warmup {
            chain.step()?;
        }
        let fresh = vec![MoveCounts::default(); chain.counts().len()];
        let mut chain = Chain::resume(&self.scene, &self.moves, streams, length.warmup, chain.state().clone(), fresh);
        let mut values = vec![0.0; self.scene.scalars().len()];
        let mut columns = vec![Vec::with_capacity(length.iterations as usize); wanted.len()];
        for _ in 0..length.iterations {
            chain.step()?;
            self.scene.write_scalars(chain.state().by_ref(), &mut values);
            for (column, &index) in columns.iter_mut().zip(wanted) {
                column.push(values[index]);
            }
        }
        let mut counts = MoveCounts::default();
        chain.counts().iter().for_each(|counted| counts.add(counted));
        Ok((columns, counts))
    }

    /// For each of `chains` chains, the first iteration that satisfies the constraint; `None` if none up to `limit`
    /// does.
    pub(crate) fn first_hits(&self, seed: u64, chains: u64, limit: u64) -> Result<Vec<Option<u64>>> {
        let first = |chain| -> Result<Option<u64>> {
            let mut chain = Chain::start(&self.scene, &self.moves, Seed(seed).chain(chain))?;
            while self.scene.class(chain.state().by_ref()).is_none() {
                if chain.iteration() == limit {
                    return Ok(None);
                }
                chain.step()?;
            }
            Ok(Some(chain.iteration()))
        };
        (0..chains).into_par_iter().map(first).collect()
    }

    /// A chain that ends with the first iteration that satisfies the constraint, or after `limit`.
    pub(crate) fn first(&self, streams: ChainStreams, limit: u64) -> Result<First<S>> {
        let begin = seconds();
        let mut chain = Chain::start(&self.scene, &self.moves, streams)?;
        let mut found = self.scene.class(chain.state().by_ref()).is_some();
        while !found && chain.iteration() < limit {
            found = chain.step()?.decision == Decision::Accepted && self.scene.class(chain.state().by_ref()).is_some();
        }
        let (iterations, state) = (chain.iteration(), chain.state().clone());
        Ok(First { iterations, seconds: seconds() - begin, state, found })
    }
}

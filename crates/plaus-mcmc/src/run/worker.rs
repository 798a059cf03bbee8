//! One chain of a run, with its records and tallies.

use super::{Plan, Snapshot, Start};
use crate::chain::{Chain, ChainError, MoveCounts, Verdict};
use crate::moves::{Mixture, MoveId};
use crate::record::{Block, is_recorded};
use crate::solutions::{Distinct, FirstOfClass, Hits};
use crate::target::{Goal, SolutionClass, Target};

/// What all workers read.
pub(super) struct Job<'a, T: Target> {
    pub(super) target: &'a T,
    pub(super) moves: &'a Mixture<T>,
    pub(super) plan: Plan,
}

/// One chain at work.
pub(super) struct Worker<'a, T: Target> {
    pub(super) index: u32,
    pub(super) chain: Option<Chain<'a, T>>,
    pub(super) hits: Hits,
    pub(super) distinct: Distinct,
    class: Option<SolutionClass>,
    pending: (u32, Option<MoveId>),
    pub(super) end_iteration: u64,
}

/// What a worker made in a round.
pub(super) struct Made<D, O> {
    pub(super) block: Block<D, O>,
    pub(super) firsts: Vec<FirstOfClass>,
}

impl<'a, T: Goal> Worker<'a, T> {
    pub(super) fn new(index: u32) -> Self {
        Self {
            index,
            chain: None,
            hits: Hits::default(),
            distinct: Distinct::default(),
            class: None,
            pending: (0, None),
            end_iteration: 0,
        }
    }

    pub(super) fn resume(job: &Job<'a, T>, index: u32, start: Start<T::Draw, T::Outcome>) -> Self {
        let Start { snapshot, distinct } = start;
        let class = job.target.class(&snapshot.state);
        let streams = job.plan.seed.chain(u64::from(index));
        let iteration = snapshot.end_iteration - 1;
        let chain = Chain::resume(job.target, job.moves, streams, iteration, snapshot.state, snapshot.counts);
        Self {
            index,
            chain: Some(chain),
            hits: snapshot.hits,
            distinct,
            class,
            pending: snapshot.pending,
            end_iteration: snapshot.end_iteration,
        }
    }

    /// Advances until iterations `0 .. end` are done.
    pub(super) fn advance(&mut self, job: &Job<'a, T>, end: u64) -> Result<Made<T::Draw, T::Outcome>, ChainError> {
        let mut made = Made { block: Block::starting_at(self.end_iteration), firsts: Vec::new() };
        if self.chain.is_none() && end > 0 {
            let chain = Chain::start(job.target, job.moves, job.plan.seed.chain(u64::from(self.index)))?;
            self.class = job.target.class(chain.state());
            self.chain = Some(chain);
            self.note(job.plan.thin, 0, &mut made);
        }
        while self.end_iteration < end {
            let Some(chain) = &mut self.chain else { break };
            let step = chain.step()?;
            if step.verdict == Verdict::Accepted {
                self.class = job.target.class(chain.state());
                self.pending = (self.pending.0.saturating_add(1), Some(step.move_id));
            }
            self.note(job.plan.thin, self.end_iteration, &mut made);
        }
        made.block.end_iteration = self.end_iteration;
        Ok(made)
    }

    /// Books the chain's state as that of `iteration`.
    #[inline]
    fn note(&mut self, thin: u64, iteration: u64, made: &mut Made<T::Draw, T::Outcome>) {
        self.end_iteration = iteration + 1;
        self.hits.count(iteration, self.class.is_some());
        if !is_recorded(iteration, thin) {
            return;
        }
        let (accepted, by) = std::mem::take(&mut self.pending);
        let fresh = accepted > 0 || made.block.entries.is_empty();
        if let Some(chain) = &self.chain {
            made.block.push(accepted, by, self.class, chain.state());
        }
        if let (true, Some(class)) = (fresh, self.class) {
            let first = FirstOfClass { iteration, chain: self.index, class };
            if self.distinct.note(first) {
                made.firsts.push(first);
            }
        }
    }

    pub(super) fn counts(&self) -> &[MoveCounts] {
        self.chain.as_ref().map_or(&[], Chain::counts)
    }

    pub(super) fn snapshot(&self) -> Option<Snapshot<T::Draw, T::Outcome>> {
        let chain = self.chain.as_ref()?;
        Some(Snapshot {
            end_iteration: self.end_iteration,
            state: chain.state().clone(),
            counts: chain.counts().to_vec(),
            hits: self.hits,
            pending: self.pending,
        })
    }
}

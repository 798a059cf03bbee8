//! Several chains in parallel, in rounds, with the same bits whatever the number of threads.
//!
//! Every chain advances to the next multiple of [`Plan::block`] iterations, then all wait: rounds are where the caller receives records and
//! snapshots, in order of chain, and says whether to go on. A run that goes on from its last snapshots gives the bits of one that was never interrupted.

use crate::chain::{Chain, ChainError, MoveCounts, Verdict};
use crate::moves::{Mixture, MoveId};
use crate::record::{Block, is_recorded};
use crate::solutions::{Distinct, FirstOfClass, Hits};
use crate::target::{Goal, SolutionClass, State, Target};
use plaus_dist::Seed;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

/// How long, how often, from which seed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct Plan {
    /// Seed of the run.
    pub seed: Seed,
    /// Number of chains, at least 1.
    pub chains: u32,
    /// Iterations before the sampling phase; recorded, but told apart.
    pub warmup: u64,
    /// Iterations of the sampling phase, whose states are what diagnostics see.
    pub iterations: u64,
    /// Every `thin`-th iteration is recorded; at least 1.
    pub thin: u64,
    /// Iterations between two points at which the run can stop and later go on; at least 1.
    pub block: u64,
    /// Stop at the first iteration by which the chains together have recorded this many distinct solutions.
    pub solutions: Option<u64>,
}

impl Plan {
    /// One past the last iteration: the states are those of iterations `0 .. end`.
    #[must_use]
    pub fn end(&self) -> u64 {
        self.warmup + self.iterations
    }
}

/// A chain between two blocks: all that its future and its statistics follow from.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Snapshot<D, O> {
    /// Iterations 0 up to here, exclusive, are done and recorded.
    pub end_iteration: u64,
    /// The state of iteration `end_iteration − 1`.
    pub state: State<D, O>,
    /// How often each move ended how.
    pub counts: Vec<MoveCounts>,
    /// Satisfying iterations.
    pub hits: Hits,
    /// Proposals accepted since the last recorded draw, and the last such move.
    pub pending: (u32, Option<MoveId>),
}

/// Where a chain goes on from, with the classes of solutions it has recorded (from its records).
pub struct Start<D, O> {
    /// The snapshot.
    pub snapshot: Snapshot<D, O>,
    /// First recorded solutions of each class in this chain.
    pub distinct: Distinct,
}

/// What the caller says after a round.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Control {
    /// Go on.
    Continue,
    /// Stop here; the run can be resumed.
    Stop,
}

/// Receives what the chains leave behind.
pub trait Sink<D, O> {
    /// What may go wrong in the sink.
    type Error;

    /// Called for every chain after each round, in order of chain.
    ///
    /// # Errors
    /// Stops the run.
    fn block(&mut self, chain: u32, block: Block<D, O>, snapshot: &Snapshot<D, O>) -> Result<(), Self::Error>;

    /// Called once after each round.
    ///
    /// # Errors
    /// Stops the run.
    fn round(&mut self, progress: &Progress<'_>) -> Result<Control, Self::Error>;
}

/// Where a run stands after a round.
pub struct Progress<'a> {
    /// Iterations done by every chain.
    pub end_iteration: u64,
    /// Distinct solutions recorded by all chains together.
    pub distinct: &'a Distinct,
    /// Per chain: counts of each move, and hits.
    pub chains: Vec<(&'a [MoveCounts], Hits)>,
}

/// How a run ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Ending {
    /// All planned iterations are done.
    Complete,
    /// The demanded number of distinct solutions is recorded.
    EnoughSolutions,
    /// The sink said stop.
    Stopped,
}

/// Why a run broke off.
#[derive(Debug, thiserror::Error)]
pub enum RunError<E> {
    /// A chain failed.
    #[error("chain {chain}: {source}")]
    Chain {
        /// Which.
        chain: u32,
        /// How.
        source: ChainError,
    },
    /// The sink failed.
    #[error(transparent)]
    Sink(E),
    /// The operating system gave no threads.
    #[error("cannot start worker threads: {0}")]
    Threads(#[from] rayon::ThreadPoolBuildError),
}

/// One chain at work.
struct Worker<'a, T: Target> {
    index: u32,
    chain: Option<Chain<'a, T>>,
    hits: Hits,
    distinct: Distinct,
    class: Option<SolutionClass>,
    pending: (u32, Option<MoveId>),
    end_iteration: u64,
}

/// What a worker made in a round.
struct Made<D, O> {
    block: Block<D, O>,
    firsts: Vec<FirstOfClass>,
}

impl<'a, T: Goal> Worker<'a, T> {
    fn new(index: u32) -> Self {
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

    fn resume(job: &Job<'a, T>, index: u32, start: Start<T::Draw, T::Outcome>) -> Self {
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
    fn advance(&mut self, job: &Job<'a, T>, end: u64) -> Result<Made<T::Draw, T::Outcome>, ChainError> {
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

    fn snapshot(&self) -> Option<Snapshot<T::Draw, T::Outcome>> {
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

/// What all workers read.
struct Job<'a, T: Target> {
    target: &'a T,
    moves: &'a Mixture<T>,
    plan: Plan,
}

/// Runs, or goes on with, the chains of `plan` on `threads` threads (0: one a core). `starts` is empty, or holds one start a chain, all at the same
/// iteration.
///
/// # Errors
/// [`RunError`] where a chain or the sink fails. Everything the sink received before stays valid.
pub fn run<T: Goal, S: Sink<T::Draw, T::Outcome>>(
    target: &T,
    moves: &Mixture<T>,
    plan: Plan,
    starts: Vec<Start<T::Draw, T::Outcome>>,
    threads: usize,
    sink: &mut S,
) -> Result<Ending, RunError<S::Error>> {
    let job = Job { target, moves, plan };
    let mut workers: Vec<Worker<'_, T>> = if starts.is_empty() {
        (0..plan.chains).map(Worker::new).collect()
    } else {
        (0..plan.chains).zip(starts).map(|(index, start)| Worker::resume(&job, index, start)).collect()
    };
    let mut distinct = Distinct::default();
    merge(&mut distinct, workers.iter().flat_map(|worker| worker.distinct.firsts().iter().copied()).collect());
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build()?;
    let mut done = workers.first().map_or(0, |worker| worker.end_iteration);
    while done < plan.end() {
        if enough(&distinct, plan) {
            return Ok(Ending::EnoughSolutions);
        }
        let before: Vec<_> = workers.iter().map(|w| (w.snapshot(), w.distinct.clone())).take(keep(plan)).collect();
        let end = ((done / plan.block + 1) * plan.block).min(plan.end());
        let mut made = round(&pool, &job, &mut workers, end)?;
        let news = made.iter().flat_map(|m| m.firsts.iter().copied()).collect();
        if let Some(last) =
            merge(&mut distinct, news).filter(|_| enough(&distinct, plan)).and_then(|_| reached(&distinct, plan))
        {
            // The chains ran past the iteration that completed the demanded number: redo the round up to there, so that the result does not depend on the block.
            workers = before
                .into_iter()
                .zip(0..)
                .map(|((snapshot, distinct), index)| match snapshot {
                    Some(snapshot) => Worker::resume(&job, index, Start { snapshot, distinct }),
                    None => Worker::new(index),
                })
                .collect();
            made = round(&pool, &job, &mut workers, last + 1)?;
            distinct.truncate(last);
        }
        done = workers.first().map_or(plan.end(), |worker| worker.end_iteration);
        for (worker, made) in workers.iter().zip(made) {
            if let Some(snapshot) = worker.snapshot() {
                sink.block(worker.index, made.block, &snapshot).map_err(RunError::Sink)?;
            }
        }
        let chains = workers.iter().map(|w| (w.chain.as_ref().map_or(&[][..], Chain::counts), w.hits)).collect();
        let progress = Progress { end_iteration: done, distinct: &distinct, chains };
        if sink.round(&progress).map_err(RunError::Sink)? == Control::Stop && done < plan.end() {
            return Ok(if enough(&distinct, plan) { Ending::EnoughSolutions } else { Ending::Stopped });
        }
    }
    Ok(if enough(&distinct, plan) { Ending::EnoughSolutions } else { Ending::Complete })
}

type MadeOf<T> = Made<<T as Target>::Draw, <T as Target>::Outcome>;

/// Advances all chains to `end` in parallel; the first failing chain, by index, is the one reported.
fn round<'a, T: Goal, E>(
    pool: &rayon::ThreadPool,
    job: &Job<'a, T>,
    workers: &mut [Worker<'a, T>],
    end: u64,
) -> Result<Vec<MadeOf<T>>, RunError<E>> {
    let results: Vec<_> = pool.install(|| workers.par_iter_mut().map(|worker| worker.advance(job, end)).collect());
    let fail =
        |(chain, result): (u32, Result<_, ChainError>)| result.map_err(|source| RunError::Chain { chain, source });
    (0..).zip(results).map(fail).collect()
}

/// Snapshots of how many chains a round must keep to be able to redo itself: none where no number of solutions is demanded.
fn keep(plan: Plan) -> usize {
    if plan.solutions.is_some() { plan.chains as usize } else { 0 }
}

/// Notes solutions found by several chains in the order of iteration, then chain.
fn merge(distinct: &mut Distinct, mut news: Vec<FirstOfClass>) -> Option<()> {
    news.sort_unstable();
    (news.into_iter().filter(|&first| distinct.note(first)).count() > 0).then_some(())
}

fn enough(distinct: &Distinct, plan: Plan) -> bool {
    plan.solutions.is_some_and(|wanted| distinct.count() >= wanted)
}

/// The iteration that recorded the last demanded solution.
fn reached(distinct: &Distinct, plan: Plan) -> Option<u64> {
    let wanted = usize::try_from(plan.solutions?).ok()?;
    distinct.firsts().get(wanted.checked_sub(1)?).map(|first| first.iteration)
}

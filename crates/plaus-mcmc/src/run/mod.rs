//! Several chains in parallel, in rounds, with the same bits whatever the number of threads.
//!
//! Every chain advances to the end of a block of iterations; then all wait. After each round the caller receives
//! records and snapshots, in order of chain, and says whether to continue. A run continued from its last snapshots
//! gives the same bits as one that was never interrupted. Between rounds a [`Pulse`] shows how far the chains are, and
//! can stop them.

mod bounds;
mod hunt;
mod plan;
mod pulse;
mod worker;

pub use plan::{Plan, PlanError};
pub use pulse::{ChainPulse, Pulse};

use crate::adapt::Scales;
use crate::chain::{ChainError, MoveCounts};
use crate::failures::Failures;
use crate::look::Look;
use crate::moves::{Mixture, MoveId};
use crate::parallel::{self, Threads};
use crate::record::Block;
use crate::redraw::Redraw;
use crate::replicas::{Climb, ReplicasSnapshot};
use crate::solutions::{Distinct, FirstOfClass, Hits, Sighting};
use crate::target::{Goal, State, Target};
use bounds::end_of_block;
use hunt::Hunt;
use serde::{Deserialize, Serialize};
use std::ops::Range;
use std::sync::Arc;
use worker::{Job, Made, Worker};

/// A chain between two blocks: everything that determines its future and its statistics.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Snapshot<D, O> {
    /// Iterations 0 up to here, exclusive, are done and recorded.
    pub end_iteration: u64,
    /// The state of iteration `end_iteration − 1`.
    pub state: State<D, O>,
    /// How often each move ended in each way.
    pub counts: Vec<MoveCounts>,
    /// The scales of its moves; `None` if it adapts none.
    pub scales: Option<Scales>,
    /// How many draws it simulated, on all rungs, and which of them failed.
    pub failures: Failures,
    /// Satisfying iterations.
    pub hits: Hits,
    /// Proposals accepted since the last recorded draw, and the last such move.
    pub pending: (u32, Option<MoveId>),
    /// Where all rungs are; `None` if there is one.
    pub replicas: Option<ReplicasSnapshot<D, O>>,
}

impl<D, O> Snapshot<D, O> {
    /// The same snapshot with other states, one for one: as seen by a target over the same draws.
    ///
    /// # Errors
    /// As `look` says.
    pub fn try_map<P, E>(
        self,
        mut look: impl FnMut(State<D, O>) -> Result<State<D, P>, E>,
    ) -> Result<Snapshot<D, P>, E> {
        let Self { end_iteration, state, counts, scales, failures, hits, pending, replicas } = self;
        let state = look(state)?;
        let replicas = replicas.map(|replicas| replicas.try_map(look)).transpose()?;
        Ok(Snapshot { end_iteration, state, counts, scales, failures, hits, pending, replicas })
    }
}

/// Where a chain continues from, with the classes of solutions that it has recorded (from its records).
pub struct Start<D, O> {
    /// The snapshot.
    pub snapshot: Snapshot<D, O>,
    /// First recorded solutions of each class in this chain; in a run that looks for a number of them with their
    /// looks.
    pub distinct: Distinct,
}

/// The caller's answer after a round.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Control {
    /// Continue.
    Continue,
    /// Stop here; the run can be resumed.
    Stop,
}

/// Receives what the chains record.
pub trait Sink<D, O> {
    /// The sink's error.
    type Error;

    /// Called for every chain after each round, in order of chain.
    ///
    /// # Errors
    /// An error stops the run.
    fn block(&mut self, chain: u32, block: Block<D, O>, snapshot: &Snapshot<D, O>) -> Result<(), Self::Error>;

    /// Called once after each round.
    ///
    /// # Errors
    /// An error stops the run.
    fn round(&mut self, progress: &Progress<'_>) -> Result<Control, Self::Error>;
}

/// The state of a run after a round.
pub struct Progress<'a> {
    /// Iterations done by every chain.
    pub end_iteration: u64,
    /// Distinct solutions that all chains together have recorded, see [`Plan::counts_from`].
    pub distinct: &'a Distinct,
    /// What was new to its chain in this round, in order of iteration, then chain.
    pub sightings: Vec<Sighting>,
    /// Per chain: counts of each move, and hits.
    pub chains: Vec<(&'a [MoveCounts], Hits)>,
    /// Per chain: where its replicas are, if there are more than one.
    pub climbs: Vec<&'a Climb>,
}

/// How a run ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum Ending {
    /// All planned iterations are done.
    Complete,
    /// The number of distinct solutions asked for is recorded.
    EnoughSolutions,
    /// The sink stopped it, or the pulse did.
    Stopped,
}

/// Why a run broke off.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RunError<E> {
    /// A chain failed.
    #[error("chain {chain}: {source}")]
    Chain {
        /// The chain.
        chain: u32,
        /// Its error.
        source: ChainError,
    },
    /// The sink failed.
    #[error(transparent)]
    Sink(E),
    /// The plan or the starts cannot be run.
    #[error("{0}")]
    Plan(#[from] PlanError),
    /// The operating system gave no threads.
    #[error("cannot start worker threads: {0}")]
    Threads(#[from] rayon::ThreadPoolBuildError),
}

/// Runs, or continues, the chains of `plan` on `threads` threads (0: one per core; never more than there are replicas
/// of chains, see [`useful_threads`]). `starts` is empty, or holds one start for each chain, all at the same iteration.
///
/// # Errors
/// [`RunError`] if the plan makes no run, or a chain or the sink fails. Everything the sink received before stays
/// valid.
pub fn run<T: Goal, S: Sink<T::Draw, T::Outcome>>(
    target: &T,
    moves: &Mixture<T>,
    plan: Plan,
    starts: Vec<Start<T::Draw, T::Outcome>>,
    threads: usize,
    sink: &mut S,
) -> Result<Ending, RunError<S::Error>> {
    run_watched(target, moves, plan, starts, threads, sink, &Pulse::default())
}

/// Like [`run()`], with counters that other threads can read while it runs, and through which they can stop it: within
/// one iteration of each chain, or while the chains start. In the latter case nothing at all is recorded.
///
/// # Errors
/// As [`run()`].
pub fn run_watched<T: Goal, S: Sink<T::Draw, T::Outcome>>(
    target: &T,
    moves: &Mixture<T>,
    plan: Plan,
    starts: Vec<Start<T::Draw, T::Outcome>>,
    threads: usize,
    sink: &mut S,
    pulse: &Pulse,
) -> Result<Ending, RunError<S::Error>> {
    run_some(target, moves, plan, 0..plan.chains, starts, threads, sink, pulse)
}

/// Like [`run_watched()`], for only the chains `some` of the plan: they leave the same bits as in the whole run.
/// Distinct solutions, and the number asked for, are those of these chains together.
///
/// # Errors
/// As [`run()`], and if `some` are none of the plan's chains.
#[allow(clippy::too_many_arguments, reason = "each is a thing of its own, and there is one caller a layer up")]
pub fn run_some<T: Goal, S: Sink<T::Draw, T::Outcome>>(
    target: &T,
    moves: &Mixture<T>,
    plan: Plan,
    some: Range<u32>,
    starts: Vec<Start<T::Draw, T::Outcome>>,
    threads: usize,
    sink: &mut S,
    pulse: &Pulse,
) -> Result<Ending, RunError<S::Error>> {
    let ends: Vec<u64> = starts.iter().map(|start| start.snapshot.end_iteration).collect();
    plan.check(&some, &ends)?;
    let threads = Threads::new(useful_threads(threads, &plan, &some))?;
    let fresh = Mixture::of(Box::new(Redraw));
    let mut fleet = Fleet::new(Job { target, moves, fresh: &fresh, plan, first: some.start }, some, starts, pulse);
    while fleet.done < plan.end() && !fleet.has_enough() {
        let round = threads.install(|| fleet.round());
        let made = round.map_err(|Failed { chain, source }| RunError::Chain { chain, source })?;
        let Some(made) = made else { return Ok(Ending::Stopped) };
        for (worker, made) in fleet.workers.iter().zip(made) {
            if let Some(snapshot) = worker.snapshot() {
                sink.block(worker.books.index, made.block, &snapshot).map_err(RunError::Sink)?;
            }
        }
        let stop = sink.round(&fleet.progress()).map_err(RunError::Sink)? == Control::Stop || pulse.is_stopped();
        if stop && fleet.done < plan.end() && !fleet.has_enough() {
            return Ok(Ending::Stopped);
        }
    }
    Ok(if fleet.has_enough() { Ending::EnoughSolutions } else { Ending::Complete })
}

/// How many of `threads` the chains `some` of a plan can keep busy: one for each replica that there may come to be. 0
/// means one per core, and stays 0.
#[must_use]
pub fn useful_threads(threads: usize, plan: &Plan, some: &Range<u32>) -> usize {
    let replicas = if plan.adapt_rungs { crate::MOST_RUNGS } else { plan.rungs.max(1) as usize };
    threads.min(some.len().max(1).saturating_mul(replicas))
}

/// The chain that failed, and its error.
struct Failed {
    chain: u32,
    source: ChainError,
}

/// All chains of a run, at the same iteration.
struct Fleet<'a, T: Target> {
    job: Job<'a, T>,
    workers: Vec<Worker<'a, T>>,
    pulse: &'a Pulse,
    /// Over all chains, ordered by iteration, then by chain.
    distinct: Distinct,
    /// Those that lie twice as far apart.
    wide: Distinct,
    /// What was new to its chain in the last round.
    sightings: Vec<(FirstOfClass, Arc<Look>)>,
    /// Iterations 0 up to here, exclusive, are done.
    done: u64,
}

type MadeOf<T> = Made<<T as Target>::Draw, <T as Target>::Outcome>;

impl<'a, T: Goal> Fleet<'a, T> {
    fn new(job: Job<'a, T>, some: Range<u32>, starts: Vec<Start<T::Draw, T::Outcome>>, pulse: &'a Pulse) -> Self {
        let workers: Vec<_> = if starts.is_empty() {
            some.map(Worker::new).collect()
        } else {
            some.zip(starts).map(|(index, start)| Worker::resume(&job, index, start)).collect()
        };
        let seen = workers.iter().flat_map(|worker| worker.books.distinct.looks()).collect();
        let done = workers.first().map_or(0, |worker| worker.books.end_iteration);
        let [distinct, wide] = [1.0, 2.0].map(Distinct::apart);
        let mut fleet = Self { job, workers, pulse, distinct, wide, sightings: Vec::new(), done };
        fleet.merge(seen);
        pulse.begin(fleet.workers.len());
        fleet.workers.iter().for_each(|worker| worker.show(&fleet.job, pulse));
        fleet
    }

    /// Advances to the end of the block, or to the iteration that completes the solutions asked for; `None` if the
    /// pulse was stopped before all chains got there: they then have no common state.
    fn round(&mut self) -> Result<Option<Vec<MadeOf<T>>>, Failed> {
        let plan = self.job.plan;
        let mut end = end_of_block(self.done, plan.block).min(plan.end());
        let wanted = plan.solutions.and_then(|wanted| usize::try_from(wanted).ok());
        let before = if wanted.is_some() { self.keep() } else { Vec::new() };
        let (job, pulse) = (&self.job, self.pulse);
        let hunt = Hunt::new(pulse, &self.distinct, self.wide.clone(), wanted);
        let mut made: Vec<_> = parallel::map_mut(&mut self.workers, |_, worker| worker.advance(job, end, &hunt));
        self.merge(made.iter().flat_map(|made| made.firsts.iter().cloned()).collect());
        if let Some(last) = self.completed() {
            // Some chains ran past the iteration that completed the number asked for. They repeat the round up to it,
            // so that the result depends neither on the block nor on which chain was faster.
            end = last + 1;
            self.distinct.truncate(last);
            self.wide.truncate(last);
            self.sightings.retain(|(first, _)| first.iteration <= last);
            let (job, hunt) = (&self.job, Hunt::new(pulse, &self.distinct, self.wide.clone(), None));
            let mut all: Vec<_> = self.workers.iter_mut().zip(before).zip(&mut made).collect();
            parallel::map_mut(&mut all, |_, ((worker, before), made)| {
                let failed = made.failure.as_ref().is_some_and(|failure| failure.iteration() > last);
                if worker.books.end_iteration > end || failed {
                    std::mem::swap(*worker, before);
                    **made = worker.advance(job, end, &hunt);
                }
            });
        }
        pulse.set_distinct(self.distinct.count());
        let failures =
            (self.job.first..).zip(&mut made).filter_map(|(chain, made)| Some((chain, made.failure.take()?)));
        if let Some((chain, source)) = failures.min_by_key(|(chain, failure)| (failure.iteration(), *chain)) {
            return Err(Failed { chain, source });
        }
        let is_there = |(worker, made): (&Worker<'a, T>, &MadeOf<T>)| worker.books.end_iteration >= end && !made.is_cut;
        if !self.workers.iter().zip(&made).all(is_there) {
            return Ok(None);
        }
        self.done = end;
        Ok(Some(made))
    }

    /// Copies of the workers in their present state, for repeating a round.
    fn keep(&self) -> Vec<Worker<'a, T>> {
        let copy = |worker: &Worker<'a, T>| match worker.snapshot() {
            Some(snapshot) => {
                let distinct = worker.books.distinct.clone();
                Worker::resume(&self.job, worker.books.index, Start { snapshot, distinct })
            }
            None => Worker::new(worker.books.index),
        };
        self.workers.iter().map(copy).collect()
    }

    fn merge(&mut self, mut news: Vec<(FirstOfClass, Arc<Look>)>) {
        news.sort_unstable_by_key(|(first, _)| *first);
        for (first, look) in &news {
            self.distinct.note_seen(*first, Arc::clone(look));
            if self.job.plan.enough().is_some() {
                self.wide.note_seen(*first, Arc::clone(look));
            }
        }
        self.sightings = news;
    }

    fn has_enough(&self) -> bool {
        self.completed().is_some() || self.job.plan.solutions == Some(0)
    }

    /// The iteration that recorded the last solution asked for.
    fn completed(&self) -> Option<u64> {
        let wanted = usize::try_from(self.job.plan.solutions?).ok()?;
        self.distinct.firsts().get(wanted.checked_sub(1)?).map(|first| first.iteration)
    }

    fn progress(&self) -> Progress<'_> {
        let chains = self.workers.iter().map(|worker| (worker.counts(), worker.books.hits)).collect();
        let climbs = self.workers.iter().filter_map(Worker::climb).collect();
        let sightings = self.sightings.iter();
        let sightings = sightings.map(|(first, look)| Sighting { first: *first, look: Look::clone(look) }).collect();
        Progress { end_iteration: self.done, distinct: &self.distinct, sightings, chains, climbs }
    }
}

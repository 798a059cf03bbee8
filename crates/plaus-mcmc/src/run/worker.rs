//! One chain of a run, with its records and tallies.

use super::hunt::Hunt;
use super::{Plan, Pulse, Snapshot, Start};
use crate::adapt::Scales;
use crate::chain::{Chain, ChainError, Decision, MoveCounts};
use crate::look::Look;
use crate::moves::{Mixture, MoveId};
use crate::record::{Block, is_recorded};
use crate::replicas::{Climb, Course, Replicas, TopStep};
use crate::solutions::{Distinct, FirstOfClass, Hits};
use crate::target::{Goal, SolutionClass, Target};
use std::sync::Arc;

/// What all workers share.
pub(super) struct Job<'a, T: Target> {
    pub(super) target: &'a T,
    pub(super) moves: &'a Mixture<T>,
    pub(super) fresh: &'a Mixture<T>,
    pub(super) plan: Plan,
    /// The first of the chains that are run: the pulse counts from it.
    pub(super) first: u32,
}

impl<'a, T: Target> Job<'a, T> {
    fn course(&self) -> Course<'a, T> {
        Course { target: self.target, moves: self.moves, fresh: self.fresh, tempering: self.plan.tempering() }
    }

    /// Scales are adapted in the iterations before this one.
    fn adapts_until(&self) -> u64 {
        if self.plan.adapt { self.plan.warmup } else { 0 }
    }
}

/// One running chain.
pub(super) struct Worker<'a, T: Target> {
    replicas: Option<Replicas<'a, T>>,
    pub(super) books: Books,
}

/// The records and tallies of a chain.
#[derive(Clone)]
pub(super) struct Books {
    pub(super) index: u32,
    pub(super) hits: Hits,
    pub(super) distinct: Distinct,
    class: Option<SolutionClass>,
    pending: (u32, Option<MoveId>),
    pub(super) end_iteration: u64,
}

/// What a worker made in a round.
pub(super) struct Made<D, O> {
    pub(super) block: Block<D, O>,
    pub(super) firsts: Vec<(FirstOfClass, Arc<Look>)>,
    /// The failure that ended it early, if any.
    pub(super) failure: Option<ChainError>,
    /// Whether the run was stopped before it finished: then the worker can only be dropped.
    pub(super) is_cut: bool,
}

impl<'a, T: Goal> Worker<'a, T> {
    pub(super) fn new(index: u32) -> Self {
        let (hits, distinct) = (Hits::default(), Distinct::apart(1.0));
        let books = Books { index, hits, distinct, class: None, pending: (0, None), end_iteration: 0 };
        Self { replicas: None, books }
    }

    pub(super) fn resume(job: &Job<'a, T>, index: u32, start: Start<T::Draw, T::Outcome>) -> Self {
        let Start { snapshot, distinct } = start;
        let Snapshot { end_iteration, state, counts, scales, failures, hits, pending, replicas } = snapshot;
        let class = job.target.class(state.by_ref());
        let (course, seed, iteration) = (job.course(), job.plan.seed, end_iteration - 1);
        let replicas = match replicas {
            Some(snapshot) => Replicas::resume(course, seed, index, iteration, snapshot),
            None => Replicas::resume_one(course, seed, index, iteration, state, (counts, scales, failures)),
        };
        Self { replicas: Some(replicas), books: Books { index, hits, distinct, class, pending, end_iteration } }
    }

    /// Advances until iterations `0 .. end` are done, or the hunt ends, or an iteration fails.
    pub(super) fn advance(&mut self, job: &Job<'a, T>, end: u64, hunt: &Hunt<'_>) -> Made<T::Draw, T::Outcome> {
        let mut made = Made {
            block: Block::starting_at(self.books.end_iteration),
            firsts: Vec::new(),
            failure: None,
            is_cut: false,
        };
        match self.try_advance(job, end, hunt, &mut made) {
            Err(error) if error.is_interruption() => made.is_cut = true,
            ended => made.failure = ended.err(),
        }
        made.block.end_iteration = self.books.end_iteration;
        made
    }

    fn try_advance(
        &mut self,
        job: &Job<'a, T>,
        end: u64,
        hunt: &Hunt<'_>,
        made: &mut Made<T::Draw, T::Outcome>,
    ) -> Result<(), ChainError> {
        let (Self { replicas, books }, plan) = (self, &job.plan);
        let goes_on = || !hunt.pulse.is_stopped();
        if !goes_on() {
            // If there are many chains, some may not even have started.
            made.is_cut = true;
            return Ok(());
        }
        if replicas.is_none() && end > 0 {
            let (started, until) = (Replicas::start(job.course(), job.plan.seed, books.index)?, job.adapts_until());
            let started = if plan.weigh { started.weighing(until) } else { started.adapting(until) };
            books.class = job.target.class(started.top().state().by_ref());
            books.note::<T>(job, 0, started.top(), made, hunt);
            *replicas = Some(started);
        }
        let Some(replicas) = replicas else { return Ok(()) };
        // Replicas wait for each other only when they swap.
        let stride = if plan.rungs > 1 { plan.swap_every } else { 1 };
        while books.end_iteration < end && hunt.goes_on(books.end_iteration) {
            if plan.settle && books.end_iteration < plan.warmup && settled(replicas, books, plan.warmup) {
                replicas.rest_until(books.end_iteration);
                books.note::<T>(job, books.end_iteration, replicas.top(), made, hunt);
                continue;
            }
            if plan.climbs > 0 {
                replicas.press(if books.end_iteration < plan.climbs { Plan::PRESS } else { 1.0 });
            }
            if books.end_iteration < plan.climbs {
                // A solution stays until it is recorded.
                let is_recorded = is_recorded(books.end_iteration - 1, plan.thin);
                let rests = books.class.is_some() && !is_recorded;
                if rests || (is_recorded && (books.class.is_some() || plan.cuts_climb(books.end_iteration))) {
                    if rests {
                        replicas.rest_until(books.end_iteration);
                    } else if replicas.begin_anew()? {
                        books.class = job.target.class(replicas.top().state().by_ref());
                        books.pending = (books.pending.0.saturating_add(1), None);
                    }
                    books.note::<T>(job, books.end_iteration, replicas.top(), made, hunt);
                    continue;
                }
            }
            let now = replicas.iteration();
            let next = (now / stride + 1).saturating_mul(stride).min(end - 1);
            let went_on = replicas.advance_while(next, goes_on, |chain, step| match step {
                TopStep::Swapped => {
                    books.class = job.target.class(chain.state().by_ref());
                    books.pending = (books.pending.0.saturating_add(1), None);
                }
                TopStep::Step(step) => {
                    if step.decision == Decision::Accepted {
                        books.class = job.target.class(chain.state().by_ref());
                        books.pending = (books.pending.0.saturating_add(1), Some(step.move_id));
                    }
                    books.note::<T>(job, books.end_iteration, chain, made, hunt);
                }
            })?;
            if !went_on {
                made.is_cut = true;
                return Ok(());
            }
        }
        Ok(())
    }

    /// Shows its progress.
    pub(super) fn show(&self, job: &Job<'a, T>, pulse: &Pulse) {
        pulse.set_chain(self.books.index - job.first, self.books.end_iteration, self.books.hits.count);
    }

    pub(super) fn counts(&self) -> &[MoveCounts] {
        self.replicas.as_ref().map_or(&[], |replicas| replicas.top().counts())
    }

    /// Where the replicas are, if there are more than one.
    pub(super) fn climb(&self) -> Option<&Climb> {
        self.replicas.as_ref().map(Replicas::climb).filter(|climb| climb.ladder().betas().len() > 1)
    }

    pub(super) fn snapshot(&self) -> Option<Snapshot<T::Draw, T::Outcome>> {
        let replicas = self.replicas.as_ref()?;
        let Books { hits, pending, end_iteration, .. } = self.books;
        Some(Snapshot {
            end_iteration,
            state: replicas.top().state().clone(),
            counts: replicas.top().counts().to_vec(),
            scales: replicas.top().scales().cloned(),
            failures: replicas.failures(),
            hits,
            pending,
            replicas: self.climb().map(|_| replicas.snapshot()),
        })
    }
}

/// Whether nothing is adapted any more, although the warm-up, of at most `longest` iterations, lasts. Ends the
/// adaptation if that is due.
fn settled<T: Target>(replicas: &mut Replicas<'_, T>, books: &Books, longest: u64) -> bool {
    let Some(scales) = replicas.top().scales() else { return false };
    let is_solved = || books.hits.first.is_some_and(|first| first < books.end_iteration / 2);
    if !scales.are_frozen() && replicas.may_end(longest) && is_solved() && replicas.have_settled() {
        replicas.freeze();
    }
    replicas.top().scales().is_some_and(Scales::are_frozen)
}

impl Books {
    /// Records the chain's state as that of `iteration`.
    #[inline]
    fn note<T: Goal>(
        &mut self,
        job: &Job<'_, T>,
        iteration: u64,
        chain: &Chain<'_, T>,
        made: &mut Made<T::Draw, T::Outcome>,
        hunt: &Hunt<'_>,
    ) {
        let plan = &job.plan;
        self.end_iteration = iteration + 1;
        self.hits.count(iteration, self.class.is_some());
        hunt.pulse.set_chain(self.index - job.first, self.end_iteration, self.hits.count);
        if !is_recorded(iteration, plan.thin) {
            return;
        }
        let (accepted, by) = std::mem::take(&mut self.pending);
        // A solution that is already there when counting begins counts too.
        let counts = iteration >= plan.counts_from();
        let is_first = counts && iteration - plan.counts_from() < plan.thin;
        let fresh = accepted > 0 || made.block.entries.is_empty() || is_first;
        made.block.push(accepted, by, self.class, chain.state());
        if let (true, Some(class)) = (fresh && counts, self.class) {
            let first = FirstOfClass { iteration, chain: self.index, class };
            let look = plan.enough().map(|_| || job.target.look(chain.state().by_ref()));
            if let Some(look) = self.distinct.note_with(first, look) {
                hunt.note(first, &look);
                made.firsts.push((first, look));
            }
        }
    }
}

//! Parallel tempering: chains between the prior and the target exchange places. So the target's chain is restarted from
//! fresh draws again and again, and remains exact.
//!
//! Rung 0 samples the prior (restricted to what the constraint allows) by drawing anew. The last rung samples the
//! target, and those in between `p_w p_c^β`. At regular intervals neighbours swap with probability
//! `min(1, exp((β_b − β_a)(log p_c(x_a) − log p_c(x_b))))`, which leaves the product of all rungs invariant. Pairs
//! (0,1), (2,3), … alternate with (1,2), (3,4), …. So a replica keeps its direction until a swap is rejected, and its
//! trip takes a time proportional to the number of rungs, not to its square (Okabe et al. 2001; Syed et al. 2022, see
//! [`Ladder::barrier`](crate::Ladder::barrier)). During the warm-up the ladder is spaced again a few times, from the
//! rejections so far, and if asked for gets as many rungs as the barrier calls for; then it stays, as exactness
//! requires.

mod climb;
mod resize;

pub use climb::{Climb, RungStatistics, Tempering};

use crate::adapt::Scales;
use crate::chain::{Chain, ChainError, MoveCounts, Step};
use crate::failures::Failures;
use crate::moves::Mixture;
use crate::parallel::{self, lock};
use crate::target::{State, StateOf, Target};
use plaus_dist::{ChainStreams, Purpose, Seed, math, open_unit};
use serde::{Deserialize, Serialize};
use std::sync::Mutex;

/// Replicas between two iterations: everything that determines their future.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ReplicasSnapshot<D, O> {
    /// Each replica's state.
    pub states: Vec<State<D, O>>,
    /// How often each move ended in each way, for each rung: the redraw at the first, the target's moves at the others.
    pub counts: Vec<Vec<MoveCounts>>,
    /// The scales of each rung's moves, if it adapts any.
    pub scales: Vec<Option<Scales>>,
    /// How many draws they simulated, and which of them failed.
    pub failures: Failures,
    climb: Climb,
}

impl<D, O> ReplicasSnapshot<D, O> {
    /// Where they are on the ladder, and which swaps they made.
    #[must_use]
    pub fn climb(&self) -> &Climb {
        &self.climb
    }

    /// The same with other states, one for one.
    ///
    /// # Errors
    ///
    /// Those of `look`.
    pub fn try_map<P, E>(
        self,
        look: impl FnMut(State<D, O>) -> Result<State<D, P>, E>,
    ) -> Result<ReplicasSnapshot<D, P>, E> {
        let Self { states, counts, scales, failures, climb } = self;
        let states = states.into_iter().map(look).collect::<Result<_, _>>()?;
        Ok(ReplicasSnapshot { states, counts, scales, failures, climb })
    }

    /// Whether all its parts are for `rungs` rungs, with this many moves at all but the first.
    #[must_use]
    pub fn fits(&self, rungs: u32, moves: usize) -> bool {
        let (count, climb) = (rungs as usize, &self.climb);
        let mut at = climb.at.clone();
        at.sort_unstable();
        let (counted, scaled) = (self.counts.len(), self.scales.len());
        let lengths = [self.states.len(), counted, scaled, climb.ladder.betas().len(), climb.last.len()];
        let moves_of = |rung: usize| if rung == 0 { 1 } else { moves };
        lengths.iter().all(|&length| length == count)
            && at.into_iter().eq(0..rungs)
            && climb.statistics.len() + 1 == count
            && self.counts.iter().enumerate().all(|(rung, counts)| counts.len() == moves_of(rung))
    }
}

/// The settings of replicas: the target with its moves, and those of the first rung.
pub struct Course<'a, T: Target> {
    /// What the last rung samples.
    pub target: &'a T,
    /// Moves of all rungs but the first.
    pub moves: &'a Mixture<T>,
    /// Moves of the first rung. They should draw anew, so that a state that comes from there is independent of the one
    /// that went there.
    pub fresh: &'a Mixture<T>,
    /// Rungs and swaps.
    pub tempering: Tempering,
}

impl<T: Target> Clone for Course<'_, T> {
    fn clone(&self) -> Self {
        *self
    }
}
impl<T: Target> Copy for Course<'_, T> {}

impl<'a, T: Target> Course<'a, T> {
    fn moves_of(&self, rung: usize) -> &'a Mixture<T> {
        if rung == 0 && self.tempering.rungs > 1 { self.fresh } else { self.moves }
    }
}

/// Replicas: at any time one at each rung, all at the same iteration.
pub struct Replicas<'a, T: Target> {
    course: Course<'a, T>,
    /// Each replica keeps its place in this list, whatever its rung.
    chains: Vec<Chain<'a, T>>,
    climb: Climb,
    /// Failures before these chains were made; they count on from there.
    before: Failures,
    seed: Seed,
    chain: u32,
}

/// What the chain at the last rung did.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TopStep {
    /// An iteration.
    Step(Step),
    /// Its state was exchanged with the rung below, before the next iteration.
    Swapped,
}

/// Streams of a replica: replica 0 has those of a chain that is not tempered.
fn streams(seed: Seed, chain: u32, replica: usize) -> ChainStreams {
    seed.chain(u64::from(chain) | (replica as u64) << 32)
}

/// Makes this many steps of a chain, unless `goes_on` returns false before one of them; returns whether all were made.
fn stride<'a, T: Target>(
    chain: &mut Chain<'a, T>,
    steps: u64,
    goes_on: &impl Fn() -> bool,
    mut watch: impl FnMut(&Chain<'a, T>, Step),
) -> Result<bool, ChainError> {
    for _ in 0..steps {
        if !goes_on() {
            return Ok(false);
        }
        let step = chain.step()?;
        watch(chain, step);
    }
    Ok(true)
}

impl<'a, T: Target> Replicas<'a, T> {
    /// One replica for each rung, from start draws of the target, with random numbers of chain `chain` of `seed`.
    ///
    /// # Errors
    /// [`ChainError`] if a chain cannot start.
    pub fn start(course: Course<'a, T>, seed: Seed, chain: u32) -> Result<Self, ChainError> {
        let climb = Climb::new(course.tempering.rungs.max(1));
        let betas = climb.ladder.betas();
        let chains = parallel::try_map(betas.len(), |replica| {
            let started = Chain::start(course.target, course.moves_of(replica), streams(seed, chain, replica))?;
            Ok(started.with_replica(replica).at(betas[replica]))
        })?;
        Ok(Self { course, chains, climb, before: Failures::default(), seed, chain })
    }

    /// The same replicas, adapting the scales of each rung's moves in the iterations before `until`, and keeping them
    /// from then on: see [`Chain::adapting`]. To be called on replicas that have just started.
    #[must_use]
    pub fn adapting(self, until: u64) -> Self {
        let chains = self.chains.into_iter().map(|chain| chain.adapting(until)).collect();
        Self { chains, ..self }
    }

    /// The same, each rung of which also learns how often to make each move: see [`Chain::weighing`].
    #[must_use]
    pub fn weighing(self, until: u64) -> Self {
        let chains = self.chains.into_iter().map(|chain| chain.weighing(until)).collect();
        Self { chains, ..self }
    }

    /// Whether a warm-up of at most `longest` iterations may end here, if [everything has
    /// settled](Replicas::have_settled).
    pub(crate) fn may_end(&self, longest: u64) -> bool {
        self.course.tempering.may_end(self.iteration(), longest)
    }

    /// Whether everything that they adapt has settled: each rung's scales and the ladder.
    pub(crate) fn have_settled(&self) -> bool {
        self.climb.has_settled(&self.course.tempering) && self.chains.iter().all(Chain::has_settled)
    }

    /// Ends the warm-up before its time.
    pub(crate) fn freeze(&mut self) {
        self.chains.iter_mut().for_each(Chain::freeze);
        if self.chains.len() > 1 {
            self.adapt_ladder(true);
        }
    }

    /// Sets how much the constraint of a chain that is not tempered counts.
    pub(crate) fn press(&mut self, beta: f64) {
        self.chains.iter_mut().for_each(|chain| chain.set_beta(beta));
    }

    /// Makes one iteration in which a chain that is not tempered begins anew, see [`Chain::begin_anew`].
    pub(crate) fn begin_anew(&mut self) -> Result<bool, ChainError> {
        self.chains.iter_mut().try_fold(true, |all, chain| Ok(all && chain.begin_anew()?))
    }

    /// Stand still up to this iteration.
    pub(crate) fn rest_until(&mut self, iteration: u64) {
        self.chains.iter_mut().for_each(|chain| chain.rest_until(iteration));
    }

    /// Replicas that continue from a snapshot made after iteration `iteration`, which must
    /// [fit](ReplicasSnapshot::fits).
    #[must_use]
    pub fn resume(
        course: Course<'a, T>,
        seed: Seed,
        chain: u32,
        iteration: u64,
        snapshot: ReplicasSnapshot<T::Draw, T::Outcome>,
    ) -> Self {
        let ReplicasSnapshot { states, counts, scales, failures, climb } = snapshot;
        let mut rung_of = vec![0; states.len()];
        for (rung, &replica) in climb.at.iter().enumerate() {
            rung_of[replica as usize] = rung;
        }
        let resume = |(replica, state): (usize, StateOf<T>)| {
            let rung = rung_of[replica];
            let (moves, own) = (course.moves_of(rung), streams(seed, chain, replica));
            let resumed = Chain::resume(course.target, moves, own, iteration, state, counts[rung].clone());
            let resumed = resumed.with_replica(replica).at(climb.ladder.betas()[rung]);
            match &scales[rung] {
                Some(scales) => resumed.with_scales(scales.clone()),
                None => resumed,
            }
        };
        let chains = states.into_iter().enumerate().map(resume).collect();
        Self { course, chains, climb, before: failures, seed, chain }
    }

    /// A single replica, of the target, that continues.
    #[must_use]
    pub fn resume_one(
        course: Course<'a, T>,
        seed: Seed,
        chain: u32,
        iteration: u64,
        state: StateOf<T>,
        (counts, scales, failures): (Vec<MoveCounts>, Option<Scales>, Failures),
    ) -> Self {
        let (counts, scales) = (vec![counts], vec![scales]);
        let one = ReplicasSnapshot { states: vec![state], counts, scales, failures, climb: Climb::new(1) };
        Self::resume(course, seed, chain, iteration, one)
    }

    /// Everything that determines the replicas' future, together with [`Replicas::iteration`].
    #[must_use]
    pub fn snapshot(&self) -> ReplicasSnapshot<T::Draw, T::Outcome> {
        let rungs = || self.climb.at.iter().map(|&replica| &self.chains[replica as usize]);
        ReplicasSnapshot {
            states: self.chains.iter().map(|chain| chain.state().clone()).collect(),
            counts: rungs().map(|chain| chain.counts().to_vec()).collect(),
            scales: rungs().map(|chain| chain.scales().cloned()).collect(),
            failures: self.failures(),
            climb: self.climb.clone(),
        }
    }

    /// Advances all replicas to `iteration`; reports to `watch` every step of the last rung's chain, and every swap
    /// that changes its state. Replicas run in parallel on the current pool of threads; the number of threads does not
    /// influence the result.
    ///
    /// # Errors
    /// [`ChainError`] if a replica fails.
    pub fn advance(
        &mut self,
        iteration: u64,
        watch: impl FnMut(&Chain<'a, T>, TopStep) + Send,
    ) -> Result<(), ChainError> {
        self.advance_while(iteration, || true, watch).map(drop)
    }

    /// Like [`Replicas::advance`], as long as `goes_on` returns true; it is called before every step. Returns whether
    /// it always did. If it did not, the replicas are at different iterations and can only be dropped.
    ///
    /// # Errors
    /// As [`Replicas::advance`].
    pub(crate) fn advance_while(
        &mut self,
        iteration: u64,
        goes_on: impl Fn() -> bool + Sync,
        mut watch: impl FnMut(&Chain<'a, T>, TopStep) + Send,
    ) -> Result<bool, ChainError> {
        let every = self.course.tempering.swap_every;
        while self.iteration() < iteration {
            let now = self.iteration();
            if self.chains.len() > 1 && now > 0 && now.is_multiple_of(every) {
                self.swap(now, &mut watch);
            }
            let next = if self.chains.len() > 1 { (now / every + 1).saturating_mul(every) } else { iteration };
            if !self.walk(next.min(iteration) - now, &goes_on, &mut watch)? {
                return Ok(false);
            }
        }
        Ok(true)
    }

    fn walk(
        &mut self,
        steps: u64,
        goes_on: &(impl Fn() -> bool + Sync),
        watch: &mut (impl FnMut(&Chain<'a, T>, TopStep) + Send),
    ) -> Result<bool, ChainError> {
        if let [only] = self.chains.as_mut_slice() {
            return stride(only, steps, goes_on, |chain, step| watch(chain, TopStep::Step(step)));
        }
        let (index, watch) = (self.top_replica(), Mutex::new(watch));
        let mut walked = parallel::map_mut(&mut self.chains, |replica, chain| {
            if replica != index {
                return stride(chain, steps, goes_on, |_, _| ());
            }
            let mut watch = lock(&watch);
            stride(chain, steps, goes_on, |chain, step| watch(chain, TopStep::Step(step)))
        });
        // The failure reported does not depend on which came first.
        let first = walked.remove(index);
        walked.into_iter().try_fold(first?, |all, one| Ok(all && one?))
    }

    /// Proposes the swaps due after iteration `now`, and adapts the ladder if that is due.
    fn swap(&mut self, now: u64, watch: &mut impl FnMut(&Chain<'a, T>, TopStep)) {
        let (tempering, climb) = (self.course.tempering, &mut self.climb);
        let mut stream = streams(self.seed, self.chain, 0).at(now, Purpose::SWAP);
        let parity = now / tempering.swap_every;
        let (top, betas) = (climb.at.len() - 1, climb.ladder.betas());
        for rung in (0..top).filter(|rung| (*rung as u64 + parity).is_multiple_of(2)) {
            let u = open_unit(&mut stream);
            let (low, high) = (climb.at[rung] as usize, climb.at[rung + 1] as usize);
            // Finite: anything that the constraint forbids is forbidden at every rung.
            let weights = [low, high].map(|replica| self.chains[replica].state().log_constraint.value());
            let alpha = math::exp(log_alpha([betas[rung], betas[rung + 1]], weights)).min(1.0);
            let seen = &mut climb.statistics[rung];
            seen.proposed += 1;
            seen.expected += alpha;
            if u < alpha {
                seen.swapped += 1;
                climb.at.swap(rung, rung + 1);
                if let Ok([a, b]) = self.chains.get_disjoint_mut([low, high]) {
                    Chain::exchange_rungs(a, b);
                }
                if rung + 1 == top {
                    watch(&self.chains[low], TopStep::Swapped);
                }
            }
        }
        climb.note_ends();
        if tempering.adapts_at(now) {
            let is_last = tempering.ends_at(now);
            if tempering.adapt_rungs && !is_last && self.resize() {
                return;
            }
            self.adapt_ladder(is_last);
        }
    }

    fn adapt_ladder(&mut self, is_last: bool) {
        let climb = &mut self.climb;
        climb.adapt(is_last);
        for (&replica, &beta) in climb.at.iter().zip(climb.ladder.betas()) {
            self.chains[replica as usize].set_beta(beta);
        }
    }

    fn top_replica(&self) -> usize {
        self.climb.at.last().map_or(0, |&replica| replica as usize)
    }

    /// The chain at the last rung.
    #[must_use]
    pub fn top(&self) -> &Chain<'a, T> {
        &self.chains[self.top_replica()]
    }

    /// The state at a rung.
    #[must_use]
    pub fn rung(&self, rung: usize) -> Option<&StateOf<T>> {
        self.climb.at.get(rung).map(|&replica| self.chains[replica as usize].state())
    }

    /// How often each move of a rung ended how; empty if there is no such rung.
    #[must_use]
    pub fn counts_of(&self, rung: usize) -> &[MoveCounts] {
        self.climb.at.get(rung).map_or(&[], |&replica| self.chains[replica as usize].counts())
    }

    /// How many draws all replicas simulated, and which of them failed.
    #[must_use]
    pub fn failures(&self) -> Failures {
        let mut all = self.before.clone();
        self.chains.iter().for_each(|chain| all.add(chain.failures()));
        all
    }

    /// Iterations made by every replica.
    #[must_use]
    pub fn iteration(&self) -> u64 {
        self.top().iteration()
    }

    /// Where the replicas are on the ladder, and which swaps they made.
    #[must_use]
    pub fn climb(&self) -> &Climb {
        &self.climb
    }
}

/// Log of the ratio with which a swap is accepted, for states with these log constraints (at β = 1) at these inverse
/// temperatures.
fn log_alpha(betas: [f64; 2], log_constraints: [f64; 2]) -> f64 {
    (betas[1] - betas[0]) * (log_constraints[0] - log_constraints[1])
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `π_a(x) π_b(y) α(x,y) = π_a(y) π_b(x) α(y,x)` with `π_β ∝ p_c^β`, for all pairs of weights and of rungs. The
    /// wrong sign is caught.
    #[test]
    fn swaps_balance_in_detail() {
        let weights = [0.0, 1.0, 2.5, 7.0];
        let unbalance = |sign: f64| {
            let mut worst = 0.0_f64;
            for betas in [[0.0, 1.0], [0.0, 0.3], [0.3, 0.31], [0.5, 1.0]] {
                for x in weights {
                    for y in weights {
                        let flow = |x: f64, y: f64| {
                            let alpha = math::exp(sign * log_alpha(betas, [x, y])).min(1.0);
                            math::exp(betas[0] * x + betas[1] * y - 7.0) * alpha
                        };
                        worst = worst.max((flow(x, y) - flow(y, x)).abs());
                    }
                }
            }
            worst
        };
        assert!(unbalance(1.0) < 1e-12, "{}", unbalance(1.0));
        assert!(unbalance(-1.0) > 0.1);
    }
}

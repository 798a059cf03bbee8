//! Changes the number of rungs in the warm-up, to suit the barrier.

use super::{Climb, Replicas, ReplicasSnapshot, RungStatistics};
use crate::ladder::Ladder;
use crate::target::{State, Target};

impl<T: Target> Replicas<'_, T> {
    /// Changes the number of rungs to suit the barrier seen so far, if enough swaps were proposed; returns whether that
    /// changed anything. Only in the warm-up, because new rungs begin with states of their neighbours.
    pub(super) fn resize(&mut self) -> bool {
        let climb = &self.climb;
        if !climb.has_seen_enough() {
            return false;
        }
        let rungs = Ladder::best_rungs(Ladder::barrier(&climb.rejected()));
        if rungs == climb.at.len() {
            return false;
        }
        let resized = self.snapshot().resized(rungs);
        *self = Self::resume(self.course, self.seed, self.chain, self.iteration(), resized);
        true
    }
}

impl<D: Clone, O: Clone> ReplicasSnapshot<D, O> {
    /// The same on a ladder of `rungs` rungs, at least 2. Each rung but the first takes the state, counts and scales of
    /// the old rung at the same relative height; the first and the last keep their own.
    fn resized(self, rungs: usize) -> Self {
        let Self { states, counts, scales, failures, climb } = self;
        let (top, old_top) = (rungs - 1, climb.at.len() - 1);
        let old = |rung: usize| if rung == 0 { 0 } else { ((rung * old_top + top / 2) / top).max(1) };
        let old: Vec<usize> = (0..rungs).map(old).collect();
        let state = |&rung: &usize| -> State<D, O> { states[climb.at[rung] as usize].clone() };
        let fresh = Climb::new(rungs as u32);
        Self {
            states: old.iter().map(state).collect(),
            counts: old.iter().map(|&rung| counts[rung].clone()).collect(),
            scales: old.iter().map(|&rung| scales[rung].clone()).collect(),
            failures,
            climb: Climb {
                ladder: climb.ladder.adapted(&climb.rejected(), rungs),
                statistics: vec![RungStatistics::default(); rungs - 1],
                barrier: Some(Ladder::barrier(&climb.rejected())),
                ..fresh
            },
        }
    }
}

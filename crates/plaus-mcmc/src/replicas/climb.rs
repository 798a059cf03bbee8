//! Where replicas are on the ladder, which swaps they made, and when the ladder is spaced again.

use crate::adapt::may_end;
use crate::ladder::Ladder;
use serde::{Deserialize, Serialize};

/// The ladder is adapted this many times: at the end of the warm-up, at half of it, at a quarter, and so on.
const ADAPTATIONS: u32 = 5;
/// Swaps that every pair must have proposed before rejections mean anything.
const ENOUGH: u64 = 4;
/// The ladder has settled if its barrier differs by no more than this part of itself, or of 1, from that before it was
/// last adapted; the best number of rungs then changes by as much.
const NEAR: f64 = 0.2;

/// Settings of tempering.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct Tempering {
    /// Rungs of the ladder, at least 1; 1 is the target alone.
    pub rungs: u32,
    /// Iterations between two swaps; at least 1.
    pub swap_every: u64,
    /// Iterations in which the ladder is adapted.
    pub warmup: u64,
    /// Whether the number of rungs is adapted too; `rungs`, at least 2, is then the number to begin with.
    pub adapt_rungs: bool,
}

impl Tempering {
    /// None: one chain, of the target.
    pub const NONE: Self = Self { rungs: 1, swap_every: u64::MAX, warmup: 0, adapt_rungs: false };

    /// Whether the ladder is adapted before the iteration after this one.
    pub(super) fn adapts_at(&self, iteration: u64) -> bool {
        (0..ADAPTATIONS).any(|k| (self.warmup >> k) / self.swap_every * self.swap_every == iteration)
    }

    /// Whether a warm-up of at most `longest` iterations may end after this one: the last before a look at which
    /// replicas wait for a swap, so that the ladder's statistics are still those since it was last adapted.
    pub(super) fn may_end(&self, iteration: u64, longest: u64) -> bool {
        let every = if self.rungs > 1 { self.swap_every } else { 1 };
        iteration.is_multiple_of(every) && (iteration + 1..=iteration + every).any(|done| may_end(longest, done))
    }

    /// Whether that is the last adaptation.
    pub(super) fn ends_at(&self, iteration: u64) -> bool {
        self.warmup / self.swap_every * self.swap_every == iteration
    }
}

/// Statistics of the swaps between a rung and the next, since the ladder was last changed.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct RungStatistics {
    /// Swaps proposed.
    pub proposed: u64,
    /// Number of swaps made.
    pub swapped: u64,
    /// Sum of the probabilities with which they were accepted: equal to that number on average, and less noisy.
    pub expected: f64,
}

/// Which end of the ladder a replica has visited last.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub(super) enum Last {
    Neither,
    Prior,
    Target,
}

/// Where the replicas are on the ladder, and which swaps they made.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Climb {
    pub(super) ladder: Ladder,
    /// The replica at each rung.
    pub(super) at: Vec<u32>,
    /// For each replica.
    pub(super) last: Vec<Last>,
    pub(super) statistics: Vec<RungStatistics>,
    pub(super) restarts: u64,
    pub(super) round_trips: u64,
    /// The barrier when the ladder was last adapted.
    pub(super) barrier: Option<f64>,
}

impl Climb {
    pub(super) fn new(rungs: u32) -> Self {
        let ladder = if rungs > 1 { Ladder::even(rungs as usize) } else { Ladder::single() };
        Self {
            ladder,
            at: (0..rungs).collect(),
            last: vec![Last::Neither; rungs as usize],
            statistics: vec![RungStatistics::default(); rungs as usize - 1],
            restarts: 0,
            round_trips: 0,
            barrier: None,
        }
    }

    /// The inverse temperatures.
    #[must_use]
    pub fn ladder(&self) -> &Ladder {
        &self.ladder
    }

    /// How often a replica arrived at the last rung after it had been at the first since its previous arrival. Each
    /// such arrival brings a state that is independent of the states that the target's chain got from that replica
    /// before. First arrivals count too. Counted since the end of the warm-up.
    #[must_use]
    pub fn restarts(&self) -> u64 {
        self.restarts
    }

    /// How often a replica arrived at the first rung from the last, since the end of the warm-up.
    #[must_use]
    pub fn round_trips(&self) -> u64 {
        self.round_trips
    }

    /// Swaps between each rung and the next, since the ladder was adapted last.
    #[must_use]
    pub fn statistics(&self) -> &[RungStatistics] {
        &self.statistics
    }

    /// Share of swaps rejected between each rung and the next, on average; 0 if none was proposed.
    #[must_use]
    pub fn rejected(&self) -> Vec<f64> {
        let share = |one: &RungStatistics| 1.0 - one.expected / one.proposed as f64;
        self.statistics.iter().map(|one| if one.proposed == 0 { 0.0 } else { share(one).max(0.0) }).collect()
    }

    /// Whether every pair has proposed enough swaps for rejections to mean something.
    pub(super) fn has_seen_enough(&self) -> bool {
        self.statistics.iter().all(|seen| seen.proposed >= ENOUGH)
    }

    /// Whether the ladder would hardly change if it were adapted; true if there is none.
    pub(super) fn has_settled(&self, tempering: &Tempering) -> bool {
        let (rungs, now) = (self.at.len(), Ladder::barrier(&self.rejected()));
        let is_near = self.barrier.is_some_and(|before| (now - before).abs() <= NEAR * now.max(1.0));
        let has_size = !tempering.adapt_rungs || Ladder::best_rungs(now).abs_diff(rungs) <= 1;
        rungs == 1 || (self.has_seen_enough() && is_near && has_size)
    }

    /// Spaces the ladder again by its rejections, if enough swaps were proposed. With `last`, restarts, round trips and
    /// swaps are counted from now on.
    pub(super) fn adapt(&mut self, last: bool) {
        if self.has_seen_enough() {
            let rejected = self.rejected();
            self.barrier = Some(Ladder::barrier(&rejected));
            self.ladder = self.ladder.adapted(&rejected, self.at.len());
            self.statistics.fill(RungStatistics::default());
        }
        if last {
            (self.restarts, self.round_trips) = (0, 0);
            self.statistics.fill(RungStatistics::default());
        }
    }

    /// Notes which replicas are at the ends after a swap.
    pub(super) fn note_ends(&mut self) {
        let (Some(&bottom), Some(&top)) = (self.at.first(), self.at.last()) else { return };
        let (bottom, top) = (bottom as usize, top as usize);
        if self.last[bottom] == Last::Target {
            self.round_trips += 1;
        }
        self.last[bottom] = Last::Prior;
        if self.last[top] == Last::Prior {
            self.restarts += 1;
        }
        self.last[top] = Last::Target;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_ladder_is_adapted_in_the_warm_up_only() {
        let tempering = Tempering { rungs: 4, swap_every: 20, warmup: 1010, adapt_rungs: false };
        let when: Vec<u64> = (1..5000).filter(|&iteration| tempering.adapts_at(iteration)).collect();
        assert_eq!(when, [60, 120, 240, 500, 1000]);
        assert!(tempering.ends_at(1000) && !tempering.ends_at(500));
        // A warm-up may end just before four of these.
        let ends: Vec<u64> = (1..5000).filter(|&iteration| tempering.may_end(iteration, 1010)).collect();
        assert_eq!(ends, [60, 120, 240, 500]);
        let ends: Vec<u64> = (1..5000).filter(|&iteration| Tempering::NONE.may_end(iteration, 1600)).collect();
        assert_eq!(ends, [99, 199, 399, 799]);
        assert!(!(1..100).any(|iteration| Tempering { warmup: 0, ..tempering }.adapts_at(iteration)));
    }
}

//! Weights of moves, learnt in a chain's warm-up from what each move gains for its work, and kept from then on.
//!
//! A state has numbers. For each of them, a move's gain is the mean square of its jumps over the number's variance; a
//! proposal that was not accepted counts as a jump of 0. A move's cost is the simulator's work, counted in events, plus
//! one for the iteration. Half the mean gain of an iteration is one minus the number's autocorrelation at lag one. A
//! chain is only as good as the number that mixes worst. So the shares of the work are chosen that bring the largest
//! gain to the number that gains least. That is a game of moves against numbers, solved by fictitious play (Robinson,
//! "An iterative method of solving a game", Annals of Mathematics 54, 1951). Squared jumps as a measure: Pasarica and
//! Gelman, "Adaptively scaling the Metropolis algorithm using expected squared jumped distance", Statistica Sinica 20,
//! 2010.
//!
//! Few iterations are trusted little. After n iterations with m moves, only `¾ n / (n + 50 m)` of the work, at most
//! three quarters, is shared out anew; the rest stays with the configured shares. So variables that affect no number,
//! such as a table's bumps, are still moved. A move that was tried 64 times and never accepted keeps a
//! hundredth of its share, so states that only it reaches are still reached.
//!
//! No clock is used: weights follow from target, moves, seed and chain.

use crate::moves::{Mixture, MoveId};
use crate::target::Target;
use plaus_dist::math;
use serde::{Deserialize, Serialize};

/// A move counts as never accepted after this many tries without success. A move that is accepted once in fourteen
/// proposals is given up by mistake in about one case in a hundred, and even then not wholly.
pub(crate) const ENOUGH: u64 = 64;
/// The part of its share that such a move keeps.
const LEFT: f64 = 0.01;
/// Iterations per move after which half of [`MOST`] is shared out anew.
const HALF: f64 = 50.0;
/// Largest part of the work that is shared out anew.
const MOST: f64 = 0.75;
/// With fewer tries, nothing is known of a move's gain.
const FEW: u64 = 4;
/// Work is counted in one of this many iterations, because counting needs another simulation.
const EVERY: u64 = 4;
/// Learnt weights have settled if those of the half before choose another move in at most this share of the iterations.
const NEAR: f64 = 0.1;
/// Rounds of fictitious play; after them the game's value is known to about a percent.
const ROUNDS: usize = 4000;

/// Observations of one move.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
struct Seen {
    tried: u64,
    accepted: u64,
    /// Number of iterations whose work was counted, and their work.
    counted: u64,
    work: u64,
    /// For each number, the sum of the move's squared jumps.
    jumps: Vec<f64>,
}

/// What a chain has learnt about its moves' weights.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Weighing {
    seen: Vec<Seen>,
    /// Number of states seen; for each number, its mean and the sum of squares about it.
    states: u64,
    means: Vec<f64>,
    squares: Vec<f64>,
    /// The numbers of the state seen last; empty if the chain was given another state since.
    last: Vec<f64>,
    /// For each move, the probability of choosing it or one before it; empty before they are learnt.
    cumulative: Vec<f64>,
    /// What they would have been at the last look; empty if it was the first.
    before: Vec<f64>,
}

impl Weighing {
    pub(crate) fn start<T: Target>(moves: &Mixture<T>) -> Self {
        let seen = vec![Seen::default(); moves.iter().count()];
        Self { seen, ..Self::empty() }
    }

    /// The learnt probability of each move; `None` before they are learnt.
    #[must_use]
    pub fn probabilities(&self) -> Option<Vec<f64>> {
        let before = std::iter::once(&0.0).chain(&self.cumulative);
        let of = || self.cumulative.iter().zip(before).map(|(upto, before)| upto - before).collect();
        (!self.cumulative.is_empty()).then(of)
    }

    /// The same, cumulatively.
    pub(crate) fn cumulative(&self) -> Option<&[f64]> {
        (!self.cumulative.is_empty()).then_some(self.cumulative.as_slice())
    }

    /// Whether these weights are for this many moves.
    pub(crate) fn fits(&self, moves: usize) -> bool {
        self.seen.len() == moves && [0, moves].contains(&self.cumulative.len())
    }

    /// Whether the work of an iteration is counted.
    pub(crate) fn counts_work(iteration: u64) -> bool {
        iteration.is_multiple_of(EVERY)
    }

    /// The chain was given another state, not by a move.
    pub(crate) fn forget_state(&mut self) {
        self.last.clear();
    }

    /// Notes the result of an iteration, with its work if that was counted. `numbers` are those of the state that it
    /// led to, or `None` if the state is still the one before.
    pub(crate) fn note(&mut self, id: MoveId, accepted: bool, work: Option<u64>, numbers: Option<Vec<f64>>) {
        let seen = &mut self.seen[usize::from(id.0)];
        seen.tried += 1;
        seen.accepted += u64::from(accepted);
        if let Some(work) = work {
            seen.counted += 1;
            seen.work += work;
        }
        if let Some(numbers) = numbers {
            if accepted && !self.last.is_empty() {
                seen.jumps.resize(numbers.len(), 0.0);
                let jumps = numbers.iter().zip(&self.last).map(|(new, old)| math::square(new - old));
                seen.jumps.iter_mut().zip(jumps).for_each(|(sum, jump)| *sum += jump);
            }
            self.last = numbers;
        }
        self.states += 1;
        self.means.resize(self.last.len(), 0.0);
        self.squares.resize(self.last.len(), 0.0);
        for ((mean, squares), x) in self.means.iter_mut().zip(&mut self.squares).zip(&self.last) {
            let off = x - *mean;
            *mean += off / self.states as f64;
            *squares += off * (x - *mean);
        }
    }

    /// Whether the numbers of the present state are needed even if the state has not changed.
    pub(crate) fn is_blind(&self) -> bool {
        self.last.is_empty()
    }

    /// Forgets what was noted, and compares with what follows from it from now on.
    pub(crate) fn turn(&mut self, configured: &[f64]) {
        let before = if self.states > 0 { self.learnt(configured) } else { Vec::new() };
        let (seen, last) = (vec![Seen::default(); self.seen.len()], std::mem::take(&mut self.last));
        *self = Self { seen, last, before, ..Self::empty() };
    }

    /// Whether the weights that follow from what was noted since the last look are nearly those from before.
    pub(crate) fn has_settled(&self, configured: &[f64]) -> bool {
        let distance = |now: &[f64]| {
            let apart = now.iter().zip(&self.before).map(|(now, before)| (now - before).abs());
            apart.sum::<f64>() / 2.0
        };
        self.states > 0 && self.before.len() == self.seen.len() && distance(&self.learnt(configured)) <= NEAR
    }

    /// Learns the weights from everything noted since the last look. `configured` holds the moves' probabilities.
    pub(crate) fn freeze(&mut self, configured: &[f64]) {
        let mut upto = 0.0;
        self.cumulative = self.learnt(configured).iter().map(|weight| (upto += weight, upto).1).collect();
        if let Some(last) = self.cumulative.last_mut() {
            *last = 1.0;
        }
        let seen = vec![Seen::default(); self.seen.len()];
        *self = Self { seen, cumulative: std::mem::take(&mut self.cumulative), ..Self::empty() };
    }

    /// The moves' probabilities that follow from everything noted.
    fn learnt(&self, configured: &[f64]) -> Vec<f64> {
        let costs = self.costs();
        let total: f64 = configured.iter().zip(&costs).map(|(p, cost)| p * cost).sum();
        let mut shares: Vec<f64> = configured.iter().zip(&costs).map(|(p, cost)| p * cost / total).collect();
        if let Some(best) = best_shares(&self.gains(&costs)) {
            let (n, m) = (self.states as f64, self.seen.len() as f64);
            let believed = MOST * n / (n + HALF * m);
            shares.iter_mut().zip(best).for_each(|(share, best)| *share = (1.0 - believed) * *share + believed * best);
        }
        for (share, seen) in shares.iter_mut().zip(&self.seen) {
            *share *= if seen.tried >= ENOUGH && seen.accepted == 0 { LEFT } else { 1.0 };
        }
        let weights: Vec<f64> = shares.iter().zip(&costs).map(|(share, cost)| share / cost).collect();
        let sum: f64 = weights.iter().sum();
        weights.iter().map(|weight| weight / sum).collect()
    }

    fn empty() -> Self {
        let [means, squares, last, cumulative, before] = [(); 5].map(|()| Vec::new());
        Self { seen: Vec::new(), states: 0, means, squares, last, cumulative, before }
    }

    /// Mean work of each move's iterations; if they were hardly counted, that of all moves.
    fn costs(&self) -> Vec<f64> {
        let [counted, work] =
            [|seen: &Seen| seen.counted, |seen: &Seen| seen.work].map(|of| self.seen.iter().map(of).sum::<u64>());
        let mean = |counted: u64, work: u64| 1.0 + work as f64 / counted.max(1) as f64;
        let all = mean(counted, work);
        self.seen.iter().map(|seen| if seen.counted < FEW { all } else { mean(seen.counted, seen.work) }).collect()
    }

    /// For each move, its gain for each number, divided by its cost. Numbers that never vary or are not finite are left
    /// out.
    fn gains(&self, costs: &[f64]) -> Vec<Vec<f64>> {
        let varies = |&k: &usize| self.squares[k].is_finite() && self.squares[k] > 0.0;
        let numbers: Vec<usize> = (0..self.squares.len()).filter(varies).collect();
        let gain = |(seen, cost): (&Seen, &f64)| {
            let brought = |&k: &usize| {
                let jump = seen.jumps.get(k).copied().unwrap_or(0.0) / (self.squares[k] / self.states as f64);
                if seen.tried < FEW { 0.0 } else { jump / (seen.tried as f64 * cost) }
            };
            numbers.iter().map(brought).collect()
        };
        self.seen.iter().zip(costs).map(gain).collect()
    }
}

/// Shares of the work that bring the largest gain to the number that gains least. `gains` lists, for each move, its
/// gain for each number. `None` if some number gains from no move, or there is no number.
fn best_shares(gains: &[Vec<f64>]) -> Option<Vec<f64>> {
    let numbers = gains.first()?.len();
    let most = |k: usize| gains.iter().map(|gain| gain[k]).fold(0.0, f64::max);
    if numbers == 0 || !(0..numbers).all(|k| most(k) > 0.0) {
        return None;
    }
    let first = |values: &[f64], better: fn(f64, f64) -> bool| {
        (1..values.len()).fold(0, |best, k| if better(values[k], values[best]) { k } else { best })
    };
    // What the moves chosen so far have gained for each number; what each move would have gained for the numbers chosen
    // so far.
    let (mut brought, mut got, mut plays) = (vec![0.0; numbers], vec![0.0; gains.len()], vec![0.0; gains.len()]);
    for _ in 0..ROUNDS {
        let worst = first(&brought, |a, b| a < b);
        got.iter_mut().zip(gains).for_each(|(got, gain)| *got += gain[worst]);
        let best = first(&got, |a, b| a > b);
        plays[best] += 1.0 / ROUNDS as f64;
        brought.iter_mut().zip(&gains[best]).for_each(|(sum, gain)| *sum += gain);
    }
    Some(plays)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two moves serve one number each, one of them three times as fast: work in the ratio 1 to 3 serves both alike. A
    /// third move that serves both numbers, but less well than the mixture, is not chosen. One that serves both better
    /// is always chosen.
    #[test]
    fn shares_serve_the_worst_number_best() {
        let shares =
            |gains: &[[f64; 2]]| best_shares(&gains.iter().map(|gain| gain.to_vec()).collect::<Vec<_>>()).unwrap();
        let near = |found: &[f64], wanted: &[f64]| found.iter().zip(wanted).all(|(a, b)| (a - b).abs() < 0.05);
        let found = shares(&[[3.0, 0.0], [0.0, 1.0], [0.5, 0.5]]);
        assert!(near(&found, &[0.25, 0.75, 0.0]), "{found:?}");
        let found = shares(&[[3.0, 0.0], [0.0, 1.0], [0.9, 0.9]]);
        assert!(near(&found, &[0.0, 0.0, 1.0]), "{found:?}");
        assert_eq!(best_shares(&[vec![1.0, 0.0], vec![2.0, 0.0]]), None, "a number that nothing moves");
        assert_eq!(best_shares(&[vec![], vec![]]), None);
    }

    /// Weights settle if both halves tell the same of the moves, and not if the second tells the contrary.
    #[test]
    fn weights_settle_once_two_halves_agree() {
        let settled = |second: u16| {
            let mut weighing = Weighing { seen: vec![Seen::default(); 2], ..Weighing::empty() };
            let mut half = |good: u16| {
                weighing.turn(&[0.5, 0.5]);
                for k in 0..500 {
                    weighing.note(MoveId(good), true, Some(9), Some(vec![f64::from(k % 2)]));
                    weighing.note(MoveId(1 - good), k % 10 == 0, Some(9), None);
                }
                weighing.has_settled(&[0.5, 0.5])
            };
            [half(0), half(second)]
        };
        assert_eq!([settled(0), settled(1)], [[false, true], [false, false]]);
    }

    /// Of two equally good moves, the one that costs twice the work is chosen less often. A move that is never accepted
    /// is hardly ever chosen. Few iterations change little.
    #[test]
    fn work_and_failure_lower_weights() {
        let learnt = |rounds: u64| {
            let (seen, empty) = (vec![Seen::default(); 3], Weighing::empty());
            let mut weighing = Weighing { seen, ..empty };
            weighing.note(MoveId(0), false, None, Some(vec![0.0]));
            for k in 0..rounds {
                let x = if k % 2 == 0 { 1.0 } else { 0.0 };
                weighing.note(MoveId(0), true, Some(9), Some(vec![x]));
                weighing.note(MoveId(1), true, Some(19), Some(vec![1.0 - x]));
                weighing.note(MoveId(1), true, Some(19), Some(vec![x]));
                weighing.note(MoveId(2), false, Some(9), None);
            }
            weighing.freeze(&[0.25, 0.5, 0.25]);
            weighing.probabilities().unwrap()
        };
        let (few, many) = (learnt(4), learnt(1000));
        assert!((few[1] - 0.5).abs() < 0.06 && few[2] > 0.2, "{few:?}");
        assert!(many[0] > 2.0 * many[1] && many[2] < 0.01 && many[2] > 0.0, "{many:?}");
        assert!((many.iter().sum::<f64>() - 1.0).abs() < 1e-12);
    }
}

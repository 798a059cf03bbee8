//! Scales of moves: adapted in a chain's warm-up, then kept.
//!
//! A move with a step size can leave that size to the chain. It names its [`Scale`]s, and can be rebuilt with other
//! values. In the iterations before the sampling phase, each scale follows Robbins and Monro's stochastic approximation
//! of the equation *acceptance = target rate*, in its logarithm:
//!
//! `ln s ← ln s + γ_n (accepted − target)`, `γ_n = min(1, 4 n^(−2/3))`, where n counts the proposals made at that
//! scale.
//!
//! The decision, 0 or 1, stands for the probability of acceptance, of which it is an unbiased estimate. The probability
//! itself may be unknown, because a simulation stops early once it is certain to be rejected. When the sampling phase
//! begins, the scale becomes the mean of `ln s` over the proposals of the second half of the warm-up. This is as exact
//! as any estimate from these decisions (Polyak and Juditsky 1992). From then on it stays: what is recorded is a Markov
//! chain with a constant kernel, exact whatever the values of the scales. A chain that adapts for ever is not exact
//! unless the gain vanishes, and then only in the limit (Andrieu and Thoms, "A tutorial on adaptive MCMC", Statistics
//! and Computing 18, 2008).
//!
//! A move may also learn from the states that its chain visited, except in the first quarter of the warm-up: see
//! [`crate::fit`]. So may the mixture learn how often to make each move: see [`crate::weigh`]. What was learnt is then
//! kept in the same way.
//!
//! A warm-up may end before its longest time, at a look, if everything has settled since the look before:
//! see `Scales::have_settled`. This depends on the past alone, and what counts comes after it, so it is as exact.
//!
//! The scales are a function of target, moves, seed and chain; each chain has its own, and so has each rung of tempered
//! replicas.

use crate::fit::Learning;
use crate::moves::{Mixture, Move, MoveId, Path};
use crate::scale::Scale;
use crate::target::{StateRefOf, Target};
use crate::weigh::Weighing;
use plaus_dist::math;
use serde::{Deserialize, Serialize};

/// A scale must have been tried this often in the second half of the warm-up; otherwise its move stays as configured.
/// After this many tries the error of `ln s` is about 0.4, if the acceptance falls by 0.3 with each unit of `ln s`, as
/// it does for a Gaussian step on a Gaussian target.
pub(crate) const ENOUGH: u64 = 16;

/// A warm-up is looked at when a half of its longest time is over, a quarter, an eighth, and so on, this many times.
const LOOKS: u32 = 6;
/// It ends at the last this many of these looks, so not before a sixteenth of its longest time.
const ENDS: u32 = 4;
/// A scale has settled if its mean logarithm differs by no more than this from that of the half before. Half as much
/// again, or two thirds, costs a Gaussian step hardly a tenth of its speed (Roberts and Rosenthal, "Optimal scaling for
/// various Metropolis-Hastings algorithms", Statistical Science 16, 2001).
const NEAR: f64 = 0.4;
/// Moves that make less than this share of the iterations need not settle.
const RARE: f64 = 0.1;

/// Whether a warm-up of at most `longest` iterations is looked at when the iterations `0 .. done` are over. Each look
/// sees twice as many as the one before.
pub(crate) fn is_look(longest: u64, done: u64) -> bool {
    done > 0 && (1..=LOOKS).any(|half| longest >> half == done)
}

/// Whether it may end there.
pub(crate) fn may_end(longest: u64, done: u64) -> bool {
    is_look(longest, done) && done >= longest >> ENDS
}

/// The progress of one scale.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Adapted {
    /// The logarithm of the scale.
    log: f64,
    /// Number of proposals made with it, and of those accepted: since the warm-up, or during it while it lasts.
    tried: u64,
    accepted: u64,
    /// Sum of `log` over the proposals since the last look, and their number: over those of the second half of the
    /// warm-up, when it ends.
    sum: f64,
    summed: u64,
    /// The mean of `log` between the two looks before; `None` if it was hardly tried there.
    before: Option<f64>,
}

impl Adapted {
    /// Number of proposals made with this scale: since the warm-up, or during it while it lasts.
    #[must_use]
    pub fn tried(&self) -> u64 {
        self.tried
    }

    /// Number of those that were accepted.
    #[must_use]
    pub fn accepted(&self) -> u64 {
        self.accepted
    }

    fn is_known(&self) -> bool {
        self.summed >= ENOUGH
    }

    fn mean(&self) -> Option<f64> {
        self.is_known().then(|| self.sum / self.summed as f64)
    }

    fn has_settled(&self) -> bool {
        self.before.zip(self.mean()).is_some_and(|(before, now)| (now - before).abs() <= NEAR)
    }

    /// Begins to sum anew.
    fn turn(&mut self) {
        (self.before, self.sum, self.summed) = (self.mean(), 0.0, 0);
    }

    fn learn(&mut self, scale: &Scale, accepted: bool) {
        let n = math::cbrt(self.tried as f64);
        let gain = (4.0 / (n * n)).min(1.0);
        let miss = if accepted { 1.0 - scale.target } else { -scale.target };
        self.log = (self.log + gain * miss).clamp(math::ln(scale.least), math::ln(scale.most));
        self.sum += self.log;
        self.summed += 1;
    }

    fn freeze(&mut self) {
        self.log = self.mean().unwrap_or(self.log);
        (self.tried, self.accepted) = (0, 0);
    }
}

/// The scales of a chain's moves: the whole result of its adaptation.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Scales {
    /// The first iteration made with their final values; while they are adapted, the latest that this may be.
    until: u64,
    frozen: bool,
    /// For each move, its scales in order.
    of: Vec<Vec<Adapted>>,
    /// For each move, what it learns.
    learned: Vec<Option<Learning>>,
    /// The moves' weights, where they are learnt.
    weighing: Option<Weighing>,
}

impl Scales {
    /// The beginning of adaptation; `None` if no move has a scale or learns, and moves are not weighted.
    fn start<T: Target>(moves: &Mixture<T>, until: u64, weighs: bool) -> Option<Self> {
        let begin = |scale: Scale| Adapted {
            log: scale.log(scale.start),
            tried: 0,
            accepted: 0,
            sum: 0.0,
            summed: 0,
            before: None,
        };
        let of: Vec<Vec<Adapted>> =
            moves.iter().map(|(_, kernel)| kernel.scales().into_iter().map(begin).collect()).collect();
        let begin = |parts: Vec<usize>| (!parts.is_empty()).then(|| Learning::start(parts));
        let learned: Vec<Option<Learning>> = moves.iter().map(|(_, kernel)| begin(kernel.learns())).collect();
        let is_any = of.iter().any(|scales| !scales.is_empty()) || learned.iter().any(Option::is_some);
        // A single move needs no weight; the first rung of tempered replicas has only one.
        let weighing = (weighs && of.len() > 1).then(|| Weighing::start(moves));
        (is_any || weighing.is_some()).then_some(Self { until, frozen: false, of, learned, weighing })
    }

    /// The first iteration made with their final values; while they are adapted, the latest that this may be.
    #[must_use]
    pub fn until(&self) -> u64 {
        self.until
    }

    /// Whether everything has settled between the last two looks. A scale has if it is nearly the same, what a move
    /// learnt if it [describes](Learning::has_settled) the newest points hardly better, and learnt weights if they
    /// [differ](Weighing::has_settled) little. Moves that together make less than a tenth of the iterations do not
    /// matter. `done` is the number of iterations done.
    pub(crate) fn have_settled<T: Target>(&self, moves: &Mixture<T>, done: u64) -> bool {
        let since = (done / 2).max(1);
        let tried: u64 = self.of.iter().flatten().filter(|one| !one.has_settled()).map(|one| one.summed).sum();
        let weights = moves.iter().zip(&self.learned);
        let learning = |learned: &Option<Learning>| learned.as_ref().is_some_and(|one| !one.has_settled());
        let learning: f64 = weights.filter(|(_, learned)| learning(learned)).map(|((weight, _), _)| weight).sum();
        let weighed = self.weighing.as_ref().is_none_or(|weighing| weighing.has_settled(&configured(moves)));
        weighed && tried as f64 / since as f64 + learning < RARE
    }

    /// Compares with the present from now on.
    fn turn(&mut self, configured: impl FnOnce() -> Vec<f64>) {
        self.of.iter_mut().flatten().for_each(Adapted::turn);
        self.learned.iter_mut().flatten().for_each(Learning::turn);
        if let Some(weighing) = &mut self.weighing {
            weighing.turn(&configured());
        }
    }

    /// Whether the warm-up is over, so that they no longer change.
    #[must_use]
    pub fn are_frozen(&self) -> bool {
        self.frozen
    }

    /// The scales of a move; `None` for a scale that stays as configured, because it was hardly ever tried.
    #[must_use]
    pub fn values(&self, id: MoveId) -> Vec<Option<f64>> {
        let value = |one: &Adapted| (!self.frozen || one.is_known()).then(|| math::exp(one.log));
        self.adapted(id).iter().map(value).collect()
    }

    /// The progress of a move's scales.
    #[must_use]
    pub fn adapted(&self, id: MoveId) -> &[Adapted] {
        self.of.get(usize::from(id.0)).map_or(&[], Vec::as_slice)
    }

    /// What a move learns; `None` for one that learns nothing.
    #[must_use]
    pub fn learned(&self, id: MoveId) -> Option<&Learning> {
        self.learned.get(usize::from(id.0)).and_then(Option::as_ref)
    }

    /// The probabilities of the moves, where they were learnt and the warm-up is over.
    #[must_use]
    pub fn probabilities(&self) -> Option<Vec<f64>> {
        self.weighing.as_ref()?.probabilities()
    }

    /// Whether these scales belong to these moves.
    #[must_use]
    pub fn fit<T: Target>(&self, moves: &Mixture<T>) -> bool {
        let parts = |learned: &Option<Learning>| learned.as_ref().map_or(Vec::new(), |one| one.parts().to_vec());
        self.of.iter().map(Vec::len).eq(moves.iter().map(|(_, kernel)| kernel.scales().len()))
            && self.learned.iter().map(parts).eq(moves.iter().map(|(_, kernel)| kernel.learns()))
            && self.weighing.as_ref().is_none_or(|weighing| weighing.fits(self.of.len()))
    }
}

/// What a chain needs to adapt: its scales, and its moves at these scales.
pub(crate) struct Adaptation<T: Target> {
    declared: Vec<Vec<Scale>>,
    scales: Scales,
    remade: Vec<Option<Box<dyn Move<T>>>>,
}

impl<T: Target> Adaptation<T> {
    /// Adaptation in the iterations before `until`, from the start. `None` if there is nothing to adapt, or no
    /// iteration in which to do it.
    pub(crate) fn start(moves: &Mixture<T>, until: u64, weighs: bool) -> Option<Self> {
        // Iteration 0 is the start, which is not made by a move.
        let scales = (until > 1).then(|| Scales::start(moves, until, weighs)).flatten()?;
        Some(Self::resume(moves, scales))
    }

    /// Adaptation with scales that were adapted before; they must fit the moves.
    pub(crate) fn resume(moves: &Mixture<T>, scales: Scales) -> Self {
        let declared = moves.iter().map(|(_, kernel)| kernel.scales()).collect();
        let remade = (0..).zip(moves.iter()).map(|(id, (_, kernel))| remade(kernel, &scales, MoveId(id))).collect();
        Self { declared, scales, remade }
    }

    pub(crate) fn scales(&self) -> &Scales {
        &self.scales
    }

    /// The learnt probabilities of the moves, cumulatively.
    pub(crate) fn cumulative(&self) -> Option<&[f64]> {
        self.scales.weighing.as_ref()?.cumulative()
    }

    /// Whether the result of an iteration is noted: from the first look on.
    fn weighs_at(&self, iteration: u64) -> bool {
        self.scales.weighing.is_some() && !self.scales.frozen && iteration >= self.scales.until >> LOOKS
    }

    /// Whether the work of an iteration is to be counted.
    pub(crate) fn counts_work(&self, iteration: u64) -> bool {
        self.weighs_at(iteration) && Weighing::counts_work(iteration)
    }

    /// The chain was given another state, not by a move.
    pub(crate) fn forget_state(&mut self) {
        if let Some(weighing) = &mut self.scales.weighing {
            weighing.forget_state();
        }
    }

    /// Notes the result of iteration `iteration`, for the moves' weights.
    pub(crate) fn weigh(
        &mut self,
        iteration: u64,
        (id, accepted): (MoveId, bool),
        work: Option<u64>,
        (target, state): (&T, StateRefOf<'_, T>),
    ) {
        if self.weighs_at(iteration)
            && let Some(weighing) = &mut self.scales.weighing
        {
            let is_new = accepted || weighing.is_blind();
            weighing.note(id, accepted, work, is_new.then(|| target.numbers(state)));
        }
    }

    /// A move with its present scales; `None` if it has none.
    pub(crate) fn kernel(&self, id: MoveId) -> Option<&dyn Move<T>> {
        self.remade[usize::from(id.0)].as_deref()
    }

    /// Notes the state after iteration `iteration`, for moves that learn.
    pub(crate) fn look(&mut self, moves: &Mixture<T>, iteration: u64, target: &T, state: StateRefOf<'_, T>) {
        if self.scales.frozen {
            return;
        }
        if is_look(self.scales.until, iteration) {
            self.scales.turn(|| configured(moves));
        }
        for (id, (_, kernel)) in (0..).zip(moves.iter()) {
            let index = usize::from(id);
            let Some(learning) = &mut self.scales.learned[index] else { continue };
            if learning.note(&kernel.learn_from(target, state), kernel.merit(target, state)) {
                self.remade[index] = remade(kernel, &self.scales, MoveId(id));
            }
        }
    }

    /// Notes the result of a proposal made in iteration `iteration`.
    pub(crate) fn learn(
        &mut self,
        moves: &Mixture<T>,
        iteration: u64,
        (id, path): (MoveId, Option<Path>),
        accepted: bool,
    ) {
        let index = usize::from(id.0);
        let (_, kernel) = moves.get(id);
        let used = path.and_then(|path| kernel.scale_of(path)).filter(|&used| used < self.declared[index].len());
        if let Some(used) = used {
            let one = &mut self.scales.of[index][used];
            one.tried += 1;
            one.accepted += u64::from(accepted);
            if !self.scales.frozen {
                one.learn(&self.declared[index][used], accepted);
                self.remade[index] = remade(kernel, &self.scales, id);
            }
        }
        if !self.scales.frozen && iteration + 1 >= self.scales.until {
            self.freeze(moves, iteration + 1);
        }
    }

    /// Ends the adaptation; `until` is the first iteration that is made with what was adapted.
    pub(crate) fn freeze(&mut self, moves: &Mixture<T>, until: u64) {
        (self.scales.frozen, self.scales.until) = (true, until);
        self.scales.of.iter_mut().flatten().for_each(Adapted::freeze);
        self.scales.learned.iter_mut().flatten().for_each(Learning::freeze);
        if let Some(weighing) = &mut self.scales.weighing {
            weighing.freeze(&configured(moves));
        }
        *self = Self::resume(moves, self.scales.clone());
    }
}

/// The probabilities of the moves as they are configured.
fn configured<T: Target>(moves: &Mixture<T>) -> Vec<f64> {
    moves.iter().map(|(weight, _)| weight).collect()
}

fn remade<T: Target>(kernel: &dyn Move<T>, scales: &Scales, id: MoveId) -> Option<Box<dyn Move<T>>> {
    if let Some(learning) = scales.learned(id) {
        return kernel.at_fits(learning.fits());
    }
    let values = scales.values(id);
    if values.is_empty() { None } else { kernel.at_scales(&values) }
}

impl<T: Target> Mixture<T> {
    /// The same moves at these scales, with the probabilities learnt with them, or their own if none were learnt: the
    /// kernel of a chain whose warm-up ended with these scales.
    #[must_use]
    pub fn at(&self, scales: &Scales) -> Self {
        let weighed = scales.weighing.as_ref().and_then(Weighing::cumulative);
        self.map(|id, kernel| remade(kernel, scales, id), weighed)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SCALE: Scale = Scale { name: "step", start: 1.0, least: 1e-3, most: 1e3, target: Scale::ONE };

    fn begun() -> Adapted {
        Adapted { log: 0.0, tried: 0, accepted: 0, sum: 0.0, summed: 0, before: None }
    }

    #[test]
    fn looks_double() {
        let looks = |longest| (0..=longest).filter(|&done| is_look(longest, done)).collect::<Vec<u64>>();
        assert_eq!(looks(6400), [100, 200, 400, 800, 1600, 3200]);
        assert_eq!(looks(10), [1, 2, 5]);
        assert!(looks(1).is_empty());
        assert!(may_end(6400, 400) && !may_end(6400, 200) && !may_end(6400, 401));
    }

    /// A mean that differs by more than the tolerance, or that two halves do not show, has not settled.
    #[test]
    fn a_scale_settles_once_two_halves_agree() {
        let mut one = begun();
        let mut half = |log: f64, tries: u64| {
            one.turn();
            (one.sum, one.summed) = (log * tries as f64, tries);
            one.has_settled()
        };
        assert!(!half(1.0, 100), "nothing to compare with");
        assert!(half(1.0 + 0.9 * NEAR, 100) && !half(1.0 - 0.2 * NEAR, 100));
        assert!(!half(1.0, ENOUGH - 1), "too few");
        assert!(!half(1.0, ENOUGH), "too few before");
        assert!(half(1.0, ENOUGH));
    }

    #[test]
    fn scales_stay_between_their_ends() {
        for (accepted, end) in [(true, 1e3), (false, 1e-3)] {
            let mut one = begun();
            for n in 1..200 {
                one.tried = n;
                one.learn(&SCALE, accepted);
            }
            assert!((math::exp(one.log) / end - 1.0).abs() < 1e-12, "{one:?}");
        }
    }

    #[test]
    fn scales_that_were_hardly_tried_stay_as_configured() {
        let mut one = begun();
        let known = |summed: u64| {
            (one.summed, one.sum) = (summed, summed as f64);
            let mut scales =
                Scales { until: 2, frozen: true, of: vec![vec![one]], learned: vec![None], weighing: None };
            scales.of[0][0].freeze();
            scales.values(MoveId(0))
        };
        assert_eq!([ENOUGH - 1, ENOUGH].map(known), [vec![None], vec![Some(math::exp(1.0))]]);
    }
}

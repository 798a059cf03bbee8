//! Do a move's ratios agree with each other?

use super::{CheckError, EXACT, TRY};
use crate::moves::{At, Move, Path, Proposal};
use crate::target::{ModelError, State, StateOf, Target};
use plaus_dist::{LogRatio, Seed, Stream};
use std::fmt;

/// How to check ratios.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ratios {
    /// Seed of the states and proposals.
    pub seed: Seed,
    /// Number of pairs, at least 1.
    pub pairs: u64,
    /// Largest allowed disagreement in nats. 1e-9 leaves room for the rounding of sums of some 10⁶ nats (one unit in
    /// the last place there is 1.2e-10) and none for a forgotten term.
    pub tolerance: f64,
}

impl Default for Ratios {
    fn default() -> Self {
        Self { seed: Seed(0), pairs: 10_000, tolerance: 1e-9 }
    }
}

/// A state, a proposal from it, and what the move says about both directions.
#[derive(Debug, Clone)]
pub struct Pair<D, O> {
    /// Where the move starts.
    pub from: State<D, O>,
    /// What it answered.
    pub proposal: Proposal,
    /// Where it leads; `None` if it stayed, or the candidate has prior density 0.
    pub to: Option<State<D, O>>,
    /// The ratios, if there is a `to`.
    pub ratios: Option<PairRatios>,
}

/// The ratios of one pair along one path.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PairRatios {
    /// The ratio that the accept step uses: that of `propose`, times that of [`Move::log_ratio_after`] if it was
    /// announced.
    pub used: LogRatio,
    /// [`Move::log_ratio`] from `from` to `to`.
    pub forth: LogRatio,
    /// [`Move::log_ratio`] from `to` to `from` along the reverse path.
    pub back: LogRatio,
    /// By how much the later part exceeds its announced bound, in nats; at most 0 is correct.
    pub excess: f64,
    /// Whether the reverse of the reverse path is the path.
    pub path_returns: bool,
}

/// Largest disagreement found, and in which pair.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Worst {
    /// In nats.
    pub value: f64,
    /// Index of the pair; `None` if there was no disagreement at all.
    pub index: Option<u64>,
}

impl Worst {
    fn note(&mut self, value: f64, index: u64) {
        if value > self.value {
            *self = Self { value, index: Some(index) };
        }
    }
}

/// What [`ratios()`] found.
#[derive(Debug, Clone, PartialEq)]
pub struct RatioReport {
    /// The move.
    pub name: String,
    /// The settings.
    pub plan: Ratios,
    /// Pairs in which the move had nothing to change.
    pub stayed: u64,
    /// Pairs whose candidate has prior density 0: nothing to compare.
    pub impossible: u64,
    /// Pairs that cannot be undone (ratio 0): only the ratio itself is compared.
    pub one_way: u64,
    /// Between what the accept step uses and [`Move::log_ratio`].
    pub agreement: Worst,
    /// Between the two directions: |forth + back|.
    pub reversal: Worst,
    /// Of the later part over its bound.
    pub bound: Worst,
    /// The first pair whose path does not lead back to itself.
    pub broken_path: Option<u64>,
}

impl RatioReport {
    /// Whether nothing disagrees by more than the tolerance, and at least one pair was compared.
    #[must_use]
    pub fn passed(&self) -> bool {
        let within = |worst: Worst| worst.value <= self.plan.tolerance;
        let compared = self.stayed + self.impossible < self.plan.pairs;
        // A bound has no tolerance: an early stop on a bound that is too low by a rounding error is a wrong decision.
        let bounded = self.bound.index.is_none();
        compared && within(self.agreement) && within(self.reversal) && bounded && self.broken_path.is_none()
    }

    fn take(&mut self, index: u64, pair: Option<PairRatios>, proposal: Proposal) {
        let Some(ratios) = pair else {
            *(if proposal == Proposal::Stay { &mut self.stayed } else { &mut self.impossible }) += 1;
            return;
        };
        self.agreement.note(gap(ratios.used.value(), ratios.forth.value()), index);
        self.bound.note(ratios.excess, index);
        if !ratios.path_returns {
            self.broken_path.get_or_insert(index);
        }
        if ratios.used == LogRatio::ZERO {
            self.one_way += 1;
        } else {
            self.reversal.note(gap(ratios.forth.value(), -ratios.back.value()), index);
        }
    }
}

impl fmt::Display for RatioReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let verdict = if self.passed() { "passed" } else { "FAILED" };
        let Ratios { seed, pairs, tolerance } = self.plan;
        writeln!(
            f,
            "ratios of `{}`: {verdict} ({pairs} pairs of seed {seed}, tolerance {tolerance:e} nats)",
            self.name
        )?;
        let (stayed, impossible, one_way) = (self.stayed, self.impossible, self.one_way);
        writeln!(f, "  stayed {stayed}, prior density 0 {impossible}, without a way back {one_way}")?;
        let rows = [
            ("used against log_ratio", self.agreement),
            ("there and back", self.reversal),
            ("later part above its bound", self.bound),
        ];
        for (what, Worst { value, index }) in rows {
            match index {
                Some(index) => writeln!(f, "  {what}: at worst {value:.1e}, pair {index} (see `ratio_pair`)")?,
                None => writeln!(f, "  {what}: no difference")?,
            }
        }
        match self.broken_path {
            Some(index) => writeln!(f, "  path: reversing it twice gives another path, pair {index}"),
            None => Ok(()),
        }
    }
}

/// |a − b|, 0 for equal infinities.
fn gap(a: f64, b: f64) -> f64 {
    if a == b { 0.0 } else { (a - b).abs() }
}

/// Compares, over many pairs, the ratio that the accept step uses with [`Move::log_ratio`], and the two directions of
/// the latter with each other; also the later part with its bound. `states` gives the state from which each pair
/// starts, e.g. [`super::prior`] or [`super::any_of`].
///
/// A move that is consistent but wrong about what it proposes passes: see [`super::one_step()`].
///
/// # Errors
/// [`CheckError::Model`] if the model or `states` fails; [`CheckError::Setting`] for no pairs.
pub fn ratios<T: Target>(
    target: &T,
    kernel: &dyn Move<T>,
    mut states: impl FnMut(&mut Stream) -> Result<StateOf<T>, ModelError>,
    plan: Ratios,
) -> Result<RatioReport, CheckError> {
    CheckError::unless(plan.pairs > 0, "pairs", 0.0, "at least 1")?;
    let mut report = RatioReport {
        name: kernel.name().to_owned(),
        plan,
        stayed: 0,
        impossible: 0,
        one_way: 0,
        agreement: Worst::default(),
        reversal: Worst::default(),
        bound: Worst::default(),
        broken_path: None,
    };
    for index in 0..plan.pairs {
        let pair = ratio_pair(target, kernel, &mut states, plan.seed, index)?;
        report.take(index, pair.ratios, pair.proposal);
    }
    Ok(report)
}

/// One pair of [`ratios()`], made again: its states, its proposal and its ratios. `states` must be the same source.
///
/// # Errors
/// [`CheckError::Model`] if the model or `states` fails.
pub fn ratio_pair<T: Target>(
    target: &T,
    kernel: &dyn Move<T>,
    mut states: impl FnMut(&mut Stream) -> Result<StateOf<T>, ModelError>,
    seed: Seed,
    index: u64,
) -> Result<Pair<T::Draw, T::Outcome>, CheckError> {
    let streams = seed.chain(0);
    let mut pair = || {
        let from = states(&mut streams.at(index, EXACT))?;
        let mut draw = from.draw.clone();
        let proposal = kernel.propose(At::new(target, &from), &mut draw, &mut streams.at(index, TRY))?;
        let Proposal::Candidate { log_ratio, path, later } = proposal else {
            return Ok(Pair { from, proposal, to: None, ratios: None });
        };
        if target.log_prior(&draw)?.is_zero() {
            return Ok(Pair { from, proposal, to: None, ratios: None });
        }
        let to = State::evaluate(target, draw, &mut T::Scratch::default())?;
        let ratios = compare(target, kernel, (&from, &to), path, (log_ratio, later))?;
        Ok(Pair { from, proposal, to: Some(to), ratios: Some(ratios) })
    };
    pair().map_err(CheckError::model(index))
}

/// The ratios of the way from the first state to the second, for which `propose` returned `known` and announced
/// `later`.
pub(super) fn compare<T: Target>(
    target: &T,
    kernel: &dyn Move<T>,
    (from, to): (&StateOf<T>, &StateOf<T>),
    path: Path,
    (known, later): (LogRatio, Option<LogRatio>),
) -> Result<PairRatios, ModelError> {
    let step = At::new(target, from).to(to.by_ref(), path);
    let (used, excess) = match later {
        Some(bound) => {
            let after = kernel.log_ratio_after(step)?;
            (known.times(after)?, if after <= bound { 0.0 } else { after.value() - bound.value() })
        }
        None => (known, 0.0),
    };
    let forth = kernel.log_ratio(step)?;
    let reverse = kernel.reverse(path);
    // A way that cannot be undone has no ratio back.
    let back = if used == LogRatio::ZERO { forth.inverse() } else { kernel.log_ratio(step.back(reverse))? };
    Ok(PairRatios { used, forth, back, excess, path_returns: kernel.reverse(reverse) == path })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_infinities_agree() {
        assert_eq!(gap(f64::NEG_INFINITY, f64::NEG_INFINITY), 0.0);
        assert_eq!(gap(f64::NEG_INFINITY, 3.0), f64::INFINITY);
        assert_eq!(gap(1.0, 3.0), 2.0);
    }
}

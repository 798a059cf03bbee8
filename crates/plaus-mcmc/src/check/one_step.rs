//! Does a step preserve the law of exact draws?

use super::laws::{Column, LogP, compare};
use super::{CheckError, EXACT, FRESH};
use crate::chain::{Chain, MoveCounts};
use crate::moves::Mixture;
use crate::target::{ModelError, State, StateOf, Target};
use plaus_dist::{Seed, Stream};
use std::fmt;

/// A number computed from a state, whose law a step must preserve.
pub struct Statistic<'a, D, O> {
    name: String,
    value: Reading<'a, D, O>,
}

type Reading<'a, D, O> = Box<dyn Fn(&State<D, O>) -> f64 + 'a>;

impl<'a, D, O> Statistic<'a, D, O> {
    /// A statistic by name. Its values must be finite.
    pub fn new(name: impl Into<String>, value: impl Fn(&State<D, O>) -> f64 + 'a) -> Self {
        Self { name: name.into(), value: Box::new(value) }
    }
}

/// How to check one step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OneStep {
    /// Seed of the exact draws and the steps.
    pub seed: Seed,
    /// Number of exact draws to step from, and of draws to compare with; at least 1000. A shift by a fraction s of a
    /// statistic's standard deviation shows with about 100/s² samples.
    pub samples: u64,
    /// Iterations from each draw; at least 1. One iteration tests the kernel most directly. For a kernel that rarely
    /// accepts, several iterations let the effect of a fault add up.
    pub steps: u64,
    /// Cells of equal probability into which each statistic is cut, at least 2.
    pub cells: usize,
    /// Probability of a false alarm of the whole check, above 0 and below 1.
    pub false_alarm: f64,
}

impl Default for OneStep {
    fn default() -> Self {
        Self { seed: Seed(0), samples: 100_000, steps: 1, cells: 16, false_alarm: 1e-6 }
    }
}

impl OneStep {
    fn check(&self) -> Result<(), CheckError> {
        // With fewer than 458 samples the Kolmogorov–Smirnov bound does not hold.
        CheckError::unless(self.samples >= 1000, "samples", self.samples as f64, "at least 1000")?;
        CheckError::unless(self.steps > 0, "steps", 0.0, "at least 1")?;
        CheckError::unless(self.cells >= 2, "cells", self.cells as f64, "at least 2")?;
        CheckError::check_false_alarm(self.false_alarm)
    }
}

/// The result for one statistic.
#[derive(Debug, Clone, PartialEq)]
pub struct StatisticReport {
    /// The statistic.
    pub name: String,
    /// p-value, corrected for all tests of all statistics of the check.
    pub p: LogP,
    /// The test that gave it.
    pub test: String,
    /// Mean before the step.
    pub before: f64,
    /// Mean after it.
    pub after: f64,
}

/// What [`one_step()`] found.
#[derive(Debug, Clone, PartialEq)]
pub struct OneStepReport {
    /// The moves, with how often each ended in each way. A move that was never accepted has not been tested.
    pub moves: Vec<(String, MoveCounts)>,
    /// The settings.
    pub plan: OneStep,
    /// Each statistic; the first two are log prior and log constraint.
    pub statistics: Vec<StatisticReport>,
}

impl OneStepReport {
    /// Whether there is no evidence, at the false-alarm rate, that the kernel changes the law.
    #[must_use]
    pub fn passed(&self) -> bool {
        self.p().value() >= self.plan.false_alarm
    }

    /// p-value of the whole check: the smallest of the statistics' corrected ones.
    #[must_use]
    pub fn p(&self) -> LogP {
        self.statistics.iter().map(|one| one.p).fold(LogP::ONE, |p, q| if q < p { q } else { p })
    }

    /// Accepted candidates.
    #[must_use]
    pub fn accepted(&self) -> u64 {
        self.moves.iter().map(|(_, counts)| counts.accepted).sum()
    }
}

impl fmt::Display for OneStepReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let OneStep { seed, samples, steps, false_alarm, .. } = self.plan;
        let verdict = if self.passed() { "passed" } else { "FAILED" };
        writeln!(f, "law after {steps} step(s) from exact draws: {verdict}, p = {}", self.p())?;
        writeln!(f, "  {samples} draws of seed {seed}, false-alarm rate {false_alarm:e}")?;
        for (name, counts) in &self.moves {
            let untested = if counts.accepted == 0 { "  (never accepted: NOT TESTED)" } else { "" };
            writeln!(f, "  move `{name}`: {} of {} accepted{untested}", counts.accepted, counts.made())?;
        }
        writeln!(f, "  {:<24} {:>9} {:>13} {:>13}  strongest test", "statistic", "p", "mean before", "mean after")?;
        for StatisticReport { name, p, test, before, after } in &self.statistics {
            writeln!(f, "  {name:<24} {p:>9} {before:>13.6} {after:>13.6}  {test}")?;
        }
        Ok(())
    }
}

/// Makes real accept steps from exact draws x of `target` to y, and tests that y has the law of x in every statistic,
/// and in log prior and log constraint: mean, spread about the median, share in each of [`OneStep::cells`] cells, each
/// by the signs of y − x; and the whole law, y against fresh draws, by Kolmogorov and Smirnov.
///
/// `exact` is an exact sampler: [`super::prior`], [`super::rejection`], or your own. To test one move, pass a mixture
/// of that move alone. Moves that are each other's reverse (activate and deactivate) leave the target invariant only
/// together.
///
/// For kernels reversible for the target, which every mixture of Metropolis–Hastings moves is, no p-value relies on an
/// approximation: (x, y) and (y, x) then have the same law, so the signs of y − x are fair coins.
///
/// # Errors
/// [`CheckError`] if the model, a move, a statistic or `exact` fails, or a setting is out of range.
pub fn one_step<T: Target>(
    target: &T,
    moves: &Mixture<T>,
    mut exact: impl FnMut(&mut Stream) -> Result<StateOf<T>, ModelError>,
    statistics: &[Statistic<'_, T::Draw, T::Outcome>],
    plan: OneStep,
) -> Result<OneStepReport, CheckError> {
    plan.check()?;
    let builtin = [
        Statistic::new("log prior", |state: &StateOf<T>| state.log_prior.value()),
        Statistic::new("log constraint", |state: &StateOf<T>| state.log_constraint.value()),
    ];
    let statistics: Vec<_> = builtin.iter().chain(statistics).collect();
    let streams = plan.seed.chain(0);
    let mut counts = vec![MoveCounts::default(); moves.names().len()];
    let room = || Vec::with_capacity(usize::try_from(plan.samples).unwrap_or(0));
    let mut columns: Vec<_> =
        statistics.iter().map(|_| Column { before: room(), after: room(), fresh: room() }).collect();

    for index in 0..plan.samples {
        let fresh = exact(&mut streams.at(index, FRESH)).map_err(CheckError::model(index))?;
        let before = exact(&mut streams.at(index, EXACT)).map_err(CheckError::model(index))?;
        for (column, statistic) in columns.iter_mut().zip(&statistics) {
            column.fresh.push(measure(statistic, &fresh, index)?);
            column.before.push(measure(statistic, &before, index)?);
        }
        let untouched = vec![MoveCounts::default(); counts.len()];
        let mut chain = Chain::resume(target, moves, streams, index * plan.steps, before, untouched);
        for _ in 0..plan.steps {
            chain.step().map_err(|source| CheckError::Chain { index, source })?;
        }
        for (column, statistic) in columns.iter_mut().zip(&statistics) {
            column.after.push(measure(statistic, chain.state(), index)?);
        }
        counts.iter_mut().zip(chain.counts()).for_each(|(all, one)| all.add(one));
    }

    let tested: Vec<_> = columns.iter().map(|column| compare(column, plan.cells)).collect();
    let tests = tested.iter().map(|(_, count)| count).sum();
    let reports = statistics.iter().zip(&columns).zip(tested).map(|((statistic, column), ((p, test), _))| {
        let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
        let (before, after) = (mean(&column.before), mean(&column.after));
        StatisticReport { name: statistic.name.clone(), p: p.of_smallest_among(tests), test, before, after }
    });
    Ok(OneStepReport { moves: moves.names().into_iter().zip(counts).collect(), plan, statistics: reports.collect() })
}

fn measure<D, O>(statistic: &Statistic<'_, D, O>, state: &State<D, O>, index: u64) -> Result<f64, CheckError> {
    let value = (statistic.value)(state);
    if value.is_finite() {
        Ok(value)
    } else {
        Err(CheckError::Statistic { name: statistic.name.clone(), value, index })
    }
}

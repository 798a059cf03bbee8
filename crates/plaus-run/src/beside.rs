//! Compares a run's chains with exact draws of its target, made from the prior by rejection. These show what all chains
//! missed, which chains cannot see in each other.
//!
//! Chains that agree may all be in the same part of what they should sample. Draws from the prior are independent of
//! the chains. Each one that is kept is an independent draw of the target, so, but for chance, the kept draws and the
//! chains have the same share between any two values of a variable. Cells between such values, each with an equal share
//! of the kept draws, are compared with the chains by Fisher's exact test, in which the chains count as many draws as
//! their effective sample size. If chains were hardly ever in a cell although draws were kept there, they missed
//! something.
//!
//! This finds what shows in a single variable or outcome, and holds more than a few of the kept draws. If the prior
//! hardly ever gets there, nothing is kept, and nothing is known.

use crate::diagnosis::{Diagnosis, columns};
use crate::error::Error;
use crate::read::RunReader;
use plaus_dist::math;
use plaus_mcmc::{keep_draws, parallel};
use plaus_scenes::Scene;
use serde::Serialize;

/// Largest number of draws; also at most the run's number of iterations.
const MOST: u64 = 40_000;
/// Largest number of values, a state's times the draws: bounds the time for large states.
const NUMBERS: u64 = 80_000;
/// Draws between two checks of how many were kept.
const AT_A_TIME: u64 = 64;
/// This many kept draws are enough: a cell then holds a dozen.
const ENOUGH: usize = 200;
/// Fewer kept draws say nothing: even if all of them lay where no chain ever was, that might happen by chance in one
/// cell of one variable.
const FEWEST: usize = 8;
/// Largest number of cells, and smallest number of kept draws in each.
const CELLS: usize = 16;
const IN_CELL: usize = 4;
/// Share of correct runs that are blamed by chance.
const ALARM: f64 = 1e-3;

/// What exact draws show about a run.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Beside {
    /// Number of draws made from the prior.
    pub draws: u64,
    /// Number of those that were kept: independent draws of the target.
    pub kept: u64,
    /// The worst place where chains hardly ever were, although more draws were kept there than chance explains.
    pub missed: Option<Missed>,
}

/// A part of what should be sampled that chains hardly visited.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Missed {
    /// The variable or outcome that shows it.
    pub scalar: String,
    /// Its values there: above the first, up to the second; `None` if there is no such end.
    pub between: [Option<f64>; 2],
    /// Share of the kept draws there.
    pub kept: f64,
    /// Share of the chains' draws there.
    pub chains: f64,
    /// The probability of so large a difference by chance, over everything tested.
    pub p: f64,
}

impl Beside {
    /// Whether there were enough exact draws to say anything.
    #[must_use]
    pub fn says_something(&self) -> bool {
        self.kept >= FEWEST as u64
    }

    /// Draws from the prior and compares the run's chains with the kept draws. `None` if a comparison is impossible:
    /// the run's draws are already independent, its moves are not exact, or it has a requirement in a program that the
    /// folder does not hold.
    ///
    /// # Errors
    /// [`Error`] if a draw fails, or the records are damaged.
    pub fn of(run: &RunReader<'_>, diagnosis: &Diagnosis) -> Result<Option<Self>, Error> {
        let manifest = run.run().manifest();
        if manifest.is_independent() || !manifest.exact || manifest.requirement.is_some() || diagnosis.draws == 0 {
            return Ok(None);
        }
        let scene = run.scene();
        let scalars = scene.scalars();
        let total = diagnosis.iterations.saturating_mul(run.chains().len() as u64);
        let most = total.clamp(1, MOST).min(NUMBERS / scalars.len().max(1) as u64 + 1);
        let (mut draws, mut kept) = (0, Vec::new());
        while draws < most && kept.len() < ENOUGH {
            let next = most.min(draws + AT_A_TIME);
            let made = keep_draws(scene, manifest.plan.seed, draws..next);
            kept.extend(made.map_err(|error| Error::Sampling(error.to_string()))?);
            draws = next;
        }
        let found = Self { draws, kept: kept.len() as u64, missed: None };
        if !found.says_something() {
            return Ok(Some(found));
        }
        let mut exact = vec![Vec::with_capacity(kept.len()); scalars.len()];
        let mut values = vec![0.0; scalars.len()];
        for state in &kept {
            scene.write_scalars(state.by_ref(), &mut values);
            exact.iter_mut().zip(&values).for_each(|(column, &value)| column.push(value));
        }
        let cells = (kept.len() / IN_CELL).min(CELLS);
        let tests = (cells * scalars.len()) as f64;
        let look = |number: usize| -> Result<Option<Missed>, Error> {
            let name = &scalars[number].name;
            let row = diagnosis.scalars.iter().find(|row| row.scalar.name == *name);
            let Some(ess) = row.and_then(|row| row.summary.as_ref()).map(|summary| summary.ess_bulk) else {
                return Ok(None);
            };
            let chains = columns(run, number, 1, diagnosis.stride)?.concat().concat();
            Ok(worst(name, &mut exact[number].clone(), chains, ess, cells))
        };
        let all = parallel::try_map(scalars.len(), look)?;
        let worst = all.into_iter().flatten().reduce(|a, b| if b.p < a.p { b } else { a });
        let missed = worst.map(|worst| Missed { p: (worst.p * tests).min(1.0), ..worst }).filter(|one| one.p < ALARM);
        Ok(Some(Self { missed, ..found }))
    }
}

/// The cell in which kept draws exceed those of chains by most, with the probability for that cell alone.
fn worst(name: &str, exact: &mut [f64], mut chains: Vec<f64>, ess: f64, cells: usize) -> Option<Missed> {
    if exact.iter().chain(&chains).any(|value| !value.is_finite()) {
        return None;
    }
    exact.sort_unstable_by(f64::total_cmp);
    chains.sort_unstable_by(f64::total_cmp);
    // Cells end at values between kept draws that differ; the outermost ends are open.
    let mut ends: Vec<f64> = (1..cells).map(|cell| exact[cell * exact.len() / cells - 1]).collect();
    ends.dedup();
    ends.retain(|end| end < &exact[exact.len() - 1]);
    let ends: Vec<Option<f64>> =
        std::iter::once(None).chain(ends.into_iter().map(Some)).chain(std::iter::once(None)).collect();
    let below = |values: &[f64], end: Option<f64>, none: usize| {
        end.map_or(none, |end| values.partition_point(|value| *value <= end))
    };
    let effective = ess.clamp(1.0, 1e5).round() as usize;
    let cell = |pair: &[Option<f64>]| {
        let count = |values: &[f64]| below(values, pair[1], values.len()) - below(values, pair[0], 0);
        let (here, share) = (count(exact), count(&chains) as f64 / chains.len() as f64);
        let p = fisher(here, exact.len(), (share * effective as f64).round() as usize, effective);
        let kept = here as f64 / exact.len() as f64;
        Missed { scalar: name.to_owned(), between: [pair[0], pair[1]], kept, chains: share, p }
    };
    ends.windows(2).map(cell).reduce(|a, b| if b.p < a.p { b } else { a })
}

/// Fisher's exact test, one-sided: the probability that, of `here + there` hits, at least `here` are among the first
/// `n` of `n + m` draws.
fn fisher(here: usize, n: usize, there: usize, m: usize) -> f64 {
    let hits = here + there;
    let mut factorials = vec![0.0_f64; n + m + 1];
    for k in 1..factorials.len() {
        factorials[k] = factorials[k - 1] + math::ln(k as f64);
    }
    let choose = |n: usize, k: usize| factorials[n] - factorials[k] - factorials[n - k];
    let possible = here..=hits.min(n);
    let one = |k: usize| {
        let misses = n - k;
        if misses > n + m - hits {
            0.0
        } else {
            math::exp(choose(hits, k) + choose(n + m - hits, misses) - choose(n + m, n))
        }
    };
    possible.map(one).sum::<f64>().min(1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Fisher's tea-tasting lady: eight cups, all four identified correctly; and three of four.
    #[test]
    fn fishers_test_agrees_with_textbooks() {
        assert!((fisher(4, 4, 0, 4) - 1.0 / 70.0).abs() < 1e-12);
        assert!((fisher(3, 4, 1, 4) - 17.0 / 70.0).abs() < 1e-12);
        assert!((fisher(0, 4, 4, 4) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn a_missed_mode_is_found_at_its_place() {
        let grid = |n: usize, from: f64, to: f64| (0..n).map(move |k| from + (to - from) * (k as f64 + 0.5) / n as f64);
        let mut exact: Vec<f64> = grid(87, 0.0, 1.0).chain(grid(13, 5.0, 5.1)).collect();
        let missed = worst("x", &mut exact, grid(5000, 0.0, 1.0).collect(), 400.0, 16).unwrap();
        // One of the seven cells contains only values that the chains never reached: all seven hits are among the first
        // 100 of 500 draws.
        let chance: f64 = (0..7).map(|k| f64::from(100 - k) / f64::from(500 - k)).product();
        assert!((missed.p / chance - 1.0).abs() < 1e-9 && missed.chains == 0.0, "{missed:?}, {chance}");
        assert!(missed.between[0].is_some_and(|end| (0.9..5.1).contains(&end)), "{missed:?}");
        // The same with chains that visit the mode, and with a single value.
        let whole: Vec<f64> = grid(4350, 0.0, 1.0).chain(grid(650, 5.0, 5.1)).collect();
        assert!(worst("x", &mut exact, whole, 400.0, 16).unwrap().p > 0.1);
        assert!(worst("x", &mut [1.0; 20], vec![1.0; 50], 40.0, 5).unwrap().p > 0.99);
        assert_eq!(worst("x", &mut [f64::NAN; 20], vec![1.0; 50], 40.0, 5), None);
    }
}

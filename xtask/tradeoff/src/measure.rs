//! The numbers of one world: time, error before chaos, distance of distributions.

use crate::world::{Way, World};
use plaus_figures::Result;

/// One simulator's numbers.
pub(crate) struct Row {
    pub(crate) way: Way,
    /// Median computing time in s, and its tenth percentile.
    pub(crate) seconds: f64,
    pub(crate) early: f64,
    /// Median error after a quarter of a second, in m; none for the reference itself.
    pub(crate) error: Option<f64>,
    /// Median time of agreement in s.
    pub(crate) agreement: Option<f64>,
    /// Total variation from the reference, and what sampling alone gives.
    pub(crate) distance: f64,
    pub(crate) noise: f64,
}

/// Draws whose trajectories are compared.
const COMPARED: u64 = 100;
/// Time between comparisons, in s.
const SAMPLING: f64 = 0.01;

/// Measures all ways; the reference comes first.
pub(crate) fn measure(world: &mut dyn World, draws: u64) -> Result<Vec<Row>> {
    let times: Vec<f64> = (1..=150).map(|k| SAMPLING * f64::from(k)).collect();
    let mut rows = Vec::new();
    let mut reference = Vec::new();
    let mut paths = Vec::new();
    for way in Way::ALL {
        eprintln!("  {}: {way:?}", world.name());
        let mut counts = vec![0_u64; world.outcomes()];
        let mut seconds = Vec::new();
        // The reference takes other draws than the rest, so that distances are between independent samples.
        let first = if rows.is_empty() { draws } else { 0 };
        for draw in first..first + draws {
            let (outcome, time) = world.outcome(way, draw)?;
            counts[outcome] += 1;
            seconds.push(time);
        }
        seconds.sort_by(f64::total_cmp);
        let law: Vec<f64> = counts.iter().map(|&c| c as f64 / draws as f64).collect();
        let (mut errors, mut agreements) = (Vec::new(), Vec::new());
        for draw in 0..COMPARED.min(draws) {
            let path = world.positions(way, draw, &times)?;
            if reference.is_empty() {
                paths.push(path);
                continue;
            }
            let apart = |k: usize| {
                path[k].iter().zip(&paths[draw as usize][k]).map(|(a, b)| (*a - *b).length()).fold(0.0, f64::max)
            };
            errors.push(apart(24));
            agreements.push(
                (0..times.len()).find(|&k| apart(k) > world.tolerance()).map_or(times[times.len() - 1], |k| times[k]),
            );
        }
        if reference.is_empty() {
            reference.clone_from(&law);
        }
        rows.push(Row {
            way,
            seconds: seconds[seconds.len() / 2],
            early: seconds[seconds.len() / 10],
            error: median(errors),
            agreement: median(agreements),
            distance: 0.5 * law.iter().zip(&reference).map(|(p, q)| (p - q).abs()).sum::<f64>(),
            noise: noise(&reference, draws),
        });
    }
    Ok(rows)
}

fn median(mut values: Vec<f64>) -> Option<f64> {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied()
}

/// Expected total variation between two samples of `draws` from one law: half the sum of the mean absolute differences of two binomial frequencies.
fn noise(law: &[f64], draws: u64) -> f64 {
    0.5 * law.iter().map(|p| 2.0 * (p * (1.0 - p) / (draws as f64 * std::f64::consts::PI)).sqrt()).sum::<f64>()
}

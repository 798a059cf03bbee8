//! Plots of how well a run mixes, as SVG: for each scalar the trace, the autocorrelation and the ranks of every chain;
//! for each move how often it was accepted; and the times asked for against those found.

pub(crate) mod histogram;
pub(crate) mod plan;
pub(crate) mod values;

use crate::demanded;
use crate::svg::{Frame, PANEL, Svg};
use plaus_mcmc::MoveCounts;
use plaus_mcmc::diagnose::autocorrelation;
use plaus_run::diagnosis::columns;
use plaus_run::export::output;
use plaus_run::{ChainPhase, Error, RunFileError, RunFileProblem, RunReader, Tally};
use plaus_scenes::{Role, Scalar, Scene};
use std::fs;
use std::path::Path;

/// The file that marks a folder of plots. Only folders that have it are replaced.
const MARK: &str = "plaus-plots.json";
/// Largest number of scalars drawn: the outcomes first, then random variables.
const MOST: usize = 24;
/// Points of a trace, per chain.
const POINTS: u64 = 1000;
/// Lags of an autocorrelation.
const LAGS: usize = 100;
/// Bins of a histogram of ranks.
const BINS: usize = 20;

/// Draws into the folder `out`, which is made; gives the number of plots.
///
/// # Errors
/// [`Error`] if the run cannot be read or the folder not be made.
pub(crate) fn write(run: &RunReader<'_>, out: &Path, force: bool) -> Result<usize, Error> {
    let mut count = 0;
    output::folder(
        out,
        force,
        |path| path.join(MARK).is_file(),
        |folder| -> Result<(), Error> {
            let save = |name: &str, text: &str| fs::write(folder.join(name), text).map_err(Error::Output);
            let mut scalars: Vec<(usize, Scalar)> = run.scene().scalars().into_iter().enumerate().collect();
            scalars.retain(|(_, scalar)| scalar.role != Role::Detail);
            scalars.sort_by_key(|(index, scalar)| (scalar.role == Role::Draw, *index));
            for (index, scalar) in scalars.into_iter().take(MOST) {
                let chains = columns(run, index, 1, 1)?.pop().unwrap_or_default();
                save(&format!("{}.svg", scalar.name), &of_scalar(&scalar, &chains))?;
                count += 1;
            }
            let names = &run.run().manifest().moves;
            save("moves.svg", &of_moves(names, &Tally::of(run)?.counts))?;
            count += 1;
            if let Some(times) = demanded::plot(run)? {
                save("times.svg", &times)?;
                count += 1;
            }
            save(
                MARK,
                &format!(
                    "{{\"plaus\": \"{}\", \"draws\": {}}}\n",
                    run.run().manifest().plaus,
                    run.draws(ChainPhase::Sampling)
                ),
            )
        },
    )?;
    match count {
        0 => Err(RunFileError::new(out, RunFileProblem::Empty).into()),
        count => Ok(count),
    }
}

/// Trace, autocorrelation and ranks.
fn of_scalar(scalar: &Scalar, chains: &[Vec<f64>]) -> String {
    let mut svg = Svg::new(3 * PANEL[0] as usize, PANEL[1] as usize);
    let unit = if scalar.unit.is_empty() { String::new() } else { format!(" ({})", scalar.unit) };
    let draws = chains.iter().map(Vec::len).max().unwrap_or(0);
    let finite = || chains.iter().flatten().copied().filter(|value| value.is_finite());
    let (low, high) = (finite().fold(f64::INFINITY, f64::min), finite().fold(f64::NEG_INFINITY, f64::max));
    let trace = Frame::new(0, [0.0, draws as f64], [low, high]);
    svg.axes(&trace, &format!("{}{unit}", scalar.name), "draw");
    let stride = (draws as u64).div_ceil(POINTS).max(1) as usize;
    let chance = Frame::new(1, [0.0, LAGS as f64], [-0.2, 1.0]);
    svg.axes(&chance, "autocorrelation", "lag (draws)");
    svg.level(&chance, 0.0);
    let most = 2.0 / BINS as f64;
    let ranks = Frame::new(2, [0.0, 1.0], [0.0, most]);
    svg.axes(&ranks, "share of the chain", "rank among all chains");
    svg.level(&ranks, 1.0 / BINS as f64);
    for (number, (chain, shares)) in chains.iter().zip(rank_shares(chains)).enumerate() {
        let points = chain.iter().enumerate().step_by(stride).map(|(draw, value)| (draw as f64, *value));
        svg.line(&trace, number, points);
        if let Ok(Some(values)) = autocorrelation(chain, LAGS) {
            svg.line(&chance, number, values.into_iter().enumerate().map(|(lag, value)| (lag as f64, value)));
        }
        let steps = shares
            .into_iter()
            .enumerate()
            .flat_map(|(bin, share)| [bin, bin + 1].map(|edge| (edge as f64 / BINS as f64, share.min(most))));
        svg.line(&ranks, number, steps);
    }
    svg.finish()
}

/// For each chain, the share of its draws in each bin of the ranks among all chains' draws. The shares are even where
/// the chains agree.
fn rank_shares(chains: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let mut all: Vec<(f64, usize)> = Vec::new();
    for (number, chain) in chains.iter().enumerate() {
        all.extend(chain.iter().map(|value| (*value, number)));
    }
    all.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut shares = vec![vec![0.0; BINS]; chains.len()];
    for (rank, (_, number)) in all.iter().enumerate() {
        shares[*number][rank * BINS / all.len()] += 1.0 / chains[*number].len() as f64;
    }
    shares
}

/// One bar for each move: the share of its proposals that was accepted.
fn of_moves(names: &[String], counts: &[MoveCounts]) -> String {
    let mut svg = Svg::new(900, 48 + 44 * names.len().max(1));
    for (row, (name, count)) in names.iter().zip(counts).enumerate() {
        let (made, share) = (count.made(), count.acceptance());
        let share = if share.is_finite() { share } else { 0.0 };
        svg.bar(row, name, share, &format!("{:.1}% of {made} accepted", 100.0 * share));
    }
    svg.finish()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn chains_that_agree_have_even_ranks_and_others_not() {
        let same = vec![(0..400).map(f64::from).collect::<Vec<_>>(); 2];
        assert!(rank_shares(&same).iter().flatten().all(|share| (share - 0.05).abs() < 0.01));
        let apart = vec![vec![0.0; 100], vec![1.0; 100]];
        let shares = rank_shares(&apart);
        assert!(shares[0][..10].iter().all(|share| *share > 0.05) && shares[0][10..].iter().all(|share| *share == 0.0));
    }

    #[test]
    fn what_never_moves_or_is_no_number_is_drawn_too() {
        let scalar =
            Scalar { name: "x".into(), unit: "m", role: Role::Draw, base: "x".into(), member: None, whole: false };
        for chains in [vec![vec![1.0; 50]; 2], vec![vec![f64::NAN; 50]], vec![vec![]], vec![]] {
            let svg = of_scalar(&scalar, &chains);
            assert!(svg.starts_with("<svg ") && svg.ends_with("</svg>\n") && !svg.contains("NaN"), "{svg}");
        }
    }
}

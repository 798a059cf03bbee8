//! The use of each move: chains without it.

use super::shots::{Haul, LEAVE, SPARE, STRIKE, Shot, Until, by_chain};
use crate::report::{table, thousands};
use crate::stats::Estimate;
use crate::{Result, Work};
use plaus_scenes::Moves;
use plaus_scenes::bowling::Weights;
use rayon::prelude::*;

/// A name, and the moves that are left out.
type Off = (&'static str, &'static [&'static str]);

const OFF: &[Off] = &[
    ("none", &[]),
    ("change_all", &["change_all"]),
    (
        "change_… (the paper's six others)",
        &["change_radius", "change_density", "change_position", "change_velocity", "change_spin", "change_pins"],
    ),
    ("redraw, redraw_pins", &["redraw", "redraw_pins"]),
    ("aim", &["aim"]),
    ("refine", &["refine"]),
    ("mirror", &["mirror"]),
];

fn leave_out(weights: &mut Weights, moves: &[&str]) {
    moves.iter().for_each(|name| weights.set(name, 0.0));
}

/// Chains of one kind, and what they saw; the share's error is taken over chains.
struct Seen {
    share: Estimate,
    distinct: usize,
    found: usize,
    milliseconds: f64,
}

fn seen(shot: Shot, change: impl FnOnce(&mut plaus_scenes::bowling::Config), size: (u64, u64)) -> Result<Seen> {
    let (bowler, (chains, iterations)) = (shot.bowler_with(change)?, size);
    let hauls = (0..chains).into_par_iter().map(|seed| by_chain(&bowler, seed, Until::Draws(iterations), |_| Ok(())));
    let hauls = hauls.collect::<Result<Vec<_>>>()?;
    let shares: Vec<f64> = hauls.iter().map(|haul| haul.hits as f64 / iterations as f64).collect();
    let count = shares.len() as f64;
    let value = shares.iter().sum::<f64>() / count;
    let spread = shares.iter().map(|share| (share - value) * (share - value)).sum::<f64>();
    let found = hauls.iter().filter(|haul| haul.hits > 0).count();
    let mut all = Haul::default();
    hauls.into_iter().for_each(|haul| all.add(haul));
    Ok(Seen {
        share: Estimate { value, error: (spread / (count * (count - 1.0).max(1.0))).sqrt() },
        distinct: all.classes.len(),
        found,
        milliseconds: 1e3 * all.seconds / all.draws as f64,
    })
}

pub(super) fn make(work: &mut Work) -> Result<()> {
    let shots = [(STRIKE, (8, 400)), (LEAVE, (8, 600)), (SPARE, (8, 4_000))];
    let mut rows = Vec::new();
    for (shot, (chains, iterations)) in shots.into_iter().take(work.size(3, 1)) {
        let size = work.size((chains, iterations), (2, 3));
        let mut row = |name: &str, seen: Seen| {
            rows.push(vec![
                shot.name.into(),
                format!("{} × {}", size.0, thousands(size.1)),
                name.into(),
                seen.share.shown(),
                seen.distinct.to_string(),
                format!("{} of {}", seen.found, size.0),
                format!("{:.1}", seen.milliseconds),
            ]);
        };
        for (name, off) in OFF.iter().take(work.size(OFF.len(), 2)) {
            work.say(format_args!("{}: chains without {name}", shot.name));
            row(name, seen(shot, |config| leave_out(&mut config.weights, off), size)?);
        }
        row("all but the paper's seven", seen(shot, |config| config.moves = Moves::Paper, size)?);
    }
    let head = [
        "shot",
        "chains × iterations",
        "without",
        "share of iterations at a solution",
        "distinct",
        "chains that found any",
        "ms an iteration",
    ];
    let mut text = table(&head, rows);
    text += "\nChains of the seeds 0, 1, … from draws of the prior, the way to the first solution included; errors are those of the mean over chains.\n";
    work.report.section("Bowling: what the moves bring", &text);
    Ok(())
}

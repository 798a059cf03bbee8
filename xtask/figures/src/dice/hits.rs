//! How long it takes to find the first solution, and how many distinct ones follow.

use super::{ONE, SIX, TOGETHER, Thrown};
use crate::clock::seconds;
use crate::report::table;
use crate::stats::{quantile, shown};
use crate::{Result, Work};
use plaus_dist::Seed;
use plaus_mcmc::{Chain, Goal};
use rayon::prelude::*;
use std::collections::BTreeSet;

/// Lengths of a scenario's chains.
struct Length {
    seeds: u64,
    /// Largest number of iterations up to the first solution, and number of iterations after it.
    most: u64,
    after: u64,
}

/// The result of one chain.
struct Seen {
    /// Iterations and seconds up to the first solution.
    first: Option<(u64, f64)>,
    iterations: u64,
    seconds: f64,
    distinct: usize,
}

pub(super) fn make(work: &mut Work) -> Result<()> {
    let quick = work.quick;
    let length =
        |seeds, most, after| if quick { Length { seeds: 1, most: 2, after: 1 } } else { Length { seeds, most, after } };
    let rows = [
        ("dice-one", ONE, length(20, 100_000, 3000)),
        ("dice-six", SIX, length(5, 100_000, 3000)),
        ("dice-six-together", TOGETHER, length(5, 100_000, 0)),
    ];
    let mut cells = Vec::new();
    for (name, scenario, length) in rows {
        work.say(format_args!("first solutions of {name}: {} chains", length.seeds));
        let thrown = Thrown::new(scenario, |_| ())?;
        let seen =
            (0..length.seeds).into_par_iter().map(|seed| one(&thrown, seed, &length)).collect::<Result<Vec<_>>>()?;
        let sorted = |value: &dyn Fn(&Seen) -> f64| {
            let mut values: Vec<f64> = seen.iter().map(value).collect();
            values.sort_by(f64::total_cmp);
            values
        };
        let first = |of: fn((u64, f64)) -> f64| sorted(&|seen: &Seen| seen.first.map_or(f64::INFINITY, of));
        let [iterations, spent] = [first(|first| first.0 as f64), first(|first| first.1)];
        let of = |values: &[f64], q: f64| shown(quantile(values, q), 3);
        let minute = sorted(&|seen: &Seen| 60.0 * seen.distinct as f64 / seen.seconds);
        cells.push(vec![
            format!("`{name}`"),
            format!("{} of {}", seen.iter().filter(|seen| seen.first.is_some()).count(), length.seeds),
            format!("{} / {}", of(&iterations, 0.5), of(&iterations, 1.0)),
            format!("{} / {}", of(&spent, 0.5), of(&spent, 1.0)),
            if length.after > 0 { format!("{} / {}", of(&minute, 0.5), of(&minute, 0.0)) } else { "–".into() },
            shown(
                1e3 * seen.iter().map(|s| s.seconds).sum::<f64>()
                    / seen.iter().map(|s| s.iterations as f64).sum::<f64>(),
                3,
            ),
        ]);
    }
    let head = [
        "scenario",
        "found",
        "first solution, iterations (median / worst)",
        "s (median / worst)",
        "distinct a minute (median / least)",
        "ms an iteration",
    ];
    let text = table(&head, cells)
        + "\nSeeds 0, 1, …, one chain each; seconds are processor time of one core. The paper needed about an hour for each of its dice. A solution has all dice at rest, each within 10 mm of its \
           place and with its face up; distinct ones differ in where, or with which face up, a die is at some tenth of a second.\n";
    work.report.section("Dice: first solutions", &text);
    Ok(())
}

fn one(thrown: &Thrown, seed: u64, length: &Length) -> Result<Seen> {
    let begin = seconds();
    let mut chain = Chain::start(&thrown.scene, &thrown.moves, Seed(seed).chain(0))?;
    let (mut first, mut classes) = (None, BTreeSet::new());
    while chain.iteration() < first.map_or(length.most, |(iteration, _)| iteration + length.after) {
        chain.step()?;
        let Some(class) = thrown.scene.class(chain.state().by_ref()) else { continue };
        first.get_or_insert_with(|| (chain.iteration(), seconds() - begin));
        classes.insert(class);
    }
    Ok(Seen { first, iterations: chain.iteration(), seconds: seconds() - begin, distinct: classes.len() })
}

//! The use of moves and savings: each is switched off by itself.

use super::chains::{Chains, Length, Word};
use super::{acm, hi};
use crate::report::{significant, table, thousands};
use crate::stats::shown;
use crate::{Result, Work};
use plaus_scenes::Moves;
use plaus_scenes::spelling::{Config, Savings, Weights};

/// A variant of the default moves.
type Change = (&'static str, fn(&mut Config));

/// Makes a word.
type Make = fn() -> Result<Word>;

/// Makes a variant of a word.
type Changed = fn(fn(&mut Config)) -> Result<Word>;

/// The weight of a move that is left out is divided among the others in proportion.
const VARIANTS: &[Change] = &[
    ("all default moves", |_| ()),
    ("without redrop", |config| config.weights.set("redrop", 0.0)),
    ("without birth_death", |config| config.weights.set("birth_death", 0.0)),
    ("without swap", |config| config.weights.set("swap", 0.0)),
    ("without redraw_vertices", |config| config.weights.set("redraw_vertices", 0.0)),
    ("redrop and birth_death not aimed", |config| config.steps.aimed = 0.0),
    ("the paper's moves, weighted alike", |config| {
        config.weights = Weights::paper();
    }),
    ("the paper's moves and weights", |config| config.moves = Moves::Paper),
];

/// What a simulation can save.
const SAVINGS: [(&str, Savings); 4] = [
    ("all savings", Savings::ALL),
    ("no bound from the number of balls", Savings { bound: false, reuse: true }),
    ("nothing reused of the current state", Savings { bound: true, reuse: false }),
    ("no savings", Savings::NONE),
];

pub(super) fn make(work: &mut Work) -> Result<()> {
    savings(work)?;
    moves(work)
}

fn savings(work: &mut Work) -> Result<()> {
    let iterations = work.size(3_000, 150);
    let words: [(&str, Make, u64); 2] =
        [("HI", || hi(|_| ()), work.size(6, 1)), ("ACM", || acm(|_| ()), work.size(4, 1))];
    let mut rows = Vec::new();
    for (name, word, seeds) in words {
        work.say(format_args!("savings: {seeds} chains of {iterations} iterations of {name}, four ways"));
        let mut all: Option<(f64, f64)> = None;
        for (what, savings) in SAVINGS {
            let chains = word()?.saving(savings).run(Length { seeds, iterations, until_first: false })?;
            let first = chains.quantile(0.5, |seen| seen.first_second());
            let time = chains.sorted(|seen| seen.seconds).iter().sum::<f64>() / (seeds * iterations) as f64;
            let (least, _) = *all.get_or_insert((time, first));
            rows.push(vec![
                name.to_owned(),
                what.to_owned(),
                format!("{} µs", shown(1e6 * time, 3)),
                significant(time / least, 2),
                shown(first, 2),
            ]);
        }
    }
    let text = table(&["word", "", "an iteration", "relative", "first full word, s, median"], rows)
        + &format!(
            "\nThe same chains bit by bit, {} iterations each: savings change no state. Times are of one core, and of one run of this report: compare them with each other. That balls are \
             simulated group by group is no saving to be switched off: it is how the simulation is defined.\n",
            thousands(iterations)
        );
    work.report.section("What savings bring", &text);
    Ok(())
}

fn moves(work: &mut Work) -> Result<()> {
    let mut rows = Vec::new();
    let cases: [(&str, Changed, u64, u64); 2] = [
        ("HI", |change| hi(change), work.size(20, 1), work.size(10_000, 200)),
        ("ACM", |change| acm(change), work.size(4, 1), work.size(10_000, 100)),
    ];
    for (name, word, seeds, limit) in cases {
        for (what, change) in VARIANTS {
            work.say(format_args!("moves: {seeds} chains of {name}, {what}"));
            let word = word(*change)?;
            let chains: Chains = word.run(Length { seeds, iterations: limit, until_first: true })?;
            let at = |q: f64| shown(chains.quantile(q, |seen| seen.first_iteration()), 3);
            rows.push(vec![
                name.to_owned(),
                (*what).to_owned(),
                format!("{} of {seeds}", chains.found()),
                at(0.5),
                at(1.0),
                shown(chains.quantile(0.5, |seen| seen.first_second()), 2),
            ]);
        }
    }
    let head = ["word", "", "found", "first full word, median iteration", "worst", "median, s"];
    let text = table(&head, rows)
        + "\nExact chains until their first full word, at most 10,000 iterations. What the informed moves bring after the first word, when one must turn into \
           the next, is in the overlap of \"Time to spell\".\n";
    work.report.section("What moves bring", &text);
    Ok(())
}

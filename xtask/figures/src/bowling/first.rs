//! How soon a chain finds each shot, and how many different solutions it finds in a minute, compared with plain
//! rejection.

use super::shots::{Bowler, Haul, LEAVE, SPARE, STRIKE, Shot, Until, by_chain, by_rejection};
use crate::report::{significant, table, thousands};
use crate::sampler::First;
use crate::stats::Quantiles;
use crate::{Result, Work};
use plaus_dist::Seed;
use plaus_scenes::bowling::Bowling;

/// Iterations after which a chain gives up.
const MOST: u64 = 20_000;
/// Number of chains for the distinct solutions, run one after the other.
const CHAINS: u64 = 4;

/// What is asked of a shot: within how many seconds the first solution should come, for how many of how many seeds.
struct Asked {
    shot: Shot,
    seconds: f64,
    of: u64,
    least: usize,
    /// Number of chains with one seed, each on its own core; the first one that finds a solution counts.
    cores: u64,
}

const ASKED: [Asked; 3] = [
    Asked { shot: STRIKE, seconds: 0.5, of: 20, least: 19, cores: 1 },
    Asked { shot: LEAVE, seconds: 20.0, of: 10, least: 9, cores: 2 },
    Asked { shot: SPARE, seconds: 10.0, of: 10, least: 9, cores: 2 },
];

fn firsts(bowler: &Bowler, seeds: u64, chain: u64, most: u64) -> Result<Vec<First<Bowling>>> {
    (0..seeds).map(|seed| bowler.first(Seed(seed).chain(chain), most)).collect()
}

fn second(first: &First<Bowling>) -> f64 {
    if first.found { first.seconds } else { f64::INFINITY }
}

/// From seconds in ascending order: median and worst in words, and how many are as quick as asked.
fn told(mut seconds: Vec<f64>, asked: &Asked) -> (String, usize) {
    seconds.sort_by(f64::total_cmp);
    let shown = |value: f64| if value.is_finite() { significant(value, 2) } else { "never".into() };
    let median = seconds.get((seconds.len() - 1) / 2).copied().unwrap_or(f64::NAN);
    let worst = seconds.last().copied().unwrap_or(f64::NAN);
    (format!("{} / {}", shown(median), shown(worst)), seconds.iter().filter(|s| **s <= asked.seconds).count())
}

pub(super) fn make(work: &mut Work) -> Result<()> {
    let mut rows = Vec::new();
    for asked in ASKED {
        let (seeds, most) = (work.size(asked.of, 1), work.size(MOST, 30));
        work.say(format_args!("{}: {seeds} chains until the first one", asked.shot.name));
        let bowler = asked.shot.bowler()?;
        // One after the other, because cores that share memory slow each other down.
        let alone = firsts(&bowler, seeds, 0, most)?;
        let (one, within) = told(alone.iter().map(second).collect(), &asked);
        let iterations = alone.iter().map(|first| first.found.then_some(first.iterations)).collect();
        let iterations = Quantiles::new(iterations);
        let (pair, pair_within) = if asked.cores > 1 {
            let other = firsts(&bowler, seeds, 1, most)?;
            let sooner = alone.iter().zip(&other).map(|(a, b)| second(a).min(second(b))).collect();
            let (text, within) = told(sooner, &asked);
            (text, Some(within))
        } else {
            ("–".into(), None)
        };
        let counted = pair_within.unwrap_or(within);
        let shown = |q| iterations.value(q).map_or("never".into(), thousands);
        let cores = if asked.cores > 1 { "two cores" } else { "one core" };
        let verdict = if counted >= asked.least { "met" } else { "missed" };
        rows.push(vec![
            asked.shot.name.into(),
            format!("{} / {}", shown(0.5), shown(1.0)),
            one,
            format!("{within} of {seeds}"),
            pair,
            pair_within.map_or("–".into(), |within| format!("{within} of {seeds}")),
            format!("{} s in {} of {} on {cores}: {verdict}", asked.seconds, asked.least, asked.of),
        ]);
    }
    let head = [
        "shot",
        "first one, iterations (median / worst)",
        "s of one core",
        "within what is asked",
        "s, two chains at once",
        "within what is asked",
        "asked",
    ];
    let mut text = table(&head, rows);
    text += &format!(
        "\nChains of the seeds 0, 1, … start at a draw of the prior and end exactly at the first iteration that satisfies the constraint (at {} iterations otherwise); default moves, shipped scenarios. Seconds are processor time, the start's \
         included. Two chains at once: chains 0 and 1 of each seed as if each had a core of its own; the sooner counts.\n",
        thousands(work.size(MOST, 30))
    );
    work.report.section("Bowling: how soon", &text);
    Ok(())
}

/// Distinct solutions per minute, by chains and by rejection.
pub(super) fn rates(work: &mut Work) -> Result<()> {
    let mut rates = Vec::new();
    for shot in [STRIKE, LEAVE, SPARE] {
        rates.push(rate(work, shot, &shot.bowler()?)?);
    }
    let head = [
        "shot",
        "chains: distinct a minute",
        "distinct, hits, iterations",
        "rejection: distinct a minute",
        "distinct, hits, draws",
        "chains over rejection",
    ];
    let mut text = table(&head, rates);
    text += &format!(
        "\nDistinct: the ball meets the first pin on another board, or strikes other pins, or in another order. {CHAINS} chains one after the other from draws of the prior, the way to the first solution included, beside independent draws of the prior \
         that end as soon as they cannot satisfy the constraint; each {} s of one core, in turn in one run. A chain's hits depend on each other.\n",
        significant(work.size(30.0, 0.05), 2)
    );
    work.report.section("Bowling: distinct solutions a minute", &text);
    Ok(())
}

fn rate(work: &Work, shot: Shot, bowler: &Bowler) -> Result<Vec<String>> {
    let each = work.size(30.0, 0.05) / CHAINS as f64;
    work.say(format_args!("{}: distinct solutions a minute", shot.name));
    let (mut chains, mut rejection) = (Haul::default(), Haul::default());
    for turn in 0..CHAINS {
        chains.add(by_chain(bowler, 100 + turn, Until::Seconds(each), |_| Ok(()))?);
        rejection.add(by_rejection(bowler, 200 + turn, Until::Seconds(each))?);
    }
    let counts = |haul: &Haul| format!("{}, {}, {}", haul.classes.len(), thousands(haul.hits), thousands(haul.draws));
    let ratio = chains.distinct_a_minute() / rejection.distinct_a_minute();
    Ok(vec![
        shot.name.into(),
        significant(chains.distinct_a_minute(), 3),
        counts(&chains),
        significant(rejection.distinct_a_minute(), 3),
        counts(&rejection),
        if ratio.is_finite() { significant(ratio, 2) } else { "–".into() },
    ])
}

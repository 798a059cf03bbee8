//! How long words take, how fast solutions come, and how soon a solution no longer resembles an earlier one; restarts
//! by tempering.

use super::chains::{Chains, Length, Word};
use super::{acm, hi};
use crate::clock::seconds;
use crate::report::{Claim, table, thousands};
use crate::stats::shown;
use crate::{Result, Work};
use plaus_dist::Seed;
use plaus_mcmc::{Course, Goal, Ladder, Mixture, Redraw, Replicas, Tempering};

const RUNGS: u32 = 8;
const SWAP_EVERY: u64 = 20;

pub(super) fn make(work: &mut Work) -> Result<()> {
    let iterations = work.size(20_000, 600);
    let mut rows = Vec::new();
    let mut firsts = Vec::new();
    for (name, word, seeds) in [("HI", hi(|_| ())?, work.size(20, 2)), ("ACM", acm(|_| ())?, work.size(10, 1))] {
        work.say(format_args!("times: {seeds} chains of {iterations} iterations of {name}"));
        let chains = word.run(Length { seeds, iterations, until_first: false })?;
        let restarts = restarts(&word, work.size(3_000, 200), work.size(12_000, 400))?;
        rows.extend(column(name, &chains, &restarts));
        firsts.push(chains.quantile(0.5, |seen| seen.first_second()));
    }
    let text = table(&["", "median", "95%", "worst"], rows)
        + &format!(
            "\nSeconds of one core, as the operating system counts them for the thread, whatever else the machine did. HI: 20 seeds, ACM: 10, {} iterations, default moves, exact. \
             Solutions are distinct where some ball lies in another bin. Overlap: share of the balls in a bin that lie \
             in the same bin so many iterations later, from the first full word \
             on; by chance it would be the reciprocal of the number of balls, {} and {}. Restarts: parallel tempering \
             over ln λ with {RUNGS} rungs and swaps every {SWAP_EVERY} iterations, \
             the ladder adapted in a warm-up that does not count; a restart brings a state to the target's rung that \
             was drawn anew at the first rung since it was there before, \
             and is fruitful where a full word comes before the next one.\n",
            thousands(iterations),
            0.1,
            0.033,
        );
    work.report.section("Time to spell", &text);
    work.report.claim(Claim {
        paper: "\"The twenty thousand iterations shown here took a few hours\", the first good animation came after some 6,000 (5.3, HI)".into(),
        ours: format!(
            "the first full HI after {} s in the median, the first full ACM after {} s; see \"Time to spell\"",
            shown(firsts[0], 2),
            shown(firsts[1], 2)
        ),
        how: "default moves, exact, one core of the machine that made this report".into(),
        verdict: "**faster** by machine, simulator and moves together; each move's part is in \"What moves and savings bring\"".into(),
    });
    Ok(())
}

/// What replicas did in a number of iterations.
struct Restarts {
    a_minute: f64,
    fruitful: f64,
    distinct: f64,
    barrier: f64,
}

fn restarts(word: &Word, warmup: u64, iterations: u64) -> Result<Restarts> {
    // One core: replicas take turns.
    rayon::ThreadPoolBuilder::new().num_threads(1).build()?.install(|| {
        let fresh = Mixture::of(Box::new(Redraw));
        let tempering = Tempering { rungs: RUNGS, swap_every: SWAP_EVERY, warmup, adapt_rungs: false };
        let course = Course { target: &word.scene, moves: &word.moves, fresh: &fresh, tempering };
        let mut replicas = Replicas::start(course, Seed(1), 0)?;
        replicas.advance(warmup + 1, |_, _| ())?;
        let begin = seconds();
        let mut distinct = std::collections::BTreeSet::new();
        let (mut pending, mut fruitful, mut before) = (false, 0_u64, 0);
        while replicas.iteration() < warmup + iterations {
            replicas.advance(replicas.iteration() + SWAP_EVERY, |chain, _| {
                if let Some(class) = word.scene.class(chain.state().by_ref()) {
                    distinct.insert(class);
                    fruitful += u64::from(std::mem::take(&mut pending));
                }
            })?;
            pending |= replicas.climb().restarts() > std::mem::replace(&mut before, replicas.climb().restarts());
        }
        let minutes = (seconds() - begin) / 60.0;
        let climb = replicas.climb();
        Ok(Restarts {
            a_minute: climb.restarts() as f64 / minutes,
            fruitful: fruitful as f64 / minutes,
            distinct: distinct.len() as f64 / minutes,
            barrier: Ladder::barrier(&climb.rejected()),
        })
    })
}

fn column(name: &str, chains: &Chains, restarts: &Restarts) -> Vec<Vec<String>> {
    let of =
        |value: &dyn Fn(&super::chains::Seen) -> f64| [0.5, 0.95, 1.0].map(|q| shown(chains.quantile(q, value), 3));
    let row = |what: &str, [a, b, c]: [String; 3]| vec![format!("{name}: {what}"), a, b, c];
    let one = |what: &str, value: f64| row(what, [shown(value, 2), String::new(), String::new()]);
    let mut rows = vec![
        row("first full word, s", of(&|seen| seen.first_second())),
        row("first full word, iterations", of(&|seen| seen.first_iteration())),
        row("all iterations, s", of(&|seen| seen.seconds)),
        row(
            "distinct full words a minute (95% and worst: fewest)",
            [0.5, 0.05, 0.0].map(|q| shown(chains.quantile(q, |seen| seen.distinct()), 3)),
        ),
    ];
    rows.extend(
        [(1, "100"), (10, "1,000"), (100, "10,000")]
            .map(|(lag, text)| one(&format!("overlap after {text} iterations"), chains.overlap(lag))),
    );
    rows.push(one("restarts a minute, tempered", restarts.a_minute));
    rows.push(one("fruitful restarts a minute", restarts.fruitful));
    rows.push(one("distinct full words a minute, tempered", restarts.distinct));
    rows.push(one("barrier", restarts.barrier));
    rows
}

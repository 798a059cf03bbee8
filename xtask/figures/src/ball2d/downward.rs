//! What the paper does not specify: the height of the fall, and bounces that would point into the table.

use super::arrival::LIMIT;
use super::reference::{HEIGHTS, PAPER_SIGMA, RULES, Reference, SEED as REFERENCE_SEED};
use super::{BOTH, sampler};
use crate::report::{table, thousands};
use crate::stats::Estimate;
use crate::{Result, Work};

const SEED: u64 = 5;

pub(super) fn make(work: &mut Work, reference: &Reference) -> Result<()> {
    let chains = work.size(2_000, 40);
    let limit = work.size(LIMIT, 2_000);
    let mut rows = Vec::new();
    for (rule, (downward, name)) in RULES.into_iter().enumerate() {
        work.say(format_args!(
            "downward = \"{name}\": {chains} chains of at most {limit} iterations a kind of moves, seed {SEED}"
        ));
        let mut row = vec![format!("`{name}`")];
        row.extend((0..HEIGHTS.len()).map(|height| reference.share(rule, height, PAPER_SIGMA).shown()));
        for (moves, _) in BOTH {
            let hits = sampler(moves, |config| config.downward = downward)?.first_hits(SEED, chains, limit)?;
            let lost = hits.iter().filter(|hit| hit.is_none()).count();
            let share = Estimate::of(lost, hits.len());
            row.push(if lost == 0 {
                "0".into()
            } else {
                format!("{lost} ({:.1} ± {:.1}%)", 100.0 * share.value, 100.0 * share.error)
            });
        }
        rows.push(row);
    }
    let head = [
        "rule",
        "share, fall of 4.5 D",
        "share, fall of 4 D",
        "lost chains, paper's move",
        "lost chains, default moves",
    ];
    let mut text = table(&head, rows);
    text += &format!(
        "\nShare: samples within 0.1 D at σ_d = 0.1 D, from {} weighted prior draws (seed {REFERENCE_SEED}). Lost: of {} chains (seed {SEED}) those that never came within 0.1 D in {} iterations.\n\n\
         {} of prior draws hold a bounce after which the ball would move into the table; the paper does not say what \
         happens then. The rules change the law little, but some leave chains of the paper's move where the first \
         bounce has no vertical speed, far from the target, and no small step helps. \
         \"Height of 4.5 D\" may be the centre's, which then falls 4 D, or the fall itself; x is proportional to it.\n",
        thousands(reference.draws),
        thousands(chains),
        thousands(limit),
        {
            let share = reference.downward();
            format!("{:.2} ± {:.2}%", 100.0 * share.value, 100.0 * share.error)
        },
    );
    work.report.section("What the paper leaves open", &text);
    Ok(())
}

//! How soon chains reach the target.

use super::{BOTH, sampler};
use crate::report::{Claim, thousands};
use crate::stats::Quantiles;
use crate::{Result, Work};

pub(super) const SEED: u64 = 2;
/// Iterations after which a chain counts as lost.
pub(super) const LIMIT: u64 = 100_000;

pub(super) fn make(work: &mut Work) -> Result<()> {
    let chains = work.size(10_000, 300);
    let mut ours = Vec::new();
    let (mut lost, mut paper) = (0, None);
    for (moves, name) in BOTH {
        work.say(format_args!("arrival: {chains} chains with the {name} moves, seed {SEED}"));
        let hits = Quantiles::new(sampler(moves, |_| ())?.first_hits(SEED, chains, LIMIT)?);
        ours.push(format!(
            "{name} move{}: half the chains by iteration {}, 90% by {}, 99% by {}; {} of {} by {}",
            if name == "default" { "s" } else { "" },
            hits.at(0.5),
            hits.at(0.9),
            hits.at(0.99),
            thousands(hits.found()),
            thousands(chains),
            thousands(LIMIT),
        ));
        lost += chains - hits.found();
        paper.get_or_insert(hits);
    }
    let Some(paper) = paper else { return Ok(()) };
    let by_twenty = paper.share_by(20);
    let tens = paper.value(0.9).is_some_and(|nine_in_ten| nine_in_ten < 100);
    work.report.claim(Claim {
        paper: "\"Within twenty iterations the chain moved toward a good location\" (5.1.3); the chain moves to the constraint within tens of iterations".into(),
        ours: format!("{}. Within 0.1 D by iteration 20, the paper's move: {}", ours.join("; "), by_twenty.shown()),
        how: format!("{} chains each from prior draws, seed {SEED}: first iteration with \\|x − D\\| < 0.1 D (in brackets: 95% interval)", thousands(chains)),
        verdict: format!(
            "**{}** as tens of iterations; twenty is {}",
            if tens { "holds" } else { "does not hold" },
            if by_twenty.value > 0.5 { "what more than half the chains need at most" } else { "less than half the chains need, not a bound" },
        ),
    });
    work.report.claim(Claim {
        paper: "(ours) No chain stays off the target".into(),
        ours: format!(
            "{lost} of {} chains were off the target for all {} iterations",
            thousands(2 * chains),
            thousands(LIMIT)
        ),
        how: "the same chains, both kinds of moves; `downward = \"back\"`, the default".into(),
        verdict: if lost == 0 { "**holds**".into() } else { "**does not hold**".into() },
    });
    Ok(())
}

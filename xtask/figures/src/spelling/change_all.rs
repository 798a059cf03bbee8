//! The claim of section 5.3 that redrawing everything brings the chain from one solution to the next.

use super::chains::{Chains, Length, Word};
use super::traces::paper;
use crate::report::{Claim, significant, table, thousands};
use crate::stats::shown;
use crate::{Result, Work};
use plaus_scenes::rules::Preset;

pub(super) fn make(work: &mut Work) -> Result<()> {
    let length = Length { seeds: work.size(10, 2), iterations: work.size(20_000, 500), until_first: false };
    work.say(format_args!(
        "the change-all effect: {} chains of {} iterations each way",
        length.seeds, length.iterations
    ));
    let kinds = [
        ("as printed, the paper's moves", paper(Preset::AsPrinted)?),
        ("exact, the paper's moves", paper(Preset::Exact)?),
        ("exact, default moves", super::hi(|_| ())?),
    ];
    let mut rows = Vec::new();
    let mut seen = Vec::new();
    for (name, word) in kinds {
        let chains = word.run(length)?;
        let [drops, change_all] = facts(&word, &chains);
        rows.push(vec![
            name.to_owned(),
            format!("{} of {}", chains.found(), length.seeds),
            shown(chains.quantile(0.5, |seen| seen.first_iteration()), 3),
            shown(chains.quantile(1.0, |seen| seen.first_iteration()), 3),
            significant(mean(&chains.sorted(|seen| seen.share())), 2),
            format!("{}%", significant(100.0 * change_all, 2)),
            significant(drops, 2),
            significant(chains.quantile(0.5, |seen| seen.drops as f64), 2),
        ]);
        seen.push((drops, change_all));
    }
    let head = [
        "HI, λ = e⁵",
        "found a full word",
        "first, median iteration",
        "worst",
        "share full",
        "change-all accepted",
        "sharp drops per 20,000, mean",
        "median",
    ];
    let how = format!(
        "{} chains of {} iterations each, seeds 0 to {}",
        length.seeds,
        thousands(length.iterations),
        length.seeds - 1
    );
    let text = table(&head, rows)
        + &format!(
            "\n{how}. A sharp drop is an iteration that lowers k by five or more. As printed, a change of everything is accepted as if it were symmetric, and fresh offsets have \
             a Gaussian length rather than Gaussian coordinates: both favour it by tens of nats against vertices that \
             have wandered. With the true ratios it is left to the constraint, and a full word is given up about once \
             in e⁴³ tries. Exact chains go from word to word by other moves, or are restarted by tempering.\n"
        );
    work.report.section("The change-all effect", &text);
    let [printed, exact, _] = [seen[0], seen[1], seen[2]];
    work.report.claim(Claim {
        paper: "The change-all effect: from time to time everything is drawn anew, the word is lost, and soon another is found (5.3, figures 6 and 7)".into(),
        ours: format!(
            "as printed {} sharp drops in 20,000 iterations on average and {}% of the changes of everything accepted; exact {} and {}%",
            significant(printed.0, 2),
            significant(100.0 * printed.1, 2),
            significant(exact.0, 2),
            significant(100.0 * exact.1, 2),
        ),
        how,
        verdict: if printed.0 > 2.0 * exact.0 {
            "**holds as printed, not in exact mode**: the effect comes from the acceptance rule".into()
        } else {
            "**cannot be told apart** in these chains".into()
        },
    });
    Ok(())
}

/// Number of sharp drops in 20,000 iterations, and the acceptance of `change_all`.
fn facts(word: &Word, chains: &Chains) -> [f64; 2] {
    let drops: u64 = chains.0.iter().map(|seen| seen.drops).sum();
    let iterations: u64 = chains.0.iter().map(|seen| seen.iterations).sum();
    [20_000.0 * drops as f64 / iterations as f64, chains.acceptance(&word.moves, "change_all")]
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

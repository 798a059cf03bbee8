//! The effect of λ: if it is too small, words are given up; if it is too large, chains get stuck.

use super::chains::{Length, Word};
use super::{acm, hi};
use crate::report::{significant, table, thousands};
use crate::stats::shown;
use crate::{Result, Work};

/// A word at a value of ln λ.
type At = fn(f64) -> Result<Word>;

pub(super) fn make(work: &mut Work) -> Result<()> {
    let iterations = work.size(10_000, 300);
    let seeds = work.size(5, 1);
    let mut rows = Vec::new();
    let cases: [(&str, &[f64], At); 2] = [
        ("HI", &[4.0, 5.0, 6.0], |ln_lambda| hi(|config| config.ln_lambda = Some(ln_lambda))),
        ("ACM", &[6.0, 7.25, 8.0], |ln_lambda| acm(|config| config.ln_lambda = Some(ln_lambda))),
    ];
    for (name, lambdas, word_at) in cases {
        for &ln_lambda in lambdas {
            work.say(format_args!("{name} at ln λ = {ln_lambda}: {seeds} chains"));
            let word = word_at(ln_lambda)?;
            let chains = word.run(Length { seeds, iterations, until_first: false })?;
            let share = chains.sorted(|seen| seen.share()).iter().sum::<f64>() / seeds as f64;
            rows.push(vec![
                name.to_owned(),
                ln_lambda.to_string(),
                shown(chains.quantile(0.5, |seen| seen.first_iteration()), 3),
                shown(chains.quantile(1.0, |seen| seen.first_iteration()), 3),
                significant(share, 2),
                shown(chains.quantile(0.5, |seen| seen.distinct()), 2),
                [1, 10].map(|lag| shown(chains.overlap(lag), 2)).join(" / "),
            ]);
        }
    }
    let head = [
        "word",
        "ln λ",
        "first full word, median iteration",
        "worst",
        "share of full iterations",
        "distinct full words a minute",
        "overlap after 100 / 1,000",
    ];
    let text = table(&head, rows)
        + &format!(
            "\n{seeds} exact chains of {} iterations each, default moves. A larger λ finds the first word sooner and keeps it longer, as it should; what is lost is how fast one word turns \
             into another, which the overlap shows.\n",
            thousands(iterations)
        );
    work.report.section("The choice of λ", &text);
    Ok(())
}
